#pragma once
#include <gnomon/kit/exact.h>
#include <gnomon/kit/parallel.h>

#include "light_space.h"

namespace gnomon::two_pass_object {

/// A plane by a normal of any length and a point on it.
struct RawPlane {
  glm::dvec3 normal, on_plane;
  double at(const glm::dvec3& x) const { return glm::dot(normal, x - on_plane); }
  /// Whether the point is on the positive side by more than a distance.
  bool is_inside(const glm::dvec3& x, double distance) const {
    const double value = at(x);
    return value > 0 && value * value > distance * distance * glm::dot(normal, normal);
  }
  /// Whether it is on the negative side by more than a distance.
  bool is_outside(const glm::dvec3& x, double distance) const {
    const double value = at(x);
    return value < 0 && value * value > distance * distance * glm::dot(normal, normal);
  }
  ClipPlane unit() const {
    const double length = glm::length(normal);
    return {normal / length, -glm::dot(normal, on_plane) / length};
  }
};

/// The triangles of a scene, mesh after mesh, and how they stand to the light.
class Triangles {
 public:
  static constexpr std::uint8_t casts = 1, receives = 2, doubtful = 4;

  void build(const Scene& scene) {
    corners_.clear(), flags_.clear(), facing_.clear(), first_.clear();
    bounds_ = scene.bounds();
    corners_.reserve(scene.triangle_count()), flags_.reserve(scene.triangle_count());
    for (const Mesh& mesh : scene.meshes) {
      first_.push_back(static_cast<std::uint32_t>(corners_.size()));
      for (const glm::uvec3& t : mesh.triangles) {
        corners_.push_back({{mesh.positions[t.x], mesh.positions[t.y], mesh.positions[t.z]}});
        flags_.push_back(static_cast<std::uint8_t>((mesh.casts ? casts : 0) | (mesh.receives ? receives : 0)));
      }
    }
    first_.push_back(static_cast<std::uint32_t>(corners_.size()));
  }

  void relight(const glm::dvec4& light) {
    space_ = LightSpace(light, bounds_);
    facing_.resize(corners_.size());
    for_blocks(corners_.size(), 8192, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const glm::vec3* p = corners_[i].points;
        facing_[i] = static_cast<std::int8_t>(orient3d_sign(p[0], p[1], p[2], light));
        flags_[i] &= static_cast<std::uint8_t>(~doubtful);
        if (facing_[i] != 0 && is_doubtful(static_cast<std::uint32_t>(i))) flags_[i] |= doubtful;
      }
    });
  }

  std::size_t size() const { return corners_.size(); }
  const Triangle& operator[](std::uint32_t i) const { return corners_[i]; }
  const LightSpace& space() const { return space_; }
  std::uint32_t first_of(std::size_t mesh) const { return first_[mesh]; }
  std::uint32_t end_of(std::size_t mesh) const { return first_[mesh + 1]; }
  bool is(std::uint32_t i, std::uint8_t flag) const { return (flags_[i] & flag) != 0; }
  /// Edge-on triangles neither cast nor receive.
  bool takes_part(std::uint32_t i) const { return facing_[i] != 0 && (flags_[i] & (casts | receives)) != 0; }

  /// Shadow plane through the light and edge k: positive on the inner side. Both triangles of an edge get the same one, bit for
  /// bit but for its sign.
  RawPlane side(std::uint32_t i, int k) const {
    glm::dvec3 a(corners_[i].points[k]), b(corners_[i].points[k == 2 ? 0 : k + 1]);
    double sign = -static_cast<double>(facing_[i]);
    if (b.x < a.x || (b.x == a.x && (b.y < a.y || (b.y == a.y && b.z < a.z)))) std::swap(a, b), sign = -sign;
    const glm::dvec3 l(space_.light());
    return {sign * (space_.is_parallel() ? glm::cross(b - a, l) : glm::cross(a - l, b - l)), a};
  }
  /// The triangle's own plane: positive beyond it, as the light sees it.
  RawPlane cap(std::uint32_t i) const {
    const glm::dvec3 a(corners_[i].points[0]), b(corners_[i].points[1]), c(corners_[i].points[2]);
    return {-static_cast<double>(facing_[i]) * glm::cross(b - a, c - a), a};
  }

  /// Whether a triangle shades a point of another: exactly, as the oracle says. One that is coplanar with the receiver does
  /// not.
  bool shades(std::uint32_t caster, std::uint32_t receiver, const glm::vec3& point) const {
    return caster != receiver && crosses({point, space_.light()}, corners_[caster]) != Crossing::none &&
           !are_coplanar(receiver, caster);
  }
  bool are_coplanar(std::uint32_t receiver, std::uint32_t caster) const {
    const glm::vec3 *p = corners_[receiver].points, *q = corners_[caster].points;
    return coplanar(p[0], p[1], p[2], q[0]) && coplanar(p[0], p[1], p[2], q[1]) && coplanar(p[0], p[1], p[2], q[2]);
  }

  std::size_t bytes() const {
    return corners_.capacity() * sizeof(Triangle) + flags_.capacity() + facing_.capacity() +
           first_.capacity() * sizeof(std::uint32_t);
  }

 private:
  /// Whether it comes as near to the light as the doubt, or one of its planes may be off by a quarter of that somewhere in the
  /// scene. Let e = 2^-52. A cross product of two vectors errs by less than 4 e of the product of their lengths, so a normal of
  /// length n turns by 4 e / n of it, and a value at a distance up to the diagonal D from the plane's point is off by that
  /// angle times D.
  bool is_doubtful(std::uint32_t i) const {
    const glm::vec3* p = corners_[i].points;
    const glm::dvec3 l(space_.light());
    const double limit = 0.25 * space_.doubt(), e = 0x1p-50 * space_.diagonal();
    if (!space_.is_parallel()) {
      const glm::dvec3 a(p[0]), b(p[1]), c(p[2]), reach(space_.doubt());
      const RawPlane own = cap(i);
      if (!own.is_outside(l, space_.doubt()) && glm::all(glm::lessThanEqual(glm::min(a, glm::min(b, c)) - reach, l)) &&
          glm::all(glm::greaterThanEqual(glm::max(a, glm::max(b, c)) + reach, l)))
        return true;
    }
    for (int k = 0; k < 3; ++k) {
      const glm::dvec3 a(p[k]), b(p[(k + 1) % 3]);
      const double lengths =
          space_.is_parallel() ? glm::length(b - a) * glm::length(l) : glm::length(a - l) * glm::length(b - l);
      if (!(e * lengths < limit * glm::length(side(i, k).normal))) return true;
    }
    const double lengths =
        glm::distance(glm::dvec3(p[0]), glm::dvec3(p[1])) * glm::distance(glm::dvec3(p[0]), glm::dvec3(p[2]));
    return !(e * lengths < limit * glm::length(cap(i).normal));
  }

  LightSpace space_;
  Bounds bounds_;
  std::vector<Triangle> corners_;
  std::vector<std::uint8_t> flags_;
  std::vector<std::int8_t> facing_;
  std::vector<std::uint32_t> first_;
};

}  // namespace gnomon::two_pass_object
