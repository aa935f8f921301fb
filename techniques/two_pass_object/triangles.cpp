#include "triangles.h"

#include <gnomon/kit/bases/point_technique.h>

namespace gnomon::two_pass_object {

void Triangles::build(const Scene& scene) {
  built_->corners.clear();
  built_->flags.clear();
  flags_.clear();
  facing_.clear();
  built_->scene = &scene;
  built_->numbers = TriangleNumbers(scene);
  built_->bounds = scene.bounds();
  built_->corners.reserve(scene.triangle_count());
  built_->flags.reserve(scene.triangle_count());
  for_triangles(scene, [&](const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, std::uint32_t m, std::uint32_t) {
    const Mesh& mesh = scene.meshes[m];
    built_->corners.push_back({{a, b, c}});
    built_->flags.push_back(static_cast<std::uint8_t>((mesh.casts ? casts : 0) | (mesh.receives ? receives : 0)));
  });
}

void Triangles::relight(const glm::dvec4& light) {
  space_ = SceneLightSpace(light, built_->bounds);
  find_facing(built_->corners, light, facing_);
  flags_ = built_->flags;
  for_blocks(built_->corners.size(), 8192, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (facing_[i] != 0 && is_doubtful(static_cast<std::uint32_t>(i))) flags_[i] |= doubtful;
    }
  });
}

/// Whether it comes as near to the light as the doubt, or one of its planes may be off by a quarter of that somewhere in the
/// scene. Let e = 2^-52. A cross product of two vectors errs by less than 4 e of the product of their lengths, so a normal of
/// length n turns by 4 e / n of it, and a value at a distance up to the diagonal D from the plane's point is off by that
/// angle times D.
bool Triangles::is_doubtful(std::uint32_t i) const {
  const glm::vec3* p = built_->corners[i].points;
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
    const double lengths = space_.is_parallel() ? glm::length(b - a) * glm::length(l) : glm::length(a - l) * glm::length(b - l);
    if (!(e * lengths < limit * glm::length(side(i, k).normal))) return true;
  }
  const double lengths = glm::distance(glm::dvec3(p[0]), glm::dvec3(p[1])) * glm::distance(glm::dvec3(p[0]), glm::dvec3(p[2]));
  return !(e * lengths < limit * glm::length(cap(i).normal));
}

}  // namespace gnomon::two_pass_object
