#include "measure/exchange/scene_files.h"

#include "measure/picture/picture.h"
#include "measure/scene/scene_json.h"

namespace gnomon {

Json scene_facts_json(const Scene& scene) {
  Json json = json_object({{"name", scene.name}, {"ambient", number_json(scene.ambient)}});
  for (const char* list : {"meshes", "lights", "views"}) json[list] = Json::array();
  std::size_t vertex = 0, triangle = 0;
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
}

Arrays SceneArrays::arrays() const {
  const auto floats = std::span(reinterpret_cast<const float*>(positions_.data()), 3 * positions_.size());
  const auto corners = std::span(reinterpret_cast<const std::uint32_t*>(triangles_.data()), 3 * triangles_.size());
  return {{"position", array_of<float>({positions_.size(), 3}, {floats})},
          {"triangle", array_of<std::uint32_t>({triangles_.size(), 3}, {corners})},
          {"mesh", array_of<std::uint32_t>({meshes_.size()}, {meshes_})}};
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
