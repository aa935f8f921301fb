#pragma once
#include <gnomon/kit/bins.h>
#include <gnomon/kit/geometry/edges.h>
#include <gnomon/kit/gl/gl.h>

#include <vector>

#include "pages.h"

// Which triangles touch which pages.
namespace gnomon::virtual_map {

/// A box of texels of level 0 that holds all that a triangle covers on a face.
struct Footprint {
  glm::vec2 low, high;
  std::uint32_t mesh, triangle;
};

/// The casters of each face of a camera. Of closed meshes lit from outside only what is not turned away from the light.
struct Footprints {
  std::vector<Footprint> all;        ///< face after face
  std::vector<std::size_t> begin{};  ///< of each face; one more ends the last
};
Footprints footprints_of(const Scene& scene, const SolidParts& solid_parts, const LightCamera& camera);

/// What each page draws. Triangles that reach far beyond their page come after the others, and are drawn apart: drivers clip
/// all triangles of a draw one by one as soon as one of them needs it (70 ms become 46 ms, bunny, llvmpipe).
struct DrawLists {
  Bins bins;                           ///< footprints: those of slot k are in bins 2 k and, far beyond it, 2 k + 1
  std::vector<std::uint32_t> corners;  ///< three vertices a triangle; those of bin b begin at 3 bins.begin[b]
  std::size_t triangle_count() const { return bins.items.size(); }
};
void fill(DrawLists& lists, const Scene& scene, const SceneBuffers& buffers, const LightCamera& camera,
          const Footprints& footprints, const PageTable& table, int page_size);

}  // namespace gnomon::virtual_map
