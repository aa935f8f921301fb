#pragma once
#include <gnomon/gbuffer.h>
#include <gnomon/scene.h>

#include <vector>

namespace gnomon {

/// A G-buffer as devices get it: all of a pixel is 0 where it is background.
struct GBufferTexels {
  GBufferTexels(const GBuffer& g, const Scene& scene) : positions(g.size()), normals(g.size()), ids(g.size()) {
    for (std::size_t i = 0; i < g.size(); ++i) {
      if (g.is_background(i)) continue;
      positions[i] = {g.position(i), 1};
      normals[i] = {g.normal(i), scene.meshes[g.mesh[i]].receives ? 1 : 0};
      ids[i] = {g.mesh[i] + 1, g.triangle[i]};
    }
  }

  std::vector<glm::vec4> positions;  ///< meters, world; 1
  std::vector<glm::vec4> normals;    ///< unit; whether the mesh receives shadows
  std::vector<glm::uvec2> ids;       ///< number of the mesh and 1, number of the triangle
};

}  // namespace gnomon
