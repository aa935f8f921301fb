#pragma once
#include <gnomon/kit/edges.h>

namespace stencil_volume {
using namespace gnomon;

/// How many shadow volumes hold the eye. Where its way to the light goes exactly through an edge, triangles beside the edge
/// cannot be told apart, and a point a rounding away is asked instead.
std::int64_t volumes_at(const EdgeAdjacency& adjacency, const glm::vec3& eye, const Silhouette& silhouette);

/// Whether the light lies in the near plane of a view, as far as float32 tells: seen from it the near rectangle is a line, and
/// nothing can be thrown onto it.
bool is_in_near_plane(const glm::dvec4& light, const View& view);

/// Where the eye lies among the shadow volumes.
struct EyePlace {
  bool inside = false;      ///< of some volume
  bool near_plane = false;  ///< a face of a volume is within reach of the near rectangle
  bool boundary = false;    ///< within rounding of a face: for one rounding inside, for another outside
};

/// In double. Rounding is taken as 2^-16 of the scene's extent, 256 float32 roundings of its largest coordinate: a side quad
/// seen so nearly edge-on was seen to be off by 2^-18 of it.
EyePlace find_eye_place(const Scene& scene, const Light& light, const View& view);

}  // namespace stencil_volume
