#pragma once
#include <gnomon/kit/geometry/receiver.h>
#include <gnomon/kit/shared.h>

#include "scene_light_space.h"

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

  void build(const Scene& scene);
  /// The same triangles, to be lit by another light.
  Triangles for_guest() const {
    Triangles guest;
    guest.built_ = built_.for_guest();
    return guest;
  }
  void relight(const glm::dvec4& light);

  std::size_t size() const { return built_->corners.size(); }
  const Triangle& operator[](std::uint32_t i) const { return built_->corners[i]; }
  const SceneLightSpace& space() const { return space_; }
  const TriangleNumbers& numbers() const { return built_->numbers; }
  bool is(std::uint32_t i, std::uint8_t flag) const { return (flags_[i] & flag) != 0; }
  /// Edge-on triangles neither cast nor receive.
  bool takes_part(std::uint32_t i) const { return facing_[i] != 0 && (flags_[i] & (casts | receives)) != 0; }

  /// Shadow plane through the light and edge k: positive on the inner side. Both triangles of an edge get the same one, bit for
  /// bit but for its sign.
  RawPlane side(std::uint32_t i, int k) const {
    glm::dvec3 a(built_->corners[i].points[k]), b(built_->corners[i].points[k == 2 ? 0 : k + 1]);
    double sign = -static_cast<double>(facing_[i]);
    if (b.x < a.x || (b.x == a.x && (b.y < a.y || (b.y == a.y && b.z < a.z)))) {
      std::swap(a, b);
      sign = -sign;
    }
    const glm::dvec3 l(space_.light());
    return {sign * (space_.is_parallel() ? glm::cross(b - a, l) : glm::cross(a - l, b - l)), a};
  }
  /// The triangle's own plane: positive beyond it, as the light sees it.
  RawPlane cap(std::uint32_t i) const {
    const glm::dvec3 a(built_->corners[i].points[0]), b(built_->corners[i].points[1]), c(built_->corners[i].points[2]);
    return {-static_cast<double>(facing_[i]) * glm::cross(b - a, c - a), a};
  }

  /// Whether a triangle shades a point: exactly, as the oracle says.
  bool shades(std::uint32_t caster, const NumberedReceiver& receiver) const {
    return !receiver.is_own(caster) && crosses({receiver.point, space_.light()}, built_->corners[caster]) != Crossing::none &&
           !receiver.is_coplanar(*built_->scene, built_->corners[caster].points);
  }
  bool are_coplanar(std::uint32_t one, std::uint32_t other) const {
    return coplanar(built_->corners[one], built_->corners[other].points);
  }

  std::size_t bytes() const {
    return bytes_of(flags_, facing_) + static_cast<std::size_t>(built_.own(static_cast<double>(
                                           bytes_of(built_->corners, built_->flags) + built_->numbers.bytes())));
  }

 private:
  bool is_doubtful(std::uint32_t i) const;

  struct Built {
    const Scene* scene = nullptr;
    TriangleNumbers numbers;
    Bounds bounds;
    std::vector<Triangle> corners;
    std::vector<std::uint8_t> flags;
  };
  Shared<Built> built_;
  SceneLightSpace space_;
  std::vector<std::uint8_t> flags_;  // those built, and `doubtful`
  std::vector<std::int8_t> facing_;
};

}  // namespace gnomon::two_pass_object
