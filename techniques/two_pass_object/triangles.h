#pragma once
#include <gnomon/kit/bases/point_technique.h>
#include <gnomon/kit/geometry/cut_masks.h>

#include "scene_light_space.h"

namespace gnomon::two_pass_object {

/// A plane by a normal of any length and a point on it.
struct RawPlane {
  glm::dvec3 normal, on_plane;
  double at(const glm::dvec3& x) const { return glm::dot(normal, x - on_plane); }
  /// Whether the point is on the positive, or on the negative, side by more than a distance.
  bool is_inside(const glm::dvec3& x, double distance) const { return is_beyond(at(x), distance); }
  bool is_outside(const glm::dvec3& x, double distance) const { return is_beyond(-at(x), distance); }
  bool is_beyond(double value, double distance) const {
    return value > 0 && value * value > distance * distance * glm::dot(normal, normal);
  }
  ClipPlane unit() const {
    const double length = glm::length(normal);
    return {normal / length, -glm::dot(normal, on_plane) / length};
  }
};

/// The triangles of a scene, mesh after mesh, and how they are turned to the light. A piece of a mask has its own edges, and
/// the plane of the triangle that it was cut out of.
class Triangles {
 public:
  static constexpr std::uint8_t casts = 1, receives = 2, doubtful = 4;

  void build(CutMasks cut) {
    flags_.clear();
    facing_.clear();
    const Scene& scene = cut.scene();
    *built_ = {std::move(cut), TriangleNumbers(scene), scene.bounds(), {}, {}};
    built_->corners.reserve(scene.triangle_count());
    built_->flags.reserve(scene.triangle_count());
    for_triangles(scene, [&](const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, std::uint32_t m, std::uint32_t) {
      const Mesh& mesh = scene.meshes[m];
      built_->corners.push_back({{a, b, c}});
      built_->flags.push_back(static_cast<std::uint8_t>((mesh.casts ? casts : 0) | (mesh.receives ? receives : 0)));
    });
  }

  /// Keeps the pieces that masks were cut into. Returns false where what is cut moved: then all is to be built.
  bool follow(const Changes& changes) {
    if (!built_->cut.follow(changes)) return false;
    if (!changes.empty()) build(std::move(built_->cut));
    return true;
  }

  /// The same triangles, to be lit by another light.
  Triangles for_guest() const {
    Triangles guest;
    guest.built_ = built_.for_guest();
    return guest;
  }
  void relight(const glm::dvec4& light) {
    space_ = SceneLightSpace(light, built_->bounds);
    find_facing(built_->corners, light, facing_);
    flags_ = built_->flags;
    for_blocks(built_->corners.size(), 8192, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) {
        const auto i = static_cast<std::uint32_t>(k);
        if (facing_[source(i)] == 0) flags_[i] &= static_cast<std::uint8_t>(~casts);
        if (facing_[i] != 0 && is_doubtful(i)) flags_[i] |= doubtful;
      }
    });
  }

  std::size_t size() const { return built_->corners.size(); }
  const Triangle& operator[](std::uint32_t i) const { return built_->corners[i]; }
  const SceneLightSpace& space() const { return space_; }
  const Scene& scene() const { return built_->cut.scene(); }
  const TriangleNumbers& numbers() const { return built_->numbers; }
  /// As CutMasks::source.
  std::uint32_t source(std::uint32_t i) const { return built_->cut.source(i); }
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
    const Triangle& own = (*this)[source(i)];
    return {-static_cast<double>(facing_[source(i)]) * own.normal(), glm::dvec3(own.points[0])};
  }

  /// Whether a triangle shades a point: exactly, as the oracle computes it.
  bool shades(std::uint32_t caster, const NumberedReceiver& receiver) const {
    const std::uint32_t whole = source(caster);
    return !receiver.is_own(whole) && crosses({receiver.point, space_.light()}, built_->corners[caster]) != Crossing::none &&
           !receiver.is_coplanar(scene(), built_->corners[whole].points);
  }
  bool are_coplanar(std::uint32_t one, std::uint32_t other) const {
    return coplanar(built_->corners[source(one)], built_->corners[source(other)].points);
  }

  std::size_t bytes() const {
    return bytes_of(flags_, facing_) +
           static_cast<std::size_t>(built_.own(
               static_cast<double>(bytes_of(built_->corners, built_->flags) + built_->numbers.bytes() + built_->cut.bytes())));
  }

 private:
  /// Whether it comes as near to the light as the doubt, or one of its planes may be off by a quarter of that somewhere in the
  /// scene. Let e = 2^-52. A cross product of two vectors errs by less than 4 e of the product of their lengths, so a normal of
  /// length n turns by 4 e / n of it, and a value at a distance up to the diagonal D from the plane's point is off by that
  /// angle times D.
  bool is_doubtful(std::uint32_t i) const {
    const glm::vec3* const p = (*this)[i].points;
    const glm::dvec3 a(p[0]), b(p[1]), c(p[2]), l(space_.light()), reach(space_.doubt());
    const double limit = 0.25 * space_.doubt(), e = 0x1p-50 * space_.diagonal();
    const auto is_off = [&](const RawPlane& plane, double size) { return !(e * size < limit * glm::length(plane.normal)); };
    const glm::vec3* const whole = (*this)[source(i)].points;
    const glm::dvec3 corner(whole[0]);
    if (!space_.is_parallel() && !cap(i).is_outside(l, space_.doubt()) &&
        glm::all(glm::lessThanEqual(glm::min(a, glm::min(b, c)) - reach, l)) &&
        glm::all(glm::greaterThanEqual(glm::max(a, glm::max(b, c)) + reach, l)))
      return true;
    for (int k = 0; k < 3; ++k) {
      const glm::dvec3 from(p[k]), to(p[(k + 1) % 3]);
      const double of_from = space_.is_parallel() ? glm::distance(from, to) : glm::distance(l, from);
      if (is_off(side(i, k), of_from * (space_.is_parallel() ? glm::length(l) : glm::distance(l, to)))) return true;
    }
    return is_off(cap(i), glm::distance(corner, glm::dvec3(whole[1])) * glm::distance(corner, glm::dvec3(whole[2])));
  }

  struct Built {
    CutMasks cut;
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
