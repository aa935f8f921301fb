#include "report/scene_description.h"

#include <fmt/format.h>
#include <gnomon/registry.h>

#include <algorithm>

#include "measure/counted.h"
#include "measure/scene/channels.h"
#include "measure/scene/pose.h"
#include "measure/scene/scene_json.h"
#include "report/listing.h"
#include "report/table/text_table.h"

namespace gnomon {

namespace {

/// "center -1.3 0.8 0.35, radius 0.08".
std::string words(const SceneKeys& keys) {
  std::string text;
  for (const auto& [key, value] : keys) {
    text += (text.empty() ? "" : ", ") + key;
    for (const Json& one : value.is_array() ? value : Json::array({value})) text += ' ' + json_text(one);
  }
  return text;
}

std::string mesh_table(const Scene& scene, std::size_t width) {
  TextTable table({{"mesh", ""},
                   {"triangles", "", Align::right},
                   {"shape", ""},
                   {"closed", ""},
                   {"boundary", "edges", Align::right, 1},
                   {"non-manifold", "edges", Align::right, 2},
                   {"misoriented", "edges", Align::right, 3},
                   {"dropped", "triangles", Align::right, 4}});
  constexpr std::size_t shown = 40;
  for (const Mesh& mesh : std::span(scene.meshes).first(std::min(shown, scene.meshes.size())))
    table.add_row({mesh.name, std::to_string(mesh.triangles.size()), mesh.shape ? std::string(kind_name(*mesh.shape)) : "-",
                   mesh.is_closed() ? "yes" : "no", std::to_string(mesh.facts.boundary_edge_count),
                   std::to_string(mesh.facts.nonmanifold_edge_count), std::to_string(mesh.facts.misoriented_edge_count),
                   std::to_string(mesh.facts.degenerate_count)});
  std::string text = table.text(width);
  if (scene.meshes.size() > shown) text += fmt::format("and {} more\n", scene.meshes.size() - shown);
  return text;
}

/// Each alpha mask once: which meshes have it, and what of it is solid. Empty for a scene without masks.
std::string mask_table(const Scene& scene, std::size_t width) {
  TextTable table({{"alpha mask", "texels"},
                   {"wrap", ""},
                   {"cutoff", "", Align::right},
                   {"solid", "", Align::right},
                   {"meshes", "", Align::right},
                   {"first mesh", ""}});
  std::vector<const AlphaMask*> masks;
  for (const Mesh& mesh : scene.meshes)
    if (mesh.alpha_mask && std::ranges::find(masks, mesh.alpha_mask.get()) == masks.end())
      masks.push_back(mesh.alpha_mask.get());
  if (masks.empty()) return "";
  constexpr std::size_t shown = 40;
  for (const AlphaMask* const mask : std::span(masks).first(std::min(shown, masks.size()))) {
    const auto has_it = [&](const Mesh& mesh) { return mesh.alpha_mask.get() == mask; };
    table.add_row({fmt::format("{} x {}", mask->width(), mask->height()),
                   fmt::format("{} {}", wrap_name(mask->wrap_u()), wrap_name(mask->wrap_v())),
                   fmt::format("{:g}", mask->cutoff()), fmt::format("{:.3g} %", 100 * mask->coverage()),
                   std::to_string(std::ranges::count_if(scene.meshes, has_it)),
                   std::ranges::find_if(scene.meshes, has_it)->name});
  }
  std::string text = '\n' + table.text(width);
  if (masks.size() > shown) text += fmt::format("and {} more\n", masks.size() - shown);
  return text;
}

/// How much of the light the texels of a transmission let through, over all channels.
struct TransmittedShares {
  double least = 1, mean = 0, most = 0;
};
TransmittedShares transmitted_shares(const Transmission& transmission) {
  TransmittedShares shares;
  for (const double value : transmission.values()) {
    shares.least = std::min(shares.least, value);
    shares.most = std::max(shares.most, value);
    shares.mean += value;
  }
  shares.mean /= static_cast<double>(transmission.values().size());
  return shares;
}

/// Each transmission once: which meshes have it, how many of them are seen, and what it lets through. Empty for a scene
/// without.
std::string transmission_table(const Scene& scene, std::size_t width) {
  TextTable table({{"transmission", "texels"},
                   {"wrap", ""},
                   {"channels", "", Align::right},
                   {"least", "", Align::right},
                   {"mean", "", Align::right},
                   {"most", "", Align::right},
                   {"meshes", "", Align::right},
                   {"seen", "", Align::right},
                   {"first mesh", ""}});
  std::vector<const Transmission*> all;
  for (const Mesh& mesh : scene.meshes)
    if (mesh.transmission && std::ranges::find(all, mesh.transmission.get()) == all.end())
      all.push_back(mesh.transmission.get());
  if (all.empty()) return "";
  constexpr std::size_t shown = 40;
  for (const Transmission* const one : std::span(all).first(std::min(shown, all.size()))) {
    const auto has_it = [&](const Mesh& mesh) { return mesh.transmission.get() == one; };
    const auto is_seen = [&](const Mesh& mesh) { return has_it(mesh) && mesh.seen; };
    const TransmittedShares shares = transmitted_shares(*one);
    table.add_row({fmt::format("{} x {}", one->width(), one->height()),
                   fmt::format("{} {}", wrap_name(one->wrap_u()), wrap_name(one->wrap_v())), std::to_string(one->channels()),
                   fmt::format("{:.3g}", shares.least), fmt::format("{:.3g}", shares.mean), fmt::format("{:.3g}", shares.most),
                   std::to_string(std::ranges::count_if(scene.meshes, has_it)),
                   std::to_string(std::ranges::count_if(scene.meshes, is_seen)),
                   std::ranges::find_if(scene.meshes, has_it)->name});
  }
  std::string text = '\n' + table.text(width);
  if (all.size() > shown) text += fmt::format("and {} more\n", all.size() - shown);
  return text;
}

/// Numbers of the meshes that an animation moves, ascending.
std::vector<std::uint32_t> moved_meshes(const Motion& motion, const Animation& animation) {
  const std::vector<bool> moved = moved_rigs(motion, animation);
  std::vector<std::uint32_t> meshes;
  for (std::size_t r = 0; r < moved.size(); ++r)
    if (moved[r]) meshes.push_back(motion.rigs[r].mesh);
  std::ranges::sort(meshes);
  return meshes;
}

std::size_t key_count(const Animation& animation) {
  std::size_t count = 0;
  for (const Track& track : animation.tracks) count += track.times.size();
  return count;
}

/// Empty for a scene that stands still.
std::string animation_table(const Scene& scene, std::size_t width) {
  if (!scene.motion) return "";
  TextTable table({{"animation", ""},
                   {"ends", "s", Align::right},
                   {"tracks", "", Align::right},
                   {"keys", "", Align::right},
                   {"meshes", "", Align::right},
                   {"first mesh", ""}});
  constexpr std::size_t shown = 40;
  const std::vector<Animation>& animations = scene.motion->animations;
  for (const Animation& animation : std::span(animations).first(std::min(shown, animations.size()))) {
    const std::vector<std::uint32_t> meshes = moved_meshes(*scene.motion, animation);
    table.add_row({animation.name, fmt::format("{:g}", animation.end()), std::to_string(animation.tracks.size()),
                   std::to_string(key_count(animation)), std::to_string(meshes.size()),
                   meshes.empty() ? "-" : scene.meshes.at(meshes.front()).name});
  }
  std::string text = '\n' + table.text(width);
  if (animations.size() > shown) text += fmt::format("and {} more\n", animations.size() - shown);
  return text;
}

Json animation_json(const Motion& motion, const Animation& animation) {
  return {{"name", animation.name},
          {"seconds", animation.end()},
          {"tracks", animation.tracks.size()},
          {"keys", key_count(animation)},
          {"meshes", moved_meshes(motion, animation)}};
}

/// The generator that a reference names; null for files.
const SceneEntry* generator_of(const std::string& reference) {
  return registry().find_scene(reference.substr(0, reference.find_first_of(":@")));
}

Json mesh_json(const Mesh& mesh) {
  Json json = {{"name", mesh.name},
               {"triangles", mesh.triangles.size()},
               {"shape", mesh.shape ? Json(kind_name(*mesh.shape)) : Json()},
               {"casts", mesh.casts},
               {"receives", mesh.receives},
               {"closed", mesh.is_closed()},
               {"boundary_edges", mesh.facts.boundary_edge_count},
               {"nonmanifold_edges", mesh.facts.nonmanifold_edge_count},
               {"misoriented_edges", mesh.facts.misoriented_edge_count},
               {"dropped_triangles", mesh.facts.degenerate_count}};
  if (const AlphaMask* const mask = mesh.alpha_mask.get())
    json["alpha_mask"] = {{"width", mask->width()},
                          {"height", mask->height()},
                          {"wrap_u", wrap_name(mask->wrap_u())},
                          {"wrap_v", wrap_name(mask->wrap_v())},
                          {"cutoff", number_json(mask->cutoff())},
                          {"coverage", mask->coverage()}};
  if (const Transmission* const one = mesh.transmission.get()) {
    const TransmittedShares shares = transmitted_shares(*one);
    json["transmission"] = {{"width", one->width()},
                            {"height", one->height()},
                            {"channels", one->channels()},
                            {"wrap_u", wrap_name(one->wrap_u())},
                            {"wrap_v", wrap_name(one->wrap_v())},
                            {"least", shares.least},
                            {"mean", shares.mean},
                            {"most", shares.most}};
  }
  if (mesh.transmission || !mesh.seen) json["seen"] = mesh.seen;
  return json;
}

}  // namespace

std::string describe_text(const std::string& reference, const Scene& scene, std::size_t width) {
  const Bounds b = scene.bounds();
  std::string text = fmt::format("{}: {}, {}\nbounds  {:g} {:g} {:g} .. {:g} {:g} {:g} m\n", reference,
                                 counted(scene.meshes.size(), "mesh{es}"), counted(scene.triangle_count(), "triangle{s}"),
                                 b.min.x, b.min.y, b.min.z, b.max.x, b.max.y, b.max.z);
  for (const std::string& note : scene.notes) text += wrapped_line(fmt::format("note    {}", note), width);
  if (const SceneEntry* entry = generator_of(reference))
    text += fmt::format("\n{}\n{}", wrapped_line(entry->about.summary, width), parameters_text(*entry->make(), width));
  TextTable lights({{"light", ""}, {"kind", ""}, {"keys of a scene file", "meters"}});
  for (const Light& light : whole_lights(scene.lights))
    lights.add_row({light.name, std::string(kind_name(light)), words(scene_keys(light))});
  TextTable views({{"view", ""}, {"keys of a scene file", "meters"}});
  for (const View& view : scene.views) views.add_row({view.name, words(scene_keys(view))});
  return text + fmt::format("\n{}\n{}\n{}{}{}{}", lights.text(width), views.text(width), mesh_table(scene, width),
                            mask_table(scene, width), transmission_table(scene, width), animation_table(scene, width));
}

Json describe_json(const std::string& reference, const Scene& scene) {
  const Bounds b = scene.bounds();
  Json json = {{"scene", reference},
               {"triangles", scene.triangle_count()},
               {"bounds", {{"min", number_json(b.min)}, {"max", number_json(b.max)}}},
               {"notes", scene.notes},
               {"summary", Json()},
               {"parameters", Json::array()}};
  if (const SceneEntry* entry = generator_of(reference)) {
    json["summary"] = entry->about.summary;
    json["parameters"] = parameters_json(*entry->make());
  }
  for (const char* list : {"lights", "views", "meshes", "animations"}) json[list] = Json::array();
  for (const Light& light : whole_lights(scene.lights)) json["lights"].push_back(scene_json(light));
  for (const View& view : scene.views) json["views"].push_back(scene_json(view));
  for (const Mesh& mesh : scene.meshes) json["meshes"].push_back(mesh_json(mesh));
  if (scene.motion)
    for (const Animation& animation : scene.motion->animations)
      json["animations"].push_back(animation_json(*scene.motion, animation));
  return json;
}

}  // namespace gnomon
