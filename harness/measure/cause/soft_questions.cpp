// What geometry and rays say about one pixel under a light with area.
#include <gnomon/kit/area/area_rays.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

#include "measure/cause/soft_causes.h"

namespace gnomon {

namespace {

double area_of(std::span<const glm::dvec2> polygon) {
  double twice = 0;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const glm::dvec2 &p = polygon[k], &q = polygon[(k + 1) % polygon.size()];
    twice += p.x * q.y - p.y * q.x;
  }
  return std::abs(twice) / 2;
}

LightFigure face_at(const Attribution& a, const Light& light, std::size_t i) {
  return {light, a.gbuffer.position(i), a.gbuffer.normal(i)};
}

Light four_times(Light light) {
  if (auto* rect = std::get_if<RectLight>(&light.kind)) {
    rect->half_u *= 4.0f;
    rect->half_v *= 4.0f;
  } else if (auto* disc = std::get_if<DiscLight>(&light.kind)) {
    disc->radius *= 4;
  } else {
    std::get<SphereLight>(light.kind).radius *= 4;
  }
  return light;
}

}  // namespace

double LightQuestions::above_horizon(std::size_t i) const {
  const LightFigure face = face_at(a_, a_.light, i);
  std::vector<glm::dvec2> figure;
  if (face.is_disc()) {
    constexpr int corners = 128;
    for (int k = 0; k < corners; ++k) {
      const double angle = 2 * std::numbers::pi * k / corners;
      figure.emplace_back(std::cos(angle), std::sin(angle));
    }
  } else {
    figure = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
  }
  const double whole = area_of(figure);
  clip_places(figure, face.horizon());
  return area_of(figure) / whole;
}

std::vector<std::uint32_t> LightQuestions::between(std::size_t i, const glm::dvec3& way) const {
  constexpr int most_surfaces = 256;
  const glm::vec3 point = a_.gbuffer.position(i);
  const glm::dvec3 origin = point + static_cast<float>(ray_offset(point)) * a_.gbuffer.normal(i);
  const double step = 1e-6 + 4 * ray_offset(point) / glm::length(way);
  std::vector<std::uint32_t> meshes;
  double t = 0;
  for (int k = 0; k < most_surfaces; ++k) {
    const RayScene::Hit hit = a_.casters.closest(origin + t * way, way);
    if (hit.mesh == no_mesh || t + hit.t >= 1 - step) break;
    const bool is_own = hit.mesh == a_.gbuffer.mesh[i] && hit.triangle == a_.gbuffer.triangle[i] && t == 0;
    if (!is_own && std::ranges::find(meshes, hit.mesh) == meshes.end()) meshes.push_back(hit.mesh);
    t += hit.t + step;
  }
  return meshes;
}

LightQuestions::Casters LightQuestions::casters(std::size_t i) const {
  constexpr std::uint32_t rounds = 16;
  const LightFigure face = face_at(a_, a_.light, i);
  const LightFigure::Box& box = face.box();
  const Scramble scramble(~std::uint64_t{i});
  std::map<std::uint32_t, std::size_t> hidden;
  std::size_t asked = 0, hidden_together = 0;
  for (std::uint32_t round = 0; round < rounds; ++round) {
    const Squares squares = scramble.of_first(round);
    for (std::size_t k = 0; k < squares.x.size(); ++k) {
      const glm::dvec2 place = box.low + glm::dvec2(squares.x[k], squares.y[k]) * (box.high - box.low);
      if (!face.holds(place)) continue;
      ++asked;
      const std::vector<std::uint32_t> meshes = between(i, face.at(place));
      hidden_together += !meshes.empty();
      for (const std::uint32_t mesh : meshes) ++hidden[mesh];
    }
  }
  Casters casters;
  casters.count = hidden.size();
  const auto left_by = [&](std::size_t count) { return 1 - static_cast<double>(count) / static_cast<double>(asked); };
  if (asked == 0) return casters;
  casters.together = left_by(hidden_together);
  for (const auto& [mesh, count] : hidden) {
    casters.product *= left_by(count);
    casters.least = std::min(casters.least, left_by(count));
  }
  return casters;
}

std::optional<double> LightQuestions::seen_of_larger(std::size_t i) const {
  const LightFigure face = face_at(a_, four_times(a_.light), i);
  if (!face.is_seen()) return std::nullopt;
  const FaceRays rays(a_.casters, a_.gbuffer, i, face);
  const Scramble scramble(i);
  int asked = 0, blocked = 0;
  for (std::uint32_t round = 0; round < 16; ++round) {
    const FaceHits hits = rays.ask(scramble.of_first(round));
    asked += std::popcount(hits.asked);
    blocked += std::popcount(hits.blocked);
  }
  if (asked == 0) return std::nullopt;
  return 1 - static_cast<double>(blocked) / asked;
}

std::pair<double, double> LightQuestions::asked_again(std::size_t i, double error) const {
  const FaceRays rays(a_.casters, a_.gbuffer, i, face_at(a_, a_.light, i));
  // References are made with the pixel's index for seed: this is another one for every pixel of every picture.
  const std::uint64_t seed = (std::uint64_t{1} << 40) + i;
  const SampledShares shares = sample_shares(rays, seed, {.error = std::max(error / 2, 1e-5), .cap = 1 << 15});
  if (a_.estimates == LightShareKind::irradiance) return {shares.irradiance, shares.irradiance_error};
  return {shares.area, shares.area_error};
}

}  // namespace gnomon
