#include <gnomon/kit/area/area_rays.h>
#include <gnomon/kit/parallel.h>
#include <gnomon/kit/vectorized.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numeric>

namespace gnomon {

namespace {

/// Rays first .. last - 1 of a packet to the places of as many squares, and their weights, 0 where there is no ray. Bit k of
/// the result: place k is on the light and above the horizon.
GNOMON_VECTORIZED std::uint32_t aim(const float* f, const float* x, const float* y, int first, int last,
                                    ShadowPacket& __restrict packet, float* __restrict weight) {
  const float *c = f, *u = f + 3, *v = f + 6, *n = f + 9, *axis = f + 12, *origin = f + 15, *lift = f + 18, *horizon = f + 21;
  const float low_s = f[24], low_t = f[25], size_s = f[26], size_t = f[27], is_disc = f[28], unit = f[29];
  std::uint32_t held = 0;
  for (int k = first; k < last; ++k) {
    const float s = low_s + x[k] * size_s, t = low_t + y[k] * size_t;
    const bool on = (is_disc * (s * s + t * t) <= 1) & (horizon[0] + horizon[1] * s + horizon[2] * t > 0);
    held |= on ? 1u << k : 0;
    const float dx = c[0] + s * u[0] + t * v[0], dy = c[1] + s * u[1] + t * v[1], dz = c[2] + s * u[2] + t * v[2];
    const float ex = unit * dx, ey = unit * dy, ez = unit * dz, per_square = 1 / (ex * ex + ey * ey + ez * ez);
    const float rise = n[0] * ex + n[1] * ey + n[2] * ez, front = std::fabs(axis[0] * ex + axis[1] * ey + axis[2] * ez);
    weight[k] = on ? rise * per_square * (front * per_square) : 0;
    packet.ox[k] = origin[0];
    packet.oy[k] = origin[1];
    packet.oz[k] = origin[2];
    packet.dx[k] = dx - lift[0];
    packet.dy[k] = dy - lift[1];
    packet.dz[k] = dz - lift[2];
    packet.tnear[k] = 0;
    packet.time[k] = 0;
    packet.tfar[k] = 1;
    packet.mask[k] = 0xffffffffu;
    packet.id[k] = static_cast<std::uint32_t>(k);
    packet.flags[k] = 0;
  }
  return held;
}

/// What rays in `hits.asked` find.
void trace_packet(const RayScene& casters, bool has_transmission, ShadowPacket& packet, const Receivers& receivers,
                  FaceHits& hits) {
  if (hits.asked == 0) return;
  if (!has_transmission) {
    hits.blocked = casters.occluded(hits.asked, packet, receivers);
    return;
  }
  thread_local std::array<Crossings, ray_lanes> crossings;  // they keep their memory
  const ShadowPacket aimed = packet;                        // tracing may take the packet to another frame
  hits.blocked = casters.crossed(hits.asked, packet, receivers, crossings);
  for (std::uint32_t left = hits.asked & ~hits.blocked; left; left &= left - 1) {
    const int k = std::countr_zero(left);
    if (crossings[k].empty()) continue;
    const glm::dvec3 origin(aimed.ox[k], aimed.oy[k], aimed.oz[k]), direction(aimed.dx[k], aimed.dy[k], aimed.dz[k]);
    const Crossings::Product product = crossings[k].product([&](std::uint32_t mesh, std::uint32_t triangle) {
      return transmission_along(casters.scene().meshes[mesh], triangle, origin, direction);
    });
    hits.passed[k] = static_cast<float>(product.share.x);
    if (hits.passed[k] == 0) hits.blocked |= 1u << k;
    if (hits.passed[k] > 0 && hits.passed[k] < 1) hits.dimmed |= 1u << k;
  }
}

/// Of each replica: the numbers of places asked and blocked, those that are dimmed by what they miss, and the weights of both.
/// And the largest weight of all.
struct Sums {
  std::array<double, ray_replicas> asked{}, blocked{}, weight{}, blocked_weight{};
  float heaviest = 0;
};

struct Share {
  double value = 1, error = 0, half = 1;
};

/// The share seen: by all replicas together, with its standard error from their spread, and by half of them alone. Of a ratio:
/// a replica is off by what its dark part differs from that share of its rays, in units of a mean replica.
Share share_of(const std::array<double, ray_replicas>& all, const std::array<double, ray_replicas>& dark) {
  const auto total = [](const auto& of, int count) { return std::accumulate(of.begin(), of.begin() + count, 0.0); };
  const double sum = total(all, ray_replicas), sum_dark = total(dark, ray_replicas);
  if (!(sum > 0)) return {};
  const double half = total(all, ray_replicas / 2), half_dark = total(dark, ray_replicas / 2);
  double squares = 0;
  for (int k = 0; k < ray_replicas; ++k) {
    const double off = (dark[k] - sum_dark / sum * all[k]) * ray_replicas / sum;
    squares += off * off;
  }
  return {1 - sum_dark / sum, std::sqrt(squares / (ray_replicas - 1) / ray_replicas),
          1 - (half > 0 ? half_dark / half : sum_dark / sum)};
}

/// The same of one chunk of packets, by lane: of each replica two.
struct LaneSums {
  alignas(64) std::array<float, ray_lanes> asked{}, blocked{}, weight{}, blocked_weight{}, heaviest{};
};

GNOMON_VECTORIZED void add_up(std::uint32_t asked, std::uint32_t blocked, const float* weight, LaneSums& sums) {
  for (int k = 0; k < ray_lanes; ++k) {
    const float is_asked = asked >> k & 1 ? 1.0f : 0.0f, is_blocked = blocked >> k & 1 ? 1.0f : 0.0f;
    sums.asked[k] += is_asked;
    sums.blocked[k] += is_blocked;
    sums.weight[k] += weight[k];
    sums.blocked_weight[k] += is_blocked * weight[k];
    sums.heaviest[k] = sums.heaviest[k] < weight[k] ? weight[k] : sums.heaviest[k];
  }
}

/// The same of rays that may be dimmed, in double: in float32 parts of rays do not add up to the same in every replica.
void add_up(const FaceHits& hits, Sums& sums) {
  for (std::uint32_t left = hits.asked; left; left &= left - 1) {
    const int k = std::countr_zero(left), replica = k % ray_replicas;
    const double hidden = 1 - hits.seen(k), weight = hits.weight[k];
    sums.asked[replica] += 1;
    sums.blocked[replica] += hidden;
    sums.weight[replica] += weight;
    sums.blocked_weight[replica] += hidden * weight;
    sums.heaviest = std::max(sums.heaviest, hits.weight[k]);
  }
}

/// Traces rays to the places of rounds from .. to - 1 of each replica.
void ask(const FaceRays& rays, const Scramble& scramble, std::uint32_t from, std::uint32_t to, Sums& sums) {
  SortedRounds sorted;
  for (std::uint32_t end; from < to; from = end) {
    end = std::min(to, from / SortedRounds::most * SortedRounds::most + SortedRounds::most);
    sorted.sort(scramble, from, end);
    LaneSums chunk;
    for (std::uint32_t packet = 0; packet < sorted.packet_count(); ++packet) {
      const FaceHits hits = rays.ask(sorted.squares(packet));
      if (rays.has_transmission())
        add_up(hits, sums);
      else
        add_up(hits.asked, hits.blocked, hits.weight.data(), chunk);
    }
    for (std::size_t k = 0; k < ray_lanes; ++k) {
      sums.asked[k % ray_replicas] += chunk.asked[k];
      sums.blocked[k % ray_replicas] += chunk.blocked[k];
      sums.weight[k % ray_replicas] += chunk.weight[k];
      sums.blocked_weight[k % ray_replicas] += chunk.blocked_weight[k];
      sums.heaviest = std::max(sums.heaviest, chunk.heaviest[k]);
    }
  }
}

SampledShares shares_of(const Sums& sums) {
  const Share area = share_of(sums.asked, sums.blocked), irradiance = share_of(sums.weight, sums.blocked_weight);
  return {.area = area.value,
          .irradiance = irradiance.value,
          .area_error = area.error,
          .irradiance_error = irradiance.error,
          .area_half = area.half,
          .irradiance_half = irradiance.half,
          .rays = static_cast<std::uint32_t>(std::accumulate(sums.asked.begin(), sums.asked.end(), 0.0))};
}

/// What one ray more or less makes of the irradiance, where its weight is half of the heaviest one's: a place that is so near
/// that it outweighs all others may have been missed.
double one_ray_of_irradiance(const Sums& sums) {
  const double weight = std::accumulate(sums.weight.begin(), sums.weight.end(), 0.0);
  return weight > 0 ? 0.5 * sums.heaviest / weight : 1;
}

glm::vec3 lift_of(const GBuffer& gbuffer, std::size_t pixel) {
  return static_cast<float>(area_ray_offset(gbuffer.position(pixel))) * gbuffer.normal(pixel);
}

}  // namespace

double area_ray_offset(const glm::vec3& point) { return ray_offset(point) / 4; }

FaceAim::FaceAim(const glm::vec3& origin, const glm::vec3& lift, const LightFigure& figure) {
  const glm::dvec3 axis = glm::normalize(glm::cross(figure.half_u(), figure.half_v()));
  // In this unit weights keep within float32, as near or far and as large or small as the light may be.
  const double unit = 1 / std::max({glm::length(figure.center()), glm::length(figure.half_u()), glm::length(figure.half_v())});
  float* next = numbers_.data();
  for (const glm::dvec3& vector : {figure.center(), figure.half_u(), figure.half_v(), figure.normal(), axis, glm::dvec3(origin),
                                   glm::dvec3(lift), figure.horizon()})
    for (int k = 0; k < 3; ++k) *next++ = static_cast<float>(vector[k]);
  const LightFigure::Box& box = figure.box();
  for (const double number :
       {box.low.x, box.low.y, box.high.x - box.low.x, box.high.y - box.low.y, figure.is_disc() ? 1.0 : 0.0, unit})
    *next++ = static_cast<float>(number);
}

FaceAim::FaceAim(const GBuffer& gbuffer, std::size_t pixel, const LightFigure& figure) {
  const glm::vec3 lift = lift_of(gbuffer, pixel);
  *this = FaceAim(gbuffer.position(pixel) + lift, lift, figure);
}

FaceRays::FaceRays(const RayScene& casters, const glm::vec3& origin, const glm::vec3& lift, std::uint32_t mesh,
                   std::uint32_t triangle, const LightFigure& figure)
    : casters_(casters), aim_(origin, lift, figure) {
  mesh_.fill(mesh);
  triangle_.fill(triangle);
}

FaceRays::FaceRays(const RayScene& casters, const GBuffer& gbuffer, std::size_t pixel, const LightFigure& figure)
    : FaceRays(casters, gbuffer.position(pixel) + lift_of(gbuffer, pixel), lift_of(gbuffer, pixel), gbuffer.mesh[pixel],
               gbuffer.triangle[pixel], figure) {}

std::uint32_t FaceRays::aim_at(const Squares& squares, ShadowPacket& packet) const {
  alignas(64) std::array<float, ray_lanes> weight;
  return aim(aim_.numbers(), squares.x.data(), squares.y.data(), 0, ray_lanes, packet, weight.data());
}

FaceHits FaceRays::ask(const Squares& squares, std::uint32_t wanted) const {
  FaceHits hits;
  ShadowPacket packet;
  hits.asked = aim(aim_.numbers(), squares.x.data(), squares.y.data(), 0, ray_lanes, packet, hits.weight.data()) & wanted;
  trace_packet(casters_, has_transmission_, packet, {mesh_.data(), triangle_.data()}, hits);
  return hits;
}

bool GatheredRays::add(const FaceAim& from, const glm::vec2& square, std::uint32_t mesh, std::uint32_t triangle) {
  x_[count_] = square.x;
  y_[count_] = square.y;
  if (aim(from.numbers(), x_.data(), y_.data(), count_, count_ + 1, packet_, weight_.data()) == 0) return false;
  mesh_[count_] = mesh;
  triangle_[count_] = triangle;
  ++count_;
  return true;
}

FaceHits GatheredRays::trace() const {
  FaceHits hits;
  hits.asked = (1u << count_) - 1;
  std::copy_n(weight_.begin(), count_, hits.weight.begin());
  ShadowPacket packet = packet_;  // tracing may take it to another frame
  trace_packet(casters_, has_transmission_, packet, {mesh_.data(), triangle_.data()}, hits);
  return hits;
}

SampledShares sample_shares(const FaceRays& rays, std::uint64_t seed, const AreaTarget& target) {
  const auto error_of = [](const SampledShares& shares) { return std::max(shares.area_error, shares.irradiance_error); };
  // Counts of rays are exact; replicas that all see the same through transmission differ by the rounding of their sums.
  const double rounding = rays.has_transmission() ? 1e-12 : 0;
  // 64 rays; where they differ, 256.
  std::uint32_t pilot_rounds = 4;
  const Scramble pilot_scramble(2 * seed);
  Sums pilot;
  ask(rays, pilot_scramble, 0, pilot_rounds, pilot);
  if (error_of(shares_of(pilot)) > rounding) {
    ask(rays, pilot_scramble, pilot_rounds, 16, pilot);
    pilot_rounds = 16;
  }
  const SampledShares foretold = shares_of(pilot);

  // One ray more or less is an error of 1 / rays. That of an edge across the light falls as the number of rays to -0.75.
  const double most = std::max(target.cap / ray_lanes, 1u), rays_per_round = std::max(foretold.rays, 1u) * 1.0 / pilot_rounds;
  const auto rounds_for_one_ray = [&](double rays_so_far) {
    return std::ceil((1 / target.error - rays_so_far) / rays_per_round);
  };
  const double for_spread = std::ceil(pilot_rounds * std::pow(error_of(foretold) / (0.85 * target.error), 1 / 0.75));
  const Scramble scramble(2 * seed + 1);
  Sums sums;
  double known_area = foretold.area_error, known_irradiance = foretold.irradiance_error, known_rounds = pilot_rounds;
  double asked = 0, rounds = std::clamp(std::max(for_spread, rounds_for_one_ray(0)), 1.0, most);
  for (;;) {
    ask(rays, scramble, static_cast<std::uint32_t>(asked), static_cast<std::uint32_t>(rounds), sums);
    asked = rounds;
    SampledShares shares = shares_of(sums);
    shares.pilot_rays = foretold.rays;
    const double one_ray = 1.0 / std::max(shares.rays, 1u), one_heavy_ray = one_ray_of_irradiance(sums);
    const double spread = std::max(error_of(shares), one_heavy_ray);
    // Eight replicas that happen to agree would state too little: what the pilot and earlier rounds predict for so many
    // rays is a floor. Without the latter rays that go on until they agree would have the error of those that happen to.
    const double by_now = std::pow(known_rounds / asked, 0.75);
    known_area = std::max(by_now * known_area, shares.area_error);
    known_irradiance = std::max(by_now * known_irradiance, shares.irradiance_error);
    // The halves of those that happen to agree differ by too little, too.
    const auto as_far_as = [&](double half, double whole, double known, double spread) {
      return spread > rounding ? whole + (half - whole) * known / spread : half;
    };
    shares.area_half = as_far_as(shares.area_half, shares.area, known_area, shares.area_error);
    shares.irradiance_half = as_far_as(shares.irradiance_half, shares.irradiance, known_irradiance, shares.irradiance_error);
    known_rounds = asked;
    shares.area_error = std::max(known_area, one_ray);
    shares.irradiance_error = std::max({known_irradiance, one_ray, one_heavy_ray});
    if (error_of(shares) <= target.error || asked >= most) return shares;
    const double by_law = asked * (std::pow(std::max(known_area, known_irradiance) / target.error, 1 / 0.75) - 1);
    const double more =
        spread > target.error ? std::ceil(0.3 * asked) : std::max({rounds_for_one_ray(shares.rays), std::ceil(by_law), 1.0});
    rounds = std::min(most, asked + more);
  }
}

std::size_t trace_shares(const RayScene& casters, const Scene& scene, const GBuffer& gbuffer, const Light& light,
                         const AreaTarget& target, std::span<float> visibility) {
  std::atomic<std::size_t> ray_count = 0;
  for_blocks(gbuffer.size(), 64, [&](std::size_t begin, std::size_t end) {
    std::size_t rays = 0;
    for (std::size_t i = begin; i < end; ++i) {
      visibility[i] = 1;
      if (gbuffer.is_background(i) || !scene.meshes[gbuffer.mesh[i]].receives) continue;
      const LightFigure figure(light, gbuffer.position(i), gbuffer.normal(i));
      if (!figure.is_seen()) continue;
      const SampledShares shares = sample_shares(FaceRays(casters, gbuffer, i, figure), i, target);
      visibility[i] = static_cast<float>(shares.area);
      rays += shares.rays + shares.pilot_rays;
    }
    ray_count += rays;
  });
  return ray_count;
}

}  // namespace gnomon
