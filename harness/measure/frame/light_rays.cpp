#include "measure/frame/light_rays.h"

#include <gnomon/kit/geometry/across.h>
#include <gnomon/kit/geometry/holes.h>

#include <algorithm>

#include "measure/frame/classify.h"
#include "measure/frame/ray_packets.h"

namespace gnomon {

std::array<glm::dvec3, 2> across(const glm::dvec3& axis) {
  const auto [u, v] = Across::by_x(axis, 0.7);
  return {-u, -v};
}

glm::dvec3 back_to_plane(const glm::dvec3& move, const glm::dvec3& ray, const glm::dvec3& n) {
  const double down = -glm::dot(n, ray);
  return std::abs(down) > 1e-3 ? glm::dot(n, move) / down * ray : glm::dvec3(0);
}

LightRays::LightRays(const Scene& scene, const RayScene& casters, const GBuffer& gbuffer, const Light& light)
    : scene_(scene), casters_(casters), gbuffer_(gbuffer), light_(homogeneous_of_center(light)) {
  const Bounds box = scene.bounds();
  center_ = (glm::dvec3(box.min) + glm::dvec3(box.max)) / 2.0;
  // Twice the half diagonal: an exact shape may bulge out of the box of its tessellation.
  radius_ = glm::distance(glm::dvec3(box.min), glm::dvec3(box.max));
  extent_ = extent(scene, light, gbuffer.view);
  rounding_ = 16 * 0x1p-24 * extent_;
}

double LightRays::beyond_everything(const glm::dvec3& point) const { return glm::distance(point, center_) + radius_; }

/// What the ray recipe does not count as a caster: the pixel's own triangle; its own curved shape, unless the ray leaves it
/// from inside.
bool LightRays::is_own(std::size_t i, const RayScene::Hit& hit, const glm::dvec3& direction) const {
  if (hit.mesh != gbuffer_.mesh[i]) return false;
  const Mesh& mesh = scene_.meshes[hit.mesh];
  if (gbuffer_.truth == Truth::shape && mesh.has_curved_shape())
    return std::holds_alternative<Disc>(*mesh.shape) || glm::dot(hit.normal, direction) <= 0;
  return hit.triangle == gbuffer_.triangle[i];
}

LightRays::CasterHit LightRays::nearest(std::size_t i) const {
  const glm::dvec3 lifted =
      glm::dvec3(gbuffer_.position(i)) + ray_offset(gbuffer_.position(i)) * glm::dvec3(gbuffer_.normal(i));
  const glm::dvec3 to = to_light(light_, lifted);
  const double length = glm::length(to), end = light_.w != 0 ? length : INFINITY;
  const glm::dvec3 direction = to / length;
  // A closest-hit ray has no filter: it goes on behind what does not count. A line meets a triangle or shape at most twice.
  double start = 0;
  for (int step = 0; step < 4; ++step) {
    const RayScene::Hit hit = casters_.closest_caster(lifted + start * direction, direction);
    const double distance = start + hit.t;
    if (hit.mesh == no_mesh || distance >= end) return {};
    if (!is_own(i, hit, direction)) return {hit.mesh, distance};
    start = distance + rounding_;
  }
  return {};
}

double LightRays::farthest(std::size_t i) const {
  const glm::dvec3 point = gbuffer_.position(i), direction = toward_light(point);
  const double distance = to_farthest(point, direction, &RayScene::closest_caster);
  // The point's own surface, met within float32 rounding; along the ray of a pixel of class T that is at most 1 / 0.035 as
  // much.
  return distance <= rounding_ / 0.035 ? nearest(i).distance : distance;
}

double LightRays::farthest_along(const glm::dvec3& point, const glm::dvec3& direction) const {
  return to_farthest(point, direction, &RayScene::closest);
}

double LightRays::to_farthest(const glm::dvec3& point, const glm::dvec3& direction, ClosestHit closest) const {
  const double length = light_.w != 0 ? glm::distance(glm::dvec3(light_), point) : beyond_everything(point);
  return length - (casters_.*closest)(point + length * direction, -direction).t;
}

LightRays::Surface LightRays::surface_at(const glm::dvec3& point, const glm::dvec3& direction) const {
  // Starting a little before the point, so that the surface that goes through it is met by the forward ray.
  const glm::dvec3 start = point - rounding_ * direction;
  const RayScene::Hit forward = casters_.closest(start, direction), backward = casters_.closest(start, -direction);
  const double ahead = std::abs(forward.t - rounding_), behind = backward.t + rounding_;
  const std::uint32_t mesh = ahead <= behind ? forward.mesh : backward.mesh;
  const bool is_shape = mesh != no_mesh && gbuffer_.truth == Truth::shape && scene_.meshes[mesh].has_curved_shape();
  return {mesh, std::min(ahead, behind), is_shape};
}

namespace {

/// Whether the line from `origin` along `direction` meets a triangle of the mesh at parameters in `from` .. `to` (Moeller and
/// Trumbore 1997, in double).
bool meets_triangles(const Mesh& mesh, const glm::dvec3& origin, const glm::dvec3& direction, double from, double to) {
  return std::ranges::any_of(mesh.triangles, [&](const glm::uvec3& corners) {
    const glm::dvec3 a = mesh.positions[corners.x], b = mesh.positions[corners.y], c = mesh.positions[corners.z];
    const glm::dvec3 e1 = b - a, e2 = c - a, p = glm::cross(direction, e2), s = origin - a, q = glm::cross(s, e1);
    const double determinant = glm::dot(e1, p);
    const double u = glm::dot(s, p) / determinant, v = glm::dot(direction, q) / determinant, t = glm::dot(e2, q) / determinant;
    return determinant != 0 && u >= 0 && v >= 0 && u + v <= 1 && t >= from && t <= to;
  });
}

}  // namespace

bool LightRays::triangles_let_through(const Start& start) const {
  if (gbuffer_.truth != Truth::shape) return false;
  const glm::dvec3 to = to_light(light_, start.point);
  const double length = glm::length(to), end = light_.w != 0 ? length : INFINITY;
  const glm::dvec3 direction = to / length;
  std::vector<std::uint32_t> missed;
  for (double from = start.ignored;;) {
    const RayScene::Hit hit = casters_.closest_caster(start.point + from * direction, direction);
    if (hit.mesh == no_mesh || from + hit.t >= end) return !missed.empty();
    const Mesh& mesh = scene_.meshes[hit.mesh];
    if (!mesh.has_curved_shape()) return false;
    if (std::ranges::find(missed, hit.mesh) == missed.end()) {
      if (meets_triangles(mesh, start.point, direction, start.ignored, end)) return false;
      missed.push_back(hit.mesh);
    }
    from += hit.t + rounding_;
  }
}

bool LightRays::is_at_hole_border(const Start& start, double aside) const {
  if (!casters_.has_alpha_masks()) return false;
  const glm::dvec3 direction = toward_light(start.point), from = start.point + start.ignored * direction;
  const glm::dvec3 way = light_.w != 0 ? to_light(light_, from) : beyond_everything(from) * direction;
  // texel_rounding allows a move of 2 * 16 * 2^-24 times the extent: for `aside` meters more the extent grows by 2^19 of them.
  const double reach = extent_ + aside * 0x1p19;
  bool is_doubtful = false;
  for (const RayScene::Met& met : casters_.met(from, way)) {
    const Mesh& mesh = scene_.meshes[met.mesh];
    if (met.mesh == gbuffer_.mesh[start.pixel] && met.triangle == gbuffer_.triangle[start.pixel]) continue;
    const Around found = mesh.alpha_mask ? around(*mesh.alpha_mask, texel_place(mesh, met.triangle, start.point, light_),
                                                  texel_rounding(mesh, met.triangle, direction, reach))
                                         : Around::solid;
    if (found == Around::solid) return false;
    is_doubtful |= found == Around::both;
  }
  return is_doubtful;
}

std::uint32_t LightRays::masked_mesh_at(const glm::dvec3& point, const glm::dvec3& direction, double reach) const {
  if (!casters_.has_alpha_masks()) return no_mesh;
  std::pair<double, std::uint32_t> nearest{INFINITY, no_mesh};
  for (const RayScene::Met& met : casters_.met(point - reach * direction, 2 * reach * direction)) {
    const Mesh& mesh = scene_.meshes[met.mesh];
    if (!mesh.alpha_mask) continue;
    const Triangle corners = mesh.corners(met.triangle);
    const glm::dvec3 normal = corners.normal();
    const double off = glm::dot(normal, glm::dvec3(corners.points[0]) - point) / glm::dot(normal, direction);
    nearest = std::min(nearest, {std::abs(off), met.mesh});
  }
  return nearest.second;
}

std::vector<float> LightRays::shares(std::span<const Start> starts) const {
  std::vector<float> answer(starts.size());
  std::array<Crossings, ray_lanes> crossings;
  for (std::size_t first = 0; first < starts.size(); first += 16) {
    const std::size_t count = std::min<std::size_t>(16, starts.size() - first);
    ShadowPacket packet;
    std::uint32_t mesh[16] = {}, triangle[16] = {};
    for (std::size_t k = 0; k < 16; ++k) {
      const Start& start = starts[first + std::min(k, count - 1)];
      const glm::dvec3 origin = start.point + ray_offset(start.point) * glm::dvec3(gbuffer_.normal(start.pixel));
      const glm::dvec3 to = to_light(light_, origin);
      mesh[k] = gbuffer_.mesh[start.pixel];
      triangle[k] = gbuffer_.triangle[start.pixel];
      set_ray(packet, static_cast<int>(k), origin, to, end_of(light_), static_cast<float>(start.ignored / glm::length(to)));
    }
    const auto valid = static_cast<std::uint32_t>((1u << count) - 1);
    const Receivers receivers{mesh, triangle};
    const std::uint32_t blocked = casters_.has_transmission() ? casters_.crossed(valid, packet, receivers, crossings)
                                                              : casters_.occluded(valid, packet, receivers);
    for (std::size_t k = 0; k < count; ++k) {
      const glm::dvec3 point = starts[first + k].point, way = to_light(light_, point);
      const auto along = [&](std::uint32_t m, std::uint32_t t) { return transmission_along(scene_.meshes[m], t, point, way); };
      answer[first + k] = blocked >> k & 1 ? 0.0f : static_cast<float>(crossings[k].product(along).share.x);
    }
  }
  return answer;
}

std::vector<std::uint32_t> find_nearest_casters(const Scene& scene, const RayScene& casters, const GBuffer& gbuffer,
                                                const Light& light, std::span<const float> reference) {
  const LightRays rays(scene, casters, gbuffer, light);
  const bool is_through_glass = scene.has_transmission();
  const auto lacks_light = [&](float share) {
    return is_through_glass ? is_wrong(1, share, AnswerKind::transmitted) : !is_lit(share);
  };
  std::vector<std::uint32_t> nearest_caster(gbuffer.size(), no_mesh);
  tbb::parallel_for(0, gbuffer.height, [&](int y) {
    for (std::size_t i = static_cast<std::size_t>(y) * gbuffer.width, end = i + gbuffer.width; i < end; ++i)
      if (lacks_light(reference[i]) && faces_light(scene, gbuffer, light, i)) nearest_caster[i] = rays.nearest(i).mesh;
  });
  return nearest_caster;
}

}  // namespace gnomon
