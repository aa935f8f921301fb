#pragma once
#include "footprint.h"

namespace gnomon::alias_free_map {

/// Error of a plane's value, of the product of the lengths that made it. With e = 2^-53, points are off by 9 e of their
/// distance (kit/light_space.h), so the cross product of two by 18 e, and by 6 e for its own rounding; its product with a third
/// point adds 9 e for that one and 4 e for rounding: 37 e. A plane off the origin takes another 9 e + 4 e on the side of its
/// offset. 2^-46 is three times as much.
constexpr double plane_error = 0x1p-46;

/// A linear function of a sample in the frame of its face, raised by its error: where it is negative, its true value is. Where
/// it is above 2 `error`, the true value is positive.
struct Side {
  double x, y, z, offset, error;
  double at(double px, double py, double pz) const { return x * px + y * py + z * pz + offset; }
};

/// The shadow of a triangle that is not edge-on: all samples on the inner sides of three planes through the light and an edge,
/// and beyond the triangle's own plane (the last). `facing` is orient3d_sign of the corners and the light; `reach` is more than
/// the distance of any sample asked.
struct Shadow {
  Side sides[4];
};

inline Shadow make_shadow(const LightFace& face, const glm::dvec4& light, const glm::vec3* points, int facing, double reach) {
  Shadow shadow;
  const auto side = [](const glm::dvec3& n, double offset, double error) { return Side{n.x, n.y, n.z, offset + error, error}; };
  const auto turned = [&](const glm::dvec3& v) { return face.turned(v); };
  glm::dvec3 corner[3];
  double length[3];
  for (int k = 0; k < 3; ++k) {
    corner[k] = face.seen(points[k]);
    length[k] = norm1(corner[k]);
  }
  const glm::dvec3 a(points[0]), b(points[1]), c(points[2]);
  const glm::dvec3 edges[3] = {turned(b - a), turned(c - b), turned(a - c)};
  if (!face.is_perspective) {
    // P = a + i (b - a) + j (c - a) - t l is in shadow when i, j, 1 - i - j >= 0 and t > 0, and
    // ((b - a) x l) . (P - a) = -j ((b - a) x (c - a)) . l.
    const glm::dvec3 l = turned(glm::dvec3(light));
    for (int k = 0; k < 3; ++k) {
      const glm::dvec3 normal = -static_cast<double>(facing) * glm::cross(edges[k], l);
      shadow.sides[k] =
          side(normal, -glm::dot(normal, corner[k]), plane_error * norm1(edges[k]) * norm1(l) * (reach + length[k]));
    }
  } else {
    // P = i a + j b + k c, seen from the light, is in shadow when i, j, k >= 0 and i + j + k > 1, and [a b P] = k [a b c].
    // orient3d of a, b, c and the origin is -[a b c].
    for (int k = 0; k < 3; ++k) {
      const int next = (k + 1) % 3;
      const glm::dvec3 normal = -static_cast<double>(facing) * glm::cross(corner[k], corner[next]);
      shadow.sides[k] = side(normal, 0, plane_error * length[k] * length[next] * reach);
    }
  }
  // The shadow is on the other side of the triangle than the light.
  const glm::dvec3 normal = -static_cast<double>(facing) * glm::cross(edges[2], edges[0]);
  shadow.sides[3] =
      side(normal, -glm::dot(normal, corner[0]), plane_error * norm1(edges[0]) * norm1(edges[2]) * (reach + length[0]));
  return shadow;
}

}  // namespace gnomon::alias_free_map
