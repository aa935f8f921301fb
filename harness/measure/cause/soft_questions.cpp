// What geometry and rays say about one pixel under a light with area.
#include <gnomon/kit/area/area_rays.h>

#include <algorithm>
#include <bit>
#include <numbers>

#include "measure/cause/soft_causes.h"

namespace gnomon {

namespace {

constexpr std::uint32_t rounds = 16;  ///< of sixteen rays

double area_of(std::span<const glm::dvec2> polygon) {
  double twice = 0;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const glm::dvec2 &p = polygon[k], &q = polygon[(k + 1) % polygon.size()];
    twice += p.x * q.y - p.y * q.x;
  }
  return std::abs(twice) / 2;
}

LightFigure figure_at(const Attribution& a, const Light& light, std::size_t i) {
  return {light, a.gbuffer.position(i), a.gbuffer.normal(i)};
}

Light four_times(Light light) {
  if (auto* rect = std::get_if<RectLight>(&light.kind)) {
    rect->half_u *= 4.0f;
    rect->half_v *= 4.0f;
  }
  if (auto* disc = std::get_if<DiscLight>(&light.kind)) disc->radius *= 4;
  if (auto* sphere = std::get_if<SphereLight>(&light.kind)) sphere->radius *= 4;
  return light;
}

/// A mesh on the way to the light, and what part of the light it lets through: 0 where it is opaque.
struct Between {
  std::uint32_t mesh;
  double passed;
};

/// The meshes on the way from the point of pixel i that keep light off.
std::vector<Between> meshes_between(const Attribution& a, std::size_t i, const glm::dvec3& way) {
  constexpr int most_surfaces = 256;
  const glm::vec3 point = a.gbuffer.position(i);
  const glm::dvec3 origin = point + static_cast<float>(ray_offset(point)) * a.gbuffer.normal(i);
  const double step = 1e-6 + 4 * ray_offset(point) / glm::length(way);
  std::vector<Between> meshes;
  double t = 0;
  for (int k = 0; k < most_surfaces; ++k) {
    const RayScene::Hit hit = a.casters.closest_caster(origin + t * way, way);
    if (hit.mesh == no_mesh || t + hit.t >= 1 - step) break;
    const bool is_own = hit.mesh == a.gbuffer.mesh[i] && hit.triangle == a.gbuffer.triangle[i] && t == 0;
    t += hit.t + step;
    const double passed = transmission_along(a.scene.meshes[hit.mesh], hit.triangle, origin, way).x;
    if (is_own) continue;
    const auto known = std::ranges::find(meshes, hit.mesh, &Between::mesh);
    if (known == meshes.end())
      meshes.push_back({hit.mesh, passed});
    else
      known->passed *= passed;
  }
  return meshes;
}

}  // namespace

double share_above_horizon(const Attribution& a, std::size_t i) {
  const LightFigure figure = figure_at(a, a.light, i);
  std::vector<glm::dvec2> outline;
  if (!figure.is_disc()) outline = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
  constexpr int corners = 128;
  for (int k = 0; figure.is_disc() && k < corners; ++k) {
    const double angle = 2 * std::numbers::pi * k / corners;
    outline.emplace_back(std::cos(angle), std::sin(angle));
  }
  const double whole = area_of(outline);
  clip_places(outline, figure.horizon());
  return area_of(outline) / whole;
}

CasterShares caster_shares(const Attribution& a, std::size_t i) {
  const LightFigure figure = figure_at(a, a.light, i);
  const LightFigure::Box& box = figure.box();
  const Scramble scramble(~std::uint64_t{i});
  std::map<std::uint32_t, double> hidden;  // ways, one that lets a part of the light through counts as what it keeps off
  std::size_t traced = 0;
  double hidden_together = 0;
  for (std::uint32_t round = 0; round < rounds; ++round) {
    const Squares squares = scramble.of_first(round);
    for (std::size_t k = 0; k < squares.x.size(); ++k) {
      const glm::dvec2 place = box.low + glm::dvec2(squares.x[k], squares.y[k]) * (box.high - box.low);
      if (!figure.holds(place)) continue;
      ++traced;
      double passed = 1;
      for (const Between& between : meshes_between(a, i, figure.at(place))) {
        hidden[between.mesh] += 1 - between.passed;
        passed *= between.passed;
      }
      hidden_together += 1 - passed;
    }
  }
  CasterShares shares{.count = hidden.size()};
  const auto left_by = [&](double count) { return 1 - count / static_cast<double>(traced); };
  if (traced == 0) return shares;
  shares.together = left_by(hidden_together);
  for (const auto& [mesh, count] : hidden) {
    shares.product *= left_by(count);
    shares.least = std::min(shares.least, left_by(count));
  }
  return shares;
}

std::optional<double> seen_of_larger(const Attribution& a, std::size_t i) {
  const LightFigure figure = figure_at(a, four_times(a.light), i);
  if (!figure.is_seen()) return std::nullopt;
  const FaceRays rays(a.casters, a.gbuffer, i, figure);
  const Scramble scramble(i);
  int traced = 0;
  double hidden = 0;
  for (std::uint32_t round = 0; round < rounds; ++round) {
    const FaceHits hits = rays.ask(scramble.of_first(round));
    traced += std::popcount(hits.asked);
    hidden += hits.hidden_count();
  }
  return traced > 0 ? std::optional(1 - hidden / traced) : std::nullopt;
}

std::pair<double, double> traced_again(const Attribution& a, std::size_t i, double error) {
  const FaceRays rays(a.casters, a.gbuffer, i, figure_at(a, a.light, i));
  // References are made with the pixel's index for seed: this is another one for every pixel of every picture.
  const std::uint64_t seed = (std::uint64_t{1} << 40) + i;
  const SampledShares shares = sample_shares(rays, seed, {.error = std::max(error / 2, 1e-5), .cap = 1 << 15});
  if (a.estimates == LightShareKind::irradiance) return {shares.irradiance, shares.irradiance_error};
  return {shares.area, shares.area_error};
}

}  // namespace gnomon
