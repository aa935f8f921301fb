// Turns the argument of `--scene` into a scene that every technique accepts: finds, loads, frames and checks it.
#include "measure/scene/load.h"

#include <gnomon/kit/irradiance.h>
#include <gnomon/registry.h>

#include <cmath>
#include <fstream>
#include <set>

#include "measure/counted.h"
#include "measure/paths.h"
#include "measure/scene/base_scene.h"
#include "measure/scene/channels.h"
#include "measure/scene/motion_data.h"
#include "measure/scene/time_reference.h"

namespace gnomon {

namespace fs = std::filesystem;

namespace {

/// Files of described scenes, in the order of their ids.
std::vector<fs::path> described_scenes() {
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(data_root() / "scenes"))
    if (entry.path().extension() == ".toml") files.push_back(entry.path());
  std::ranges::sort(files);
  return files;
}

/// The first line of a described scene is `# Title: summary`.
SceneListing describe(const fs::path& file) {
  SceneListing listing{file.stem().string(), file.stem().string(), "", false, is_fetched(file.string())};
  std::string line;
  std::getline(std::ifstream(file), line);
  if (!line.starts_with("# ")) return listing;
  const std::size_t colon = line.find(": ");
  listing.title = line.substr(2, colon == std::string::npos ? colon : colon - 2);
  if (colon != std::string::npos) listing.summary = line.substr(colon + 2);
  return listing;
}

void check_vertices(const Mesh& mesh, const std::string& where) {
  for (std::size_t i = 0; i < mesh.positions.size(); ++i)
    if (const glm::vec3& p = mesh.positions[i]; !is_sound(p))
      throw Error("mesh '{}', vertex {}: position = ({}, {}, {}) is outside {} ({})", mesh.name, i, p.x, p.y, p.z,
                  coordinate_range, where);
  if (mesh.needs_uv() && mesh.uv.size() != mesh.positions.size())
    throw Error("mesh '{}': {} of its {} vertices have a place in its {}; all must have one ({})", mesh.name, mesh.uv.size(),
                mesh.positions.size(), mesh.alpha_mask ? "mask" : "transmission", where);
  for (std::size_t i = 0; i < mesh.uv.size(); ++i)
    if (const glm::vec2& uv = mesh.uv[i]; !is_sound_uv(uv))
      throw Error("mesh '{}', vertex {}: uv = ({}, {}) is outside {} ({})", mesh.name, i, uv.x, uv.y, uv_range, where);
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
    for (int k = 0; k < 3; ++k)
      if (mesh.triangles[i][k] >= mesh.positions.size())
        throw Error("mesh '{}', triangle {}: vertex index {} is outside 0 .. {} ({})", mesh.name, i, mesh.triangles[i][k],
                    static_cast<std::int64_t>(mesh.positions.size()) - 1, where);
}

Scene load_by_id(const std::string& reference, const Descriptions& above) {
  const std::size_t colon = reference.find(':');
  const std::string id = reference.substr(0, colon);
  const std::string settings = colon == std::string::npos ? "" : reference.substr(colon + 1);
  if (const SceneEntry* entry = registry().find_scene(id)) {
    const auto generator = entry->make();
    generator->apply(settings);
    Scene scene = generator->make();
    for (const Mesh& mesh : scene.meshes) check_vertices(mesh, reference);
    check_motion(scene, reference);
    scene.name = generator->settings().empty() ? id : fmt::format("{}:{}", id, generator->settings());
    return scene;
  }
  std::vector<std::string> ids;
  for (const SceneEntry& entry : registry().scenes()) ids.push_back(entry.id);
  for (const fs::path& file : described_scenes()) {
    ids.push_back(file.stem().string());
    if (ids.back() != id) continue;
    if (colon != std::string::npos) throw Error("scene {} has no parameters: it is described in {}", id, file.string());
    return read_scene_toml(file, above);
  }
  std::ranges::sort(ids);
  throw Error("scene {} does not exist; did you mean {}? There are: {}; or give a .toml or mesh file", id,
              nearest_word(id, ids), joined(ids, ", "));
}

template <class Named>
void check_names(const std::vector<Named>& items, std::string_view what, const std::string& where) {
  std::set<std::string_view> seen;
  for (const Named& item : items) {
    if (!is_plain_name(item.name))
      throw Error("{}: name '{}' is not of a..z, 0..9 and _, at most 100 of them ({})", what, item.name, where);
    if (!seen.insert(item.name).second) throw Error("{}: name '{}' is given twice ({})", what, item.name, where);
    check(item, where);
  }
}

/// Where the default eye and lights are, seen from the middle: the eye above the right front, the lights above the left.
constexpr glm::dvec3 toward_eye{0.55, 0.5, 1}, toward_point{-0.7, 1.2, 0.55}, toward_sun{-0.6, 1, 0.3};

/// From three quarters and above, as near as an image no higher than wide can be and still show every vertex.
View framing_view(const Scene& scene, const glm::dvec3& middle) {
  View view;
  const glm::dvec3 back = glm::normalize(toward_eye), right = glm::normalize(glm::cross(glm::dvec3(0, 1, 0), back));
  const glm::dvec3 up = glm::cross(back, right);
  const double slope = std::tan(glm::radians(view.fov_y_degrees / 2.0));
  double distance = 0;
  for (const Mesh& mesh : scene.meshes)
    for (const glm::vec3& p : mesh.positions) {
      const glm::dvec3 q = glm::dvec3(p) - middle;
      const double aside = std::max(std::abs(glm::dot(q, right)), std::abs(glm::dot(q, up)));
      distance = std::max(distance, glm::dot(q, back) + aside / slope);
    }
  constexpr double margin = 1.05;
  view.target = middle;
  view.eye = middle + margin * distance * back;
  return view;
}

}  // namespace

