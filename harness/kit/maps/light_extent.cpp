#include <gnomon/kit/geometry/clip.h>
#include <gnomon/kit/maps/light_camera.h>

namespace gnomon {

namespace {

/// Corner i has the larger x where bit 0 of i is set, y for bit 1, z for bit 2.
std::array<glm::dvec3, 8> corners_of(const LightSpaceFace& face, const Bounds& box) {
  std::array<glm::dvec3, 8> corners;
  for (int i = 0; i < 8; ++i)
    corners[i] = face.seen({i & 1 ? box.max.x : box.min.x, i & 2 ? box.max.y : box.min.y, i & 4 ? box.max.z : box.min.z});
  return corners;
}

/// The part of a solid box inside the pyramid |x|, |y| <= tangent * z. From outside, a solid's picture is its surface's
/// picture.
LightExtent seen_in_pyramid(const LightSpaceFace& face, const Bounds& box, double tangent) {
  const glm::dvec3 planes[] = {{1, 0, tangent}, {-1, 0, tangent}, {0, 1, tangent}, {0, -1, tangent}};
  const std::array<glm::dvec3, 8> corners = corners_of(face, box);
  LightExtent extent;
  bool all_inside = true;
  for (const glm::dvec3& plane : planes) {
    const auto inside = std::ranges::count_if(corners, [&](const glm::dvec3& c) { return glm::dot(plane, c) > 0; });
    if (inside == 0) return extent;
    all_inside = all_inside && inside == 8;
  }
  const auto add = [&](const glm::dvec3& q) { extent.add(face.place(q), q.z); };
  if (all_inside) {
    std::ranges::for_each(corners, add);
    return extent;
  }
  Clipper quad;
  for (int axis = 0; axis < 3; ++axis)
    for (int side = 0; side < 2; ++side) {
      const int base = side << axis, u = 1 << (axis + 1) % 3, v = 1 << (axis + 2) % 3;
      quad.start();
      for (const int corner : {base, base | u, base | u | v, base | v}) quad.add({corners[corner]});
      const bool is_seen = std::ranges::all_of(planes, [&](const glm::dvec3& plane) {
        return quad.keep_positive({plane, 0}, 0) != Lies::negative;
      });
      if (!is_seen) continue;
      for (const Corner& corner : quad.corners())
        if (corner.at.z > 0) add(corner.at);
    }
  if (box.holds(face.origin)) {
    extent.add(glm::dvec2(-tangent), 0);
    extent.add(glm::dvec2(tangent), 0);
  }
  return extent;
}

}  // namespace

LightExtent seen_of(const LightSpaceFace& face, const Bounds& box, double tangent) {
  if (face.is_perspective) return seen_in_pyramid(face, box, tangent);
  LightExtent extent;
  for (const glm::dvec3& q : corners_of(face, box)) extent.add(glm::dvec2(q), q.z);
  return extent;
}

}  // namespace gnomon
