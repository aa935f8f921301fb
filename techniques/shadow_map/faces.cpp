#include "faces.h"

#include <gnomon/kit/across.h>
#include <gnomon/kit/clip.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace gnomon::shadow_map {

glm::dmat4 Face::clip_from_world(int resolution) const {
  const glm::dvec2 s = 2.0 * scale / double(resolution), o = 2.0 * offset / double(resolution) - 1.0;
  // Clip space has y up and texel rows go down.
  const glm::dvec4 w = is_perspective ? glm::dvec4(0, 0, 1, 0) : glm::dvec4(0, 0, 0, 1);
  const glm::dvec4 x = s.x * glm::dvec4(1, 0, 0, 0) + o.x * w, y = -s.y * glm::dvec4(0, 1, 0, 0) - o.y * w;
  const glm::dvec4 z = is_perspective ? glm::dvec4(0, 0, 0, near) : glm::dvec4(0, 0, -1, far) / (far - near);
  glm::dmat4 turned_and_moved(light_from_world);
  turned_and_moved[3] = glm::dvec4(-(light_from_world * origin), 1);
  return glm::transpose(glm::dmat4(x, y, z, w)) * turned_and_moved;
}

double Face::axis_distance(double depth) const {
  if (depth == 0) return INFINITY;
  return is_perspective ? near / depth : far - depth * (far - near);
}

bool is_inside(const glm::ivec2& texel, int resolution) {
  return glm::all(glm::greaterThanEqual(texel, glm::ivec2(0))) && glm::all(glm::lessThan(texel, glm::ivec2(resolution)));
}

