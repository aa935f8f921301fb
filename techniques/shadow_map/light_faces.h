#pragma once
#include <gnomon/light.h>
#include <gnomon/scene.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

// The light's depth images: six faces of a cube around a point light (or a wide spot), one image for a narrow spot or a
// directional light. Each is fitted to casters and receivers, never to the view.
namespace shadow_map {
using namespace gnomon;

/// Bounding box of a mesh.
struct MeshBox {
  Bounds bounds;
  bool casts, receives;
};

/// Light space: q = frame * (world - origin), z along the face's axis away from the light. Window coordinates of q are tangents
/// q.xy / q.z (perspective) or meters q.xy (orthographic). Texel coordinates are window * scale + offset, row 0 on top.
struct Face {
  glm::dvec3 origin{0};
  glm::dmat3 frame{1};
  bool perspective = true;
  glm::dvec2 scale{1}, offset{0};
  double near = 0, far = 0;              ///< along the axis, meters; casters outside are clamped to it
  std::vector<std::uint32_t> casters{};  ///< indices of the meshes to draw; none: nothing to draw and nothing to look up

  glm::dvec3 to_light_space(const glm::dvec3& world) const { return frame * (world - origin); }
  glm::dvec3 to_world(const glm::dvec3& q) const { return origin + q * frame; }
  glm::dvec2 texel(const glm::dvec3& q) const { return glm::dvec2(q) / (perspective ? q.z : 1) * scale + offset; }
  /// World width of a texel across the axis at axis distance z.
  glm::dvec2 texel_width(double z) const { return (perspective ? z : 1) / scale; }
  /// Reversed depth: near / z, or linear; 1 at `near`, 0 at infinity or `far`.
  glm::dmat4 clip_from_world(int resolution) const {
    const glm::dvec2 s = 2.0 * scale / double(resolution), o = 2.0 * offset / double(resolution) - 1.0;
    // Clip space has y up and texel rows go down.
    const glm::dvec4 w = perspective ? glm::dvec4(0, 0, 1, 0) : glm::dvec4(0, 0, 0, 1);
    const glm::dvec4 x = s.x * glm::dvec4(1, 0, 0, 0) + o.x * w, y = -s.y * glm::dvec4(0, 1, 0, 0) - o.y * w;
    const glm::dvec4 z = perspective ? glm::dvec4(0, 0, 0, near) : glm::dvec4(0, 0, -1, far) / (far - near);
    glm::dmat4 light_from_world(frame);
    light_from_world[3] = glm::dvec4(-(frame * origin), 1);
    return glm::transpose(glm::dmat4(x, y, z, w)) * light_from_world;
  }
};

/// What of some boxes is seen through a window: a rectangle of window coordinates and a range of axis distance.
struct Extent {
  glm::dvec2 low{INFINITY}, high{-INFINITY};
  double near = INFINITY, far = -INFINITY;
  bool empty() const { return near > far; }
  void add(const glm::dvec2& window, double z) {
    low = glm::min(low, window), high = glm::max(high, window);
    near = std::min(near, z), far = std::max(far, z);
  }
  void add(const Extent& e) {
    low = glm::min(low, e.low), high = glm::max(high, e.high);
    near = std::min(near, e.near), far = std::max(far, e.far);
  }
};

/// A convex polygon clipped by at most four planes through the light: a quad grows by one corner a plane.
struct Polygon {
  std::array<glm::dvec3, 8> corners;
  int count = 0;
  void add(const glm::dvec3& p) { corners[count++] = p; }
};

inline Polygon clip(const Polygon& polygon, const glm::dvec3& plane) {
  Polygon kept;
  for (int i = 0; i < polygon.count; ++i) {
    const glm::dvec3 &a = polygon.corners[i], &b = polygon.corners[(i + 1) % polygon.count];
    const double da = glm::dot(plane, a), db = glm::dot(plane, b);
    if (da >= 0) kept.add(a);
    if ((da >= 0) != (db >= 0)) kept.add(a + (b - a) * (da / (da - db)));
  }
  return kept;
}

/// The part of a solid box inside the pyramid |x|, |y| <= tangent * z. From outside, a solid's picture is its surface's
/// picture.
inline Extent seen_in_pyramid(const Face& face, const Bounds& box, double tangent) {
  const glm::dvec3 planes[] = {{1, 0, tangent}, {-1, 0, tangent}, {0, 1, tangent}, {0, -1, tangent}};
  std::array<glm::dvec3, 8> corners;
  for (int i = 0; i < 8; ++i)
    corners[i] =
        face.to_light_space({i & 1 ? box.max.x : box.min.x, i & 2 ? box.max.y : box.min.y, i & 4 ? box.max.z : box.min.z});
  Extent extent;
  bool all_inside = true;
  for (const glm::dvec3& plane : planes) {
    const auto inside = std::ranges::count_if(corners, [&](const glm::dvec3& c) { return glm::dot(plane, c) > 0; });
    if (inside == 0) return extent;
    all_inside = all_inside && inside == 8;
  }
  const auto add = [&](const glm::dvec3& q) { extent.add(glm::dvec2(q) / q.z, q.z); };
  if (all_inside) {
    std::ranges::for_each(corners, add);
    return extent;
  }
  for (int axis = 0; axis < 3; ++axis)
    for (int side = 0; side < 2; ++side) {
      const int base = side << axis, u = 1 << (axis + 1) % 3, v = 1 << (axis + 2) % 3;
      Polygon quad;
      for (const int corner : {base, base | u, base | u | v, base | v}) quad.add(corners[corner]);
      for (const glm::dvec3& plane : planes) quad = clip(quad, plane);
      for (int i = 0; i < quad.count; ++i)
        if (quad.corners[i].z > 0) add(quad.corners[i]);
    }
  if (glm::all(glm::lessThanEqual(glm::dvec3(box.min), face.origin)) &&
      glm::all(glm::lessThanEqual(face.origin, glm::dvec3(box.max)))) {
    extent.add(glm::dvec2(-tangent), 0);
    extent.add(glm::dvec2(tangent), 0);
  }
  return extent;
}

inline Extent seen_orthographic(const Face& face, const Bounds& box) {
  Extent extent;
  for (int i = 0; i < 8; ++i) {
    const glm::dvec3 q =
        face.to_light_space({i & 1 ? box.max.x : box.min.x, i & 2 ? box.max.y : box.min.y, i & 4 ? box.max.z : box.min.z});
    extent.add(glm::dvec2(q), q.z);
  }
  return extent;
}

/// Fits the face to what its casters and receivers share. `tangent` is half the pyramid's opening (unused when orthographic).
/// `margin` texels are kept free on each side, so that no tap of a point inside the pyramid falls off the image: neighboring
/// cube faces overlap by that much, and no tap ever has to cross a seam.
inline void fit(Face& face, const std::vector<MeshBox>& boxes, double tangent, int resolution, int margin) {
  const double inner = resolution - 2.0 * margin;
  const double wide = tangent * resolution / inner;  // the pyramid with its margin
  Extent casters, receivers;
  for (std::uint32_t i = 0; i < boxes.size(); ++i) {
    const MeshBox& mesh = boxes[i];
    const auto seen = [&](double t) {
      return face.perspective ? seen_in_pyramid(face, mesh.bounds, t) : seen_orthographic(face, mesh.bounds);
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
  face.near = face.perspective ? std::max(casters.near, face.far * 0x1p-10) : casters.near;
}

/// Rows right, down, axis.
inline glm::dmat3 frame_along(const glm::dvec3& axis) {
  const glm::dvec3 a = glm::abs(axis);
  const glm::dvec3 helper = a.x >= a.y && a.x >= a.z ? glm::dvec3(0, 1, 0)
                            : a.y >= a.z             ? glm::dvec3(0, 0, 1)
                                                     : glm::dvec3(1, 0, 0);
  const glm::dvec3 down = glm::normalize(glm::cross(axis, helper)), right = glm::cross(down, axis);
  return glm::transpose(glm::dmat3(right, down, axis));
}

/// Widest half-angle of a spot light that one image serves.
inline constexpr float widest_spot_degrees = 60;

/// One face, or six in the order +x -x +y -y +z -z; a cube's frames only exchange axes, so that half of them are mirrored.
inline std::vector<Face> fit_faces(const Light& light, const std::vector<MeshBox>& boxes, int resolution, int margin) {
  std::vector<Face> faces;
  const glm::dvec4 l = homogeneous(light);
  const auto* spot = std::get_if<SpotLight>(&light.kind);
  if (l.w == 0) {
    Bounds all;
    for (const MeshBox& mesh : boxes) all.add(mesh.bounds.min), all.add(mesh.bounds.max);
    const glm::dvec3 middle = (glm::dvec3(all.min) + glm::dvec3(all.max)) / 2.0;
    faces.push_back({.origin = middle, .frame = frame_along(-glm::normalize(glm::dvec3(l))), .perspective = false});
    fit(faces[0], boxes, 0, resolution, margin);
  } else if (spot && spot->outer_degrees <= widest_spot_degrees) {
    faces.push_back({.origin = glm::dvec3(l), .frame = frame_along(glm::normalize(glm::dvec3(spot->direction)))});
    fit(faces[0], boxes, std::tan(glm::radians(double(spot->outer_degrees))), resolution, margin);
  } else {
    for (int i = 0; i < 6; ++i) {
      glm::dmat3 rows(0);
      const int axis = i / 2;
      rows[0][(axis + 1) % 3] = rows[1][(axis + 2) % 3] = 1;
      rows[2][axis] = i % 2 ? -1 : 1;
      faces.push_back({.origin = glm::dvec3(l), .frame = glm::transpose(rows)});
      fit(faces.back(), boxes, 1, resolution, margin);
    }
  }
  return faces;
}

}  // namespace shadow_map
