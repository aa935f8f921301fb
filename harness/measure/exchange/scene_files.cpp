#include "measure/exchange/scene_files.h"

#include <algorithm>

#include "measure/picture/picture.h"
#include "measure/scene/channels.h"
#include "measure/scene/scene_json.h"

namespace gnomon {

namespace {

/// The first word of each alpha mask of a scene in the array of all bits, in the order of the meshes.
std::map<const AlphaMask*, std::size_t> first_words(const Scene& scene) {
  std::map<const AlphaMask*, std::size_t> first;
  std::size_t words = 0;
  for (const Mesh& mesh : scene.meshes)
    if (mesh.alpha_mask && first.try_emplace(mesh.alpha_mask.get(), words).second) words += mesh.alpha_mask->bits().size();
  return first;
}

/// The first number of each transmission of a scene in the array of all values, in the order of the meshes.
std::map<const Transmission*, std::size_t> first_values(const Scene& scene) {
  std::map<const Transmission*, std::size_t> first;
  std::size_t values = 0;
  for (const Mesh& mesh : scene.meshes)
    if (mesh.transmission && first.try_emplace(mesh.transmission.get(), values).second)
      values += mesh.transmission->values().size();
  return first;
}

/// Whether the files say what lets light through, and what is seen.
bool has_glass_or_unseen(const Scene& scene) {
  return std::ranges::any_of(scene.meshes, [](const Mesh& mesh) { return mesh.transmission || !mesh.seen; });
}

Json transmission_json(const Transmission& transmission, std::size_t first_value) {
  return json_object({{"first_value", first_value},
                      {"width", transmission.width()},
                      {"height", transmission.height()},
                      {"channels", transmission.channels()},
                      {"wrap_u", wrap_name(transmission.wrap_u())},
                      {"wrap_v", wrap_name(transmission.wrap_v())}});
}

Json mask_json(const AlphaMask& mask, std::size_t first_word) {
  return json_object({{"first_word", first_word},
                      {"width", mask.width()},
                      {"height", mask.height()},
                      {"wrap_u", wrap_name(mask.wrap_u())},
                      {"wrap_v", wrap_name(mask.wrap_v())},
                      {"cutoff", number_json(mask.cutoff())}});
}

}  // namespace

Json scene_facts_json(const Scene& scene) {
  Json json = json_object({{"name", scene.name}, {"ambient", number_json(scene.ambient)}});
  for (const char* list : {"meshes", "lights", "views"}) json[list] = Json::array();
  std::size_t vertex = 0, triangle = 0;
  const bool has_masks = scene.has_alpha_masks(), is_of_glass = has_glass_or_unseen(scene);
  const auto words = first_words(scene);
  const auto values = first_values(scene);
  for (const Mesh& mesh : scene.meshes) {
    json["meshes"].push_back(json_object({{"name", mesh.name},
                                          {"casts", mesh.casts},
                                          {"receives", mesh.receives},
                                          {"albedo", number_json(mesh.albedo)},
                                          {"shape", mesh.shape ? scene_json(*mesh.shape) : Json()},
                                          {"first_vertex", vertex},
                                          {"vertices", mesh.positions.size()},
                                          {"first_triangle", triangle},
                                          {"triangles", mesh.triangles.size()}}));
    if (has_masks)
      json["meshes"].back()["alpha_mask"] =
          mesh.alpha_mask ? mask_json(*mesh.alpha_mask, words.at(mesh.alpha_mask.get())) : Json();
    if (is_of_glass) {
      json["meshes"].back()["transmission"] =
          mesh.transmission ? transmission_json(*mesh.transmission, values.at(mesh.transmission.get())) : Json();
      json["meshes"].back()["seen"] = mesh.seen;
    }
    vertex += mesh.positions.size();
    triangle += mesh.triangles.size();
  }
  for (const Light& light : whole_lights(scene.lights)) json["lights"].push_back(scene_json(light));
  for (const View& view : scene.views) json["views"].push_back(scene_json(view));
  return json;
}

SceneArrays::SceneArrays(const Scene& scene) {
  for (std::uint32_t m = 0; m < scene.meshes.size(); ++m) {
    const Mesh& mesh = scene.meshes[m];
    const auto first = static_cast<std::uint32_t>(positions_.size());
    positions_.insert(positions_.end(), mesh.positions.begin(), mesh.positions.end());
    for (const glm::uvec3& corners : mesh.triangles) triangles_.push_back(corners + first);
    meshes_.insert(meshes_.end(), mesh.triangles.size(), m);
  }
  if (std::ranges::none_of(scene.meshes, [](const Mesh& mesh) { return mesh.alpha_mask || mesh.transmission; })) return;
  const auto words = first_words(scene);
  const auto values = first_values(scene);
  for (const Mesh& mesh : scene.meshes) {
    uv_.insert(uv_.end(), mesh.uv.begin(), mesh.uv.end());
    uv_.resize(uv_.size() + mesh.positions.size() - mesh.uv.size());  // of a mesh without places: zeros
    if (mesh.transmission && values.at(mesh.transmission.get()) == values_.size())
      values_.insert(values_.end(), mesh.transmission->values().begin(), mesh.transmission->values().end());
    if (mesh.alpha_mask && words.at(mesh.alpha_mask.get()) == bits_.size())
      bits_.insert(bits_.end(), mesh.alpha_mask->bits().begin(), mesh.alpha_mask->bits().end());
  }
}

Arrays SceneArrays::arrays() const {
  const auto floats = std::span(reinterpret_cast<const float*>(positions_.data()), 3 * positions_.size());
  const auto corners = std::span(reinterpret_cast<const std::uint32_t*>(triangles_.data()), 3 * triangles_.size());
  Arrays arrays = {{"position", array_of<float>({positions_.size(), 3}, {floats})},
                   {"triangle", array_of<std::uint32_t>({triangles_.size(), 3}, {corners})},
                   {"mesh", array_of<std::uint32_t>({meshes_.size()}, {meshes_})}};
  if (bits_.empty() && values_.empty()) return arrays;
  const auto places = std::span(reinterpret_cast<const float*>(uv_.data()), 2 * uv_.size());
  arrays.emplace("uv", array_of<float>({uv_.size(), 2}, {places}));
  if (!bits_.empty()) arrays.emplace("alpha_mask_bits", array_of<std::uint32_t>({bits_.size()}, {bits_}));
  if (!values_.empty()) arrays.emplace("transmission_values", array_of<float>({values_.size()}, {values_}));
  return arrays;
}

Arrays gbuffer_arrays(const GBuffer& g) {
  const auto w = static_cast<std::size_t>(g.width), h = static_cast<std::size_t>(g.height);
  return {{"position", array_of<float>({3, h, w}, {g.px, g.py, g.pz})},
          {"normal", array_of<float>({3, h, w}, {g.nx, g.ny, g.nz})},
          {"mesh", array_of<std::uint32_t>({h, w}, {g.mesh})},
          {"triangle", array_of<std::uint32_t>({h, w}, {g.triangle})}};
}

void write_gbuffer_exr(const std::filesystem::path& file, const GBuffer& g) {
  std::vector<float> mesh(g.size()), triangle(g.size());
  for (std::size_t i = 0; i < g.size(); ++i) {
    mesh[i] = g.is_background(i) ? -1.0f : static_cast<float>(g.mesh[i]);
    triangle[i] = static_cast<float>(g.triangle[i]);
  }
  const std::vector<std::string> names = {"position.X", "position.Y", "position.Z", "normal.X",
                                          "normal.Y",   "normal.Z",   "mesh",       "triangle"};
  const std::vector<std::span<const float>> channels = {g.px, g.py, g.pz, g.nx, g.ny, g.nz, mesh, triangle};
  write_exr(file, g.width, g.height, names, channels);
}

Json write_arrays(const std::filesystem::path& folder, const std::string& what, const Arrays& arrays) {
  Json json = json_object();
  for (const auto& [name, array] : arrays) json[name] = write_array(folder / fmt::format("{}_{}.npy", what, name), array);
  return json;
}

}  // namespace gnomon
