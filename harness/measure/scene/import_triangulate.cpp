// Splits polygons into triangles. Corners are float32: differences and products are taken in double.
#include <cmath>

#include "measure/scene/import.h"

namespace gnomon::importing {
namespace {

/// Twice the signed area of a, b, c: positive when counter-clockwise.
double turn(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
  const glm::dvec2 u = b - a, v = c - a;
  return u.x * v.y - u.y * v.x;
}

/// The polygon seen along its Newell normal (sum of cross products of neighbors; it exists for bent polygons too), on the
/// coordinate plane where it is largest, counter-clockwise.
std::vector<glm::dvec2> flatten(std::span<const glm::vec3> positions, std::span<const std::uint32_t> corners) {
  const glm::dvec3 origin(positions[corners[0]]);
  glm::dvec3 normal(0);
  for (std::size_t i = 1; i + 1 < corners.size(); ++i)
    normal += glm::cross(glm::dvec3(positions[corners[i]]) - origin, glm::dvec3(positions[corners[i + 1]]) - origin);
  const glm::dvec3 size = glm::abs(normal);
  const int drop = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const int u = (drop + 1) % 3, v = (drop + 2) % 3;
  std::vector<glm::dvec2> flat;
  flat.reserve(corners.size());
  for (const std::uint32_t corner : corners) {
    const glm::vec3& p = positions[corner];
    flat.push_back(normal[drop] >= 0 ? glm::dvec2(p[u], p[v]) : glm::dvec2(p[v], p[u]));
  }
  return flat;
}

/// No turn to the right, and once around only: a star polygon turns left at each corner as well.
bool is_convex(const std::vector<glm::dvec2>& p) {
  const std::size_t n = p.size();
  double angle = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const glm::dvec2 &a = p[i], &b = p[(i + 1) % n], &c = p[(i + 2) % n];
    const double t = turn(a, b, c);
    if (t < 0) return false;
    angle += std::atan2(t, glm::dot(b - a, c - b));
  }
  return angle < 9;  // 2 pi once around, 4 pi twice
}

bool is_ear(const std::vector<glm::dvec2>& p, std::span<const std::uint32_t> next, std::uint32_t a, std::uint32_t b,
            std::uint32_t c) {
  if (turn(p[a], p[b], p[c]) <= 0) return false;
  for (std::uint32_t q = next[c]; q != a; q = next[q]) {
    if (p[q] == p[a] || p[q] == p[b] || p[q] == p[c]) continue;  // a bridge to a hole runs through its ends twice
    if (turn(p[a], p[b], p[q]) >= 0 && turn(p[b], p[c], p[q]) >= 0 && turn(p[c], p[a], p[q]) >= 0) return false;
  }
  return true;
}

}  // namespace

bool triangulate(std::span<const glm::vec3> positions, std::span<const std::uint32_t> corners,
                 std::vector<glm::uvec3>& triangles) {
  std::vector<std::uint32_t> loop;
  for (const std::uint32_t corner : corners)
    if (loop.empty() || loop.back() != corner) loop.push_back(corner);
  while (loop.size() > 1 && loop.back() == loop.front()) loop.pop_back();
  const auto n = static_cast<std::uint32_t>(loop.size());
  if (n < 3) return true;
  const auto fan = [&](std::span<const std::uint32_t> rest) {
    for (std::size_t i = 1; i + 1 < rest.size(); ++i) triangles.emplace_back(rest[0], rest[i], rest[i + 1]);
  };
  const std::vector<glm::dvec2> flat = n > 3 ? flatten(positions, loop) : std::vector<glm::dvec2>();
  if (n == 3 || is_convex(flat)) {
    fan(loop);
    return true;
  }

  // Cut ears off a ring of links. `idle` counts corners passed without a cut: a full round of them is the end. A cut changes
  // the two corners beside it alone: in a simple polygon what lies in another triangle lies there with a corner that turns in,
  // and none of these is cut.
  std::vector<std::uint32_t> next(n), previous(n);
  for (std::uint32_t i = 0; i < n; ++i) {
    next[i] = (i + 1) % n;
    previous[i] = (i + n - 1) % n;
  }
  const auto may_be_cut = [&](std::uint32_t b) {
    const std::uint32_t a = previous[b], c = next[b];
    const bool is_spike = turn(flat[a], flat[b], flat[c]) == 0 && glm::dot(flat[b] - flat[a], flat[c] - flat[b]) < 0;
    return is_spike || is_ear(flat, next, a, b, c);
  };
  std::vector<bool> is_free(n);
  for (std::uint32_t i = 0; i < n; ++i) is_free[i] = may_be_cut(i);
  std::uint32_t left = n, idle = 0, b = 0;
  int looks_left = 16;  // at all corners anew
  while (left > 3 && idle < left) {
    const std::uint32_t a = previous[b], c = next[b];
    if (is_free[b]) {
      triangles.emplace_back(loop[a], loop[b], loop[c]);  // a spike folded flat goes as a triangle of no area
      next[a] = c;
      previous[c] = a;
      is_free[a] = may_be_cut(a);
      is_free[c] = may_be_cut(c);
      --left;
      idle = 0;
    } else if (++idle == left && looks_left-- > 0) {  // of one that is not simple another corner may have become free
      for (std::uint32_t i = b, k = 0; k < left; i = next[i], ++k)
        if (!is_free[i] && may_be_cut(i)) {
          is_free[i] = true;
          idle = 0;
        }
    }
    b = c;
  }
  std::vector<std::uint32_t> rest;
  for (std::uint32_t i = 0; i < left; ++i, b = next[b]) rest.push_back(loop[b]);
  fan(rest);
  return left == 3;
}

}  // namespace gnomon::importing
