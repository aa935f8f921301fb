#include "measure/exchange/scene_files.h"

#include "measure/picture/picture.h"
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
  const bool has_masks = scene.has_alpha_masks();
  const auto words = first_words(scene);
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
    vertex += mesh.positions.size();
    triangle += mesh.triangles.size();
  }
  for (const Light& light : scene.lights) json["lights"].push_back(scene_json(light));
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
  if (!scene.has_alpha_masks()) return;
  const auto words = first_words(scene);
  for (const Mesh& mesh : scene.meshes) {
    uv_.insert(uv_.end(), mesh.uv.begin(), mesh.uv.end());
    uv_.resize(uv_.size() + mesh.positions.size() - mesh.uv.size());  // of a mesh without a mask: zeros
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
  if (bits_.empty()) return arrays;
  const auto places = std::span(reinterpret_cast<const float*>(uv_.data()), 2 * uv_.size());
  arrays.emplace("uv", array_of<float>({uv_.size(), 2}, {places}));
  arrays.emplace("alpha_mask_bits", array_of<std::uint32_t>({bits_.size()}, {bits_}));
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
