#include "measure/frame/glass_doubt.h"

#include <gnomon/kit/geometry/holes.h>

#include <cmath>

namespace gnomon {

namespace {

/// Where a way meets a triangle: for sure inside all its edges, for sure not, or within a distance of an edge or of an end.
enum class Meets { no, yes, perhaps };

/// `room` in meters; three times that at the way's start, where rays are lifted off their surface.
Meets meets(const Triangle& triangle, const glm::dvec3& point, const glm::dvec3& way, bool has_end, double room) {
  const glm::dvec3 normal = triangle.normal(), first = glm::dvec3(triangle.points[0]) - point;
  const double area = glm::length(normal), rise = glm::dot(normal, way), height = glm::dot(normal, first);
  // Heights of the ends over the triangle's plane, meters: both on one side, and neither near it.
  const double start = -height / area, end = has_end    ? (rise - height) / area
                                             : rise > 0 ? INFINITY
                                             : rise < 0 ? -INFINITY
                                                        : start;
  if ((start > 3 * room && end > room) || (start < -3 * room && end < -room)) return Meets::no;
  int left = 0, right = 0;
  for (int k = 0; k < 3; ++k) {
    const glm::dvec3 from = glm::dvec3(triangle.points[k]) - point, to = glm::dvec3(triangle.points[(k + 1) % 3]) - point;
    const double turn = glm::dot(glm::cross(from, to), way), sure = room * glm::length(glm::cross(to - from, way));
    left += turn > sure;
    right += turn < -sure;
  }
  if (left > 0 && right > 0) return Meets::no;
  if (left < 3 && right < 3) return Meets::perhaps;
  const bool is_between = (start > 3 * room && end < -room) || (start < -3 * room && end > room);
  return is_between ? Meets::yes : Meets::perhaps;
}

}  // namespace

GlassDoubt::GlassDoubt(const Scene& scene, const glm::dvec4& light, double extent)
    : scene_(scene), light_(light), extent_(extent) {
  std::vector<Caster> casters;
  std::vector<Bounds> bounds;
  for (std::uint32_t m = 0; m < scene.meshes.size(); ++m) {
    const Mesh& mesh = scene.meshes[m];
    if (!mesh.casts || !mesh.transmission) continue;
    if (mesh.transmission->is_constant() && mesh.transmission->at(0, 0) == glm::vec3(1)) continue;
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
      casters.push_back({m, t});
      bounds.emplace_back().add(mesh.corners(t).points);
    }
  }
  if (casters.empty()) return;
  tree_ = BoxTree(bounds);
  for (const std::uint32_t i : tree_.order()) casters_.push_back(casters[i]);
}

bool GlassDoubt::is_uncertain(const Receiver& receiver, float share) const {
  if (casters_.empty()) return false;
  const Segment segment{receiver.point, light_};
  const glm::dvec3 way = to_light(light_, glm::dvec3(receiver.point));
  bool is_doubtful = share == 0;
  const double reach = 3 * rho_;
  const bool is_dark = tree_.any(SegmentSlabs(segment), reach, [&](std::uint32_t place) {
    const Found found = at(receiver, casters_[place], way);
    is_doubtful |= found == Found::doubt;
    return found == Found::dark;
  });
  return is_doubtful && !is_dark;
}

GlassDoubt::Found GlassDoubt::at(const Receiver& receiver, const Caster& caster, const glm::dvec3& way) const {
  const Triangle triangle = scene_.meshes[caster.mesh].corners(caster.triangle);
  const Meets met = meets(triangle, receiver.point, way, light_.w != 0, rho_);
  if (met == Meets::no) return Found::nothing;
  if (receiver.is_own(caster.mesh, caster.triangle)) return Found::nothing;
  const Found found = through(receiver, caster, way);
  // What is coplanar with the receiver never shades it, but a ray that starts beside the plane may meet it.
  const bool is_sure = met == Meets::yes && !receiver.is_coplanar(scene_, triangle.points);
  return is_sure || found == Found::nothing ? found : Found::doubt;
}

GlassDoubt::Found GlassDoubt::through(const Receiver& receiver, const Caster& caster, const glm::dvec3& way) const {
  const Mesh& mesh = scene_.meshes[caster.mesh];
  const glm::dvec3 point = receiver.point;
  if (mesh.alpha_mask) {
    const Around around = gnomon::around(*mesh.alpha_mask, texel_place(mesh, caster.triangle, point, light_),
                                         texel_rounding(mesh, caster.triangle, way, extent_));
    if (around == Around::hole) return Found::nothing;
    if (around == Around::both) return Found::doubt;
  }
  const Transmission& glass = *mesh.transmission;
  const glm::ivec2 size = size_of(glass);
  const auto found = glass.is_constant()
                         ? std::optional(glass.at(0, 0))
                         : transmission_around(glass, texel_place(mesh, caster.triangle, point, light_, size),
                                               texel_rounding(mesh, caster.triangle, way, extent_, size), 1.0f / 256);
  if (!found) return Found::doubt;
  if (*found == glm::vec3(1)) return Found::nothing;
  return *found == glm::vec3(0) ? Found::dark : Found::light;
}

}  // namespace gnomon
