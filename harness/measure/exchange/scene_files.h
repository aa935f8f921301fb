#pragma once
#include <gnomon/gbuffer.h>

#include <filesystem>
#include <map>
#include <string>

#include "measure/exchange/arrays.h"

namespace gnomon {

/// Named arrays.
using Arrays = std::map<std::string, ArrayParts>;

/// Everything of a scene but its triangles: name, ambient, meshes (name, casts, receives, albedo, shape, and where in the
/// arrays their vertices and triangles are), lights, views. Where a mesh has an alpha mask each also has `alpha_mask`: null, or
/// size, wrap, cutoff, and where its bits begin. Where a mesh lets light through or is not seen each also has `transmission`,
/// null, or size, channels, wrap, and where its values begin, and `seen`.
Json scene_facts_json(const Scene& scene);

/// All meshes of a scene, one after the other. `position`: float32, vertices x 3, meters. `triangle`: uint32, triangles x 3,
/// indices into `position`. `mesh`: uint32, the mesh of each triangle. Where a mesh has an alpha mask or a transmission: `uv`,
/// float32, vertices x 2. Where one has an alpha mask: `alpha_mask_bits`, uint32, the rows of bits of all masks, one after the
/// other, each once. Where one has a transmission: `transmission_values`, float32, the texels of all, the same way.
class SceneArrays {
 public:
  explicit SceneArrays(const Scene& scene);
  Arrays arrays() const;

 private:
  std::vector<glm::vec3> positions_;
  std::vector<glm::uvec3> triangles_;
  std::vector<std::uint32_t> meshes_;
  std::vector<glm::vec2> uv_;
  std::vector<std::uint32_t> bits_;
  std::vector<float> values_;
};

/// `position` and `normal`: float32, 3 x height x width, the x of all pixels, then y, then z. `mesh` and `triangle`: uint32,
/// height x width; the mesh is 4294967295 where the background is.
Arrays gbuffer_arrays(const GBuffer& gbuffer);

/// The same as an EXR of float channels: position.X, .Y, .Z, normal.X, .Y, .Z, mesh (-1: background), triangle.
void write_gbuffer_exr(const std::filesystem::path& file, const GBuffer& gbuffer);

/// Writes each array to WHAT_NAME.npy, such as "gbuffer_position.npy", in a folder that exists. Returns for each name what
/// write_array returns.
Json write_arrays(const std::filesystem::path& folder, const std::string& what, const Arrays& arrays);

}  // namespace gnomon