namespace {

/// What of some boxes is seen through a window: a rectangle of window coordinates and a range of axis distance.
struct Extent {
  glm::dvec2 low{INFINITY}, high{-INFINITY};
  double near = INFINITY, far = -INFINITY;
  bool empty() const { return near > far; }
  void add(const glm::dvec2& window, double z) { add({window, window, z, z}); }
  void add(const Extent& e) {
    low = glm::min(low, e.low);
    high = glm::max(high, e.high);
    near = std::min(near, e.near);
    far = std::max(far, e.far);
  }
};

/// Corner i has the larger x where bit 0 of i is set, y for bit 1, z for bit 2.
std::array<glm::dvec3, 8> corners_of(const LightFace& face, const Bounds& box) {
  std::array<glm::dvec3, 8> corners;
  for (int i = 0; i < 8; ++i)
    corners[i] = face.seen({i & 1 ? box.max.x : box.min.x, i & 2 ? box.max.y : box.min.y, i & 4 ? box.max.z : box.min.z});
  return corners;
}

/// The part of a solid box inside the pyramid |x|, |y| <= tangent * z. From outside, a solid's picture is its surface's
/// picture.
Extent seen_in_pyramid(const LightFace& face, const Bounds& box, double tangent) {
  const glm::dvec3 planes[] = {{1, 0, tangent}, {-1, 0, tangent}, {0, 1, tangent}, {0, -1, tangent}};
  const std::array<glm::dvec3, 8> corners = corners_of(face, box);
  Extent extent;
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

Extent seen_orthographic(const LightFace& face, const Bounds& box) {
  Extent extent;
  for (const glm::dvec3& q : corners_of(face, box)) extent.add(glm::dvec2(q), q.z);
  return extent;
}

/// Fits the face to what its casters and receivers share. `tangent` is half the pyramid's opening (unused when orthographic).
void fit(Face& face, const std::vector<MeshBox>& boxes, double tangent, int resolution, int margin) {
  const double inner = resolution - 2.0 * margin;
  const double wide = tangent * resolution / inner;  // the pyramid with its margin
  Extent casters, receivers;
  for (std::uint32_t i = 0; i < boxes.size(); ++i) {
    const MeshBox& mesh = boxes[i];
    const auto seen = [&](double t) {
      return face.is_perspective ? seen_in_pyramid(face, mesh.bounds, t) : seen_orthographic(face, mesh.bounds);
    };
    if (mesh.receives) receivers.add(seen(tangent));
    if (!mesh.casts) continue;
    const Extent extent = seen(wide);
    if (extent.empty()) continue;
    casters.add(extent);
    face.casters.push_back(i);
  }
  const glm::dvec2 low = glm::max(casters.low, receivers.low), high = glm::min(casters.high, receivers.high);
  if (casters.empty() || receivers.empty() || low.x > high.x || low.y > high.y || casters.near >= receivers.far) {
    face.casters.clear();
    return;
  }
  // Texels below the float32 resolution of window coordinates would be noise.
  const glm::dvec2 least = 0x1p-20 * glm::max(glm::max(glm::abs(low), glm::abs(high)), glm::dvec2(glm::length(high - low)));
  const glm::dvec2 texel = glm::max((high - low) / inner, least);
  face.scale = 1.0 / texel;
  face.offset = resolution / 2.0 - (low + high) / 2.0 * face.scale;
  // Casters nearer than 1/1024 of the reach are clamped to it: they still cast, and depth keeps its precision.
  face.far = receivers.far;
  face.near = face.is_perspective ? std::max(casters.near, face.far * 0x1p-10) : casters.near;
}

/// Right, down, axis.
glm::dmat3 frame_along(const glm::dvec3& axis) {
  const glm::dvec3 a = glm::abs(axis);
  const glm::dvec3 helper = a.x >= a.y && a.x >= a.z ? glm::dvec3(0, 1, 0)
                            : a.y >= a.z             ? glm::dvec3(0, 0, 1)
                                                     : glm::dvec3(1, 0, 0);
  const auto [u, v] = Across(axis, helper);
  return frame_of(v, -u, axis);
}

const SpotLight* narrow_spot(const Light& light) {
  const auto* spot = std::get_if<SpotLight>(&light.kind);
  return spot && spot->outer_degrees <= widest_spot_degrees ? spot : nullptr;
}

/// The ray through the center of a texel, and what is stored there; infinity also off the image.
Tap tap_of(const Image& image, const glm::ivec2& texel, double weight) {
  const Face& face = image.face;
  const glm::dvec2 window = (glm::dvec2(texel) + 0.5 - face.offset) / face.scale;
  const double z = is_inside(texel, image.resolution)
                       ? face.axis_distance(image.depths[std::size_t(texel.y) * image.resolution + texel.x])
                       : INFINITY;
  if (!face.is_perspective) return {face.to_world({window, face.near}), face.axis(2), weight, z - face.near};
  const glm::dvec3 through(window, 1);
  return {face.origin, glm::normalize(through * face.light_from_world), weight, z * glm::length(through)};
}

}  // namespace

LightSpace space_of(const Light& light, const std::vector<MeshBox>& boxes) {
  const glm::dvec4 l = homogeneous(light);
  if (l.w == 0) {
    Bounds all;
    for (const MeshBox& mesh : boxes) all.add(mesh.bounds);
    const glm::dvec3 middle = (glm::dvec3(all.min) + glm::dvec3(all.max)) / 2.0;
    return LightSpace(LightFace{middle, frame_along(-glm::normalize(glm::dvec3(l))), false});
  }
  if (const SpotLight* const spot = narrow_spot(light))
    return LightSpace(LightFace{glm::dvec3(l), frame_along(glm::normalize(glm::dvec3(spot->direction))), true});
  return {glm::dvec3(l), glm::dmat3(1), OppositeFaces::mirrored, 0};
}

std::vector<Face> fit_faces(const Light& light, const LightSpace& space, const std::vector<MeshBox>& boxes, int resolution,
                            int margin) {
  const SpotLight* const spot = narrow_spot(light);
  const double tangent = spot ? std::tan(glm::radians(double(spot->outer_degrees))) : 1;
  std::vector<Face> faces;
  for (int i = 0; i < space.face_count(); ++i) {
    faces.push_back({space[i]});
    fit(faces.back(), boxes, tangent, resolution, margin);
  }
  return faces;
}

Explanation explain(const Image& image, const Comparison& comparison, const glm::dvec3& point, const glm::dvec3& normal,
                    const glm::ivec2& center) {
  const Face& face = image.face;
  Explanation why;
  glm::dvec3 q = face.seen(point);
  const glm::dvec3 n = face.turned(normal);
  const glm::dvec3 ray = face.is_perspective ? q / q.z : glm::dvec3(0, 0, 1);
  const double facing = -glm::dot(n, ray);
  const glm::dvec2 width = face.texel_width(q.z);
  why.texel_width = std::max(width.x, width.y);
  double axis_bias = comparison.depth_bias * why.texel_width;
  if (comparison.bias == Bias::slope)
    axis_bias += comparison.slope_bias * glm::length(width) / 2 * glm::length(glm::cross(n, ray)) / (facing * glm::length(ray));
  if (comparison.bias == Bias::receiver_plane) {
    const double error = comparison.rounding * (face.is_perspective ? 1 + q.z * q.z / (face.near * face.far) : 1);
    axis_bias += (error + why.texel_width / 128) / facing;
  }
  if (comparison.bias == Bias::normal_offset) {
    const double z = q.z;
    q += n * (comparison.normal_offset * why.texel_width);
    why.shifted = face.to_world(q);
    axis_bias += z - q.z;  // what the look-up point is nearer to the light by
  }
  why.bias = axis_bias * glm::length(ray);
  // A point that nothing shadows may be looked up beside the image; where something does, its shadow is not in there.
  why.covered = is_inside(center, image.resolution);
  const int r = comparison.radius;
  for (int y = -r; y <= r; ++y)
    for (int x = -r; x <= r; ++x)
      why.taps.push_back(tap_of(image, center + glm::ivec2(x, y), 1.0 / ((2 * r + 1) * (2 * r + 1))));
  return why;
}

}  // namespace gnomon::shadow_map