bool is_sound_uv(const glm::vec2& uv) { return std::abs(uv.x) <= largest_uv && std::abs(uv.y) <= largest_uv; }

bool is_sound(const glm::dvec3& p) { return glm::all(glm::lessThanEqual(glm::abs(p), glm::dvec3(largest_coordinate))); }

glm::dvec3 usable_direction(const glm::dvec3& v) {
  constexpr double least = 1e-6, most = 1e6;
  const double largest = extent(v);
  if (!(largest > 0) || !std::isfinite(largest) || (largest >= least && largest <= most)) return v;
  return v / std::pow(10, std::max(std::floor(std::log10(largest)), -300.0));  // 1e-300: powers below are not normal numbers
}

Light usable(Light light) {
  const auto use = [](auto& l) {
    if constexpr (requires { l.direction; }) l.direction = usable_direction(l.direction);
    if constexpr (requires { l.normal; }) l.normal = usable_direction(l.normal);
  };
  std::visit(use, light.kind);
  return light;
}

View usable(View view) {
  view.up = usable_direction(view.up);
  return view;
}

bool is_plain_name(std::string_view name) {
  return !name.empty() && name.size() <= 100 &&
         name.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_") == std::string_view::npos;
}

void check(const Light& light, const std::string& where) {
  const auto need = [&](bool is_good, std::string_view what) {
    if (!is_good) throw Error("light '{}' ({}): {} ({})", light.name, kind_name(light), what, where);
  };
  const auto need_direction = [&](const glm::vec3& v, const char* what) {
    need(is_sound(v) && v != glm::vec3(0), fmt::format("{} = ({}, {}, {}) is not a direction", what, v.x, v.y, v.z));
  };
  const auto need_position = [&](const glm::vec3& v, const char* what) {
    need(is_sound(v), fmt::format("{} = ({}, {}, {}) is outside {}", what, v.x, v.y, v.z, coordinate_range));
  };
  // Below, float32 has no digits left, and processors are set to treat such numbers as 0.
  constexpr double least_length = 1e-30;
  const auto need_length = [&](double length, const std::string& what) {
    need(length >= least_length && length <= largest_coordinate,
         fmt::format("{} is outside {:g} .. {:g} m", what, least_length, largest_coordinate));
  };
  need(light.intensity > 0 && std::isfinite(light.intensity), fmt::format("intensity = {} is not above 0", light.intensity));
  const auto check_kind = [&](const auto& l) {
    if constexpr (requires { l.position; }) need_position(l.position, "position");
    if constexpr (requires { l.center; }) need_position(l.center, "center");
    if constexpr (requires { l.direction; }) need_direction(l.direction, "direction");
    if constexpr (requires { l.normal; }) need_direction(l.normal, "normal");
    if constexpr (requires { l.radius; }) need_length(l.radius, fmt::format("radius = {}", l.radius));
    if constexpr (requires { l.outer_degrees; }) {
      need(l.outer_degrees > 0 && l.outer_degrees < 90,
           fmt::format("outer_degrees = {} is outside 0 .. 90, both excluded", l.outer_degrees));
      need(l.inner_degrees >= 0 && l.inner_degrees <= l.outer_degrees,
           fmt::format("inner_degrees = {} is outside 0 .. outer_degrees = {}", l.inner_degrees, l.outer_degrees));
    }
    if constexpr (requires { l.half_u; }) {
      const glm::dvec3 u = l.half_u, v = l.half_v;
      need_length(glm::length(u), fmt::format("the length of half_u = ({}, {}, {})", u.x, u.y, u.z));
      need_length(glm::length(v), fmt::format("the length of half_v = ({}, {}, {})", v.x, v.y, v.z));
      constexpr double least_sine = 1e-6;  // below, it is rounding
      need(glm::length(glm::cross(u, v)) > least_sine * glm::length(u) * glm::length(v), "half_u and half_v span no area");
    }
  };
  std::visit(check_kind, light.kind);
}

