#pragma once
#include <gnomon/technique.h>

namespace gnomon {

inline constexpr std::uint32_t no_plane = 0xffffffffu;

/// A maximal set of coplanar triangles of receiving meshes, connected or not, whichever way they are wound.
struct ReceiverPlane {
  glm::dvec4 plane{0};  ///< unit normal and offset: dot(plane, (p, 1)) is the height of p, meters
  double area = 0;      ///< square meters
};

struct ReceiverPlanes {
  std::vector<ReceiverPlane> planes;          ///< largest first
  std::vector<std::uint32_t> plane_of;        ///< of each triangle of the scene, mesh after mesh; no_plane
  std::vector<std::uint32_t> first_triangle;  ///< of each mesh, in plane_of
  double receiving_area = 0;                  ///< of all receiving meshes
  double planar_area = 0;                     ///< of what lies on the planes
  double tolerance = 0;                       ///< heights up to this are height zero, meters
};

/// How far off dot(plane, (p, 1)) in float32 may be at points of the scene, meters.
double height_rounding(const Scene& scene);

/// The planes that hold at least `min_share` (0 .. 1) of the receiving area.
ReceiverPlanes find_receiver_planes(const Scene& scene, double min_share);

/// What a technique supports that answers on receiver planes alone: nothing without a plane, all where the planes hold all of
/// the receiving area, else an approximation. `covered_share` is the planes' share of that area, 0 .. 1.
Support support_on_planes(bool has_planes, double covered_share, double min_share);
inline Support support_on_planes(const ReceiverPlanes& found, double min_share) {
  return support_on_planes(!found.planes.empty(), found.planar_area / found.receiving_area, min_share);
}

}  // namespace gnomon
