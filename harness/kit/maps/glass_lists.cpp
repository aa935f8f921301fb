#include <gnomon/kit/maps/glass_lists.h>

#include <algorithm>
#include <tuple>

namespace gnomon {

namespace {

/// A ray against boxes, in double with room for its rounding.
struct RaySlabs {
  glm::dvec3 origin, inverse;

  bool meets(const float (&low)[3], const float (&high)[3]) const {
    double near = 0, far = INFINITY;
    for (int k = 0; k < 3; ++k) {
      const double slack = 0x1p-40 * (std::abs(origin[k]) + std::abs(low[k]) + std::abs(high[k]));
      const double a = (low[k] - slack - origin[k]) * inverse[k], b = (high[k] + slack - origin[k]) * inverse[k];
      near = std::max(near, std::min(a, b));  // not a number, along an axis without extent: near and far stay as they are
      far = std::min(far, std::max(a, b));
    }
    return near <= far * (1 + 0x1p-40);
  }
};

/// Where a ray meets a triangle. Of two triangles with an edge, one computes the other's volume there with the sign changed: a
/// ray misses none of both.
struct RayHit {
  bool is_hit = false, is_on_edge = false;
  double distance = 0;
};
RayHit ray_hit(const Triangle& triangle, const glm::dvec3& origin, const glm::dvec3& direction) {
  glm::dvec3 corners[3];
  for (int k = 0; k < 3; ++k) corners[k] = glm::dvec3(triangle.points[k]) - origin;
  glm::dvec3 w;
  for (int k = 0; k < 3; ++k) w[k] = glm::dot(direction, glm::cross(corners[(k + 1) % 3], corners[(k + 2) % 3]));
  const double sum = w.x + w.y + w.z;
  const bool is_inside =
      sum > 0 ? glm::all(glm::greaterThanEqual(w, glm::dvec3(0))) : sum < 0 && glm::all(glm::lessThanEqual(w, glm::dvec3(0)));
  if (!is_inside) return {};
  const glm::dvec3 at = (w.x * corners[0] + w.y * corners[1] + w.z * corners[2]) / sum;
  const double distance = glm::dot(at, direction) / glm::dot(direction, direction);
  return {distance > 0, w.x == 0 || w.y == 0 || w.z == 0, distance};
}

}  // namespace

double share_before(std::span<const GlassCrossing> list, double distance) {
  double share = 1;
  for (const GlassCrossing& one : list)
    if (one.distance < distance) share *= one.transmission;
  return share;
}

GlassLists::GlassLists(const Scene& scene) : scene_(&scene) {
  std::vector<Caster> casters;
  std::vector<Bounds> boxes;
  for (std::uint32_t m = 0; m < scene.meshes.size(); ++m) {
    const Mesh& mesh = scene.meshes[m];
    if (!mesh.casts || !mesh.transmission) continue;
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
      casters.push_back({mesh.corners(t), m, t});
      boxes.emplace_back().add(casters.back().corners.points);
    }
  }
  tree_ = BoxTree(boxes);
  for (const std::uint32_t item : tree_.order()) casters_.push_back(casters[item]);
}

std::vector<GlassCrossing> GlassLists::along(const glm::dvec3& origin, const glm::dvec3& direction) const {
  struct Found {
    RayHit hit;
    std::uint32_t mesh, triangle;
  };
  std::vector<Found> found;
  const RaySlabs slabs{origin, 1.0 / direction};
  const auto meets = [&](const float(&low)[3], const float(&high)[3]) { return slabs.meets(low, high); };
  tree_.each(meets, [&](std::uint32_t place) {
    const Caster& caster = casters_[place];
    if (const RayHit here = ray_hit(caster.corners, origin, direction); here.is_hit)
      found.push_back({here, caster.mesh, caster.triangle});
    return false;
  });
  std::ranges::sort(found, {}, [](const Found& f) { return std::tuple(f.hit.distance, f.mesh, f.triangle); });
  std::vector<GlassCrossing> list;
  const Found* last = nullptr;
  for (const Found& f : found) {
    // Through an edge that two triangles of a surface share: one of them counts, as where they are drawn.
    const bool is_again = last && last->mesh == f.mesh && last->hit.is_on_edge && f.hit.is_on_edge &&
                          f.hit.distance <= last->hit.distance * (1 + 0x1p-40);
    last = &f;
    const Mesh& mesh = scene_->meshes[f.mesh];
    if (is_again || !is_solid_along(mesh, f.triangle, origin, direction)) continue;
    const double transmission = transmission_along(mesh, f.triangle, origin, direction).x;
    if (transmission < 1) list.push_back({f.hit.distance, transmission});
  }
  return list;
}

}  // namespace gnomon