void check(const View& view, const std::string& where) {
  const auto need = [&](bool is_good, std::string_view what) {
    if (!is_good) throw Error("view '{}': {} ({})", view.name, what, where);
  };
  need(is_sound(view.eye) && is_sound(view.target) && is_sound(view.up),
       fmt::format("eye, target or up is outside {}", coordinate_range));
  need(view.eye != view.target, fmt::format("eye = target = ({}, {}, {})", view.eye.x, view.eye.y, view.eye.z));
  // What is left of an `up` this near the line of sight is rounding: the picture could be upright in any direction.
  constexpr double least_sine = 1e-6;
  const glm::dvec3 sight = glm::dvec3(view.target) - glm::dvec3(view.eye), up = view.up;
  need(glm::length(glm::cross(sight, up)) > least_sine * glm::length(sight) * glm::length(up),
       fmt::format("up = ({}, {}, {}) lies along the line of sight", view.up.x, view.up.y, view.up.z));
  need(view.fov_y_degrees > 0 && view.fov_y_degrees < 180,
       fmt::format("fov_y_degrees = {} is outside 0 .. 180, both excluded", view.fov_y_degrees));
  need(view.exposure >= 0 && std::isfinite(view.exposure),
       fmt::format("exposure = {} is not finite and 0 or more", view.exposure));
}

void finish_scene(Scene& scene, const std::string& where) {
  for (Light& light : scene.lights) light = usable(light);
  for (View& view : scene.views) view = usable(view);
  check_names(scene.lights, "light", where);
  check_names(scene.views, "view", where);
  for (const Mesh& mesh : scene.meshes) check_vertices(mesh, where);
  check_motion(scene, where);
  merge_duplicates(scene);
  for (Mesh& mesh : scene.meshes)
    if ((mesh.alpha_mask || mesh.transmission) && mesh.has_curved_shape()) {
      mesh.shape.reset();
      scene.notes.push_back(fmt::format("mesh '{}' has {}: its triangles are taken, not its exact shape", mesh.name,
                                        mesh.alpha_mask ? "an alpha mask" : "a transmission"));
    }
  finish_meshes(scene);
  std::size_t dropped = 0;
  for (const Mesh& mesh : scene.meshes) dropped += mesh.facts.degenerate_count;
  if (dropped > 0) scene.notes.push_back(counted(dropped, "triangle{s} without area {is|are} dropped"));
  drop_empty_meshes(scene);
  for (const Mesh& mesh : scene.meshes)
    if (!mesh.casts && !mesh.seen)
      scene.notes.push_back(fmt::format("mesh '{}' neither casts nor is seen: it changes nothing", mesh.name));
  // A file that is placed many times says the same each time.
  std::set<std::string> said;
  std::erase_if(scene.notes, [&](const std::string& note) { return !said.insert(note).second; });
  if (scene.motion && !has_geometry_at_rest(scene))
    throw Error("scene '{}' has no geometry at rest; it has animations: {} ({})", scene.name,
                joined(names_of(scene.motion->animations), ", "), where);
  if (scene.meshes.empty()) throw Error("scene '{}' has no geometry ({})", scene.name, where);
}

Scene read_scene(const std::string& reference, const Descriptions& above) {
  if (const TimedReference timed = split_time(reference); timed.at) {
    if (split_time(timed.scene).at) throw Error("scene {:.200} has two times; one is allowed", reference);
    Scene still = read_scene(timed.scene, above);
    if (above.empty()) add_framing_at_rest(still);
    try {
      freeze(still, *timed.at);
    } catch (const Error& error) {
      if (!names_file(timed.scene)) throw;
      throw Error("{}: {}", timed.scene, error.what());
    }
    still.name = with_time(still.name, *timed.at);
    return still;
  }
  if (!names_file(reference)) return load_by_id(reference, above);
  const fs::path file = reference;
  if (file.extension() == ".toml") return read_scene_toml(file, above);
  Scene scene;
  scene.name = file.stem().string();
  import_file(file, {}, scene);
  return scene;
}

void add_framing(Scene& scene) {
  const Bounds bounds = scene.bounds();
  if (bounds.empty()) return;
  const glm::dvec3 low(bounds.min), high(bounds.max), middle = (low + high) / 2.0;
  if (scene.views.empty()) {
    scene.views.push_back(framing_view(scene, middle));
    scene.notes.push_back("no view given: view 'view' frames the whole scene");
  }
  if (scene.lights.empty()) {
    // Twice the radius of the sphere around the bounds: outside all geometry.
    const glm::vec3 position(middle + glm::length(high - low) * glm::normalize(toward_point));
    scene.lights = shining_at(glm::vec3(middle), {{.name = "point", .kind = PointLight{position}},
                                                  {.name = "sun", .kind = DirectionalLight{glm::vec3(-toward_sun)}}});
    scene.notes.push_back("no light given: 'point' stands above the left front, 'sun' comes from there");
  }
}

Scene load_scene(const std::string& reference) {
  Scene scene = read_scene(reference, {});
  finish_scene(scene, reference);
  scene.motion ? add_framing_at_rest(scene) : add_framing(scene);
  split_lights(scene);
  return scene;
}

std::vector<SceneListing> list_scenes() {
  std::vector<SceneListing> listings;
  for (const SceneEntry& entry : registry().scenes())
    listings.push_back({entry.id, std::string(entry.about.title), std::string(entry.about.summary), true});
  for (const fs::path& file : described_scenes()) listings.push_back(describe(file));
  std::ranges::sort(listings, {}, &SceneListing::id);
  return listings;
}

}  // namespace gnomon
