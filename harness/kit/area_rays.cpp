#include <gnomon/kit/area_rays.h>
#include <gnomon/kit/parallel.h>
#include <gnomon/kit/vectorized.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <numbers>

namespace gnomon {

namespace {

constexpr int lanes = 16, replicas = 8;

/// Rays to the places of sixteen squares, and their weights. Bit k of the result: place k is on the light and above the
/// horizon.
GNOMON_VECTORIZED std::uint32_t aim(const float* f, const float* x, const float* y, ShadowPacket& __restrict packet,
                                    float* __restrict weight) {
  const float *c = f, *u = f + 3, *v = f + 6, *n = f + 9, *axis = f + 12, *origin = f + 15, *lift = f + 18, *horizon = f + 21;
  const float low_s = f[24], low_t = f[25], size_s = f[26], size_t = f[27], is_disc = f[28];
  std::uint32_t held = 0;
  for (int k = 0; k < lanes; ++k) {
    const float s = low_s + x[k] * size_s, t = low_t + y[k] * size_t;
    const bool on = (is_disc * (s * s + t * t) <= 1) & (horizon[0] + horizon[1] * s + horizon[2] * t > 0);
    held |= on ? 1u << k : 0;
    const float dx = c[0] + s * u[0] + t * v[0], dy = c[1] + s * u[1] + t * v[1], dz = c[2] + s * u[2] + t * v[2];
    const float square = dx * dx + dy * dy + dz * dz;
    weight[k] = (n[0] * dx + n[1] * dy + n[2] * dz) * std::fabs(axis[0] * dx + axis[1] * dy + axis[2] * dz) / square / square;
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

/// Of each replica: places asked and blocked, and the weights of both.
struct Sums {
  std::array<double, replicas> asked{}, blocked{}, weight{}, blocked_weight{};
};

constexpr std::uint32_t reversed(std::uint32_t bits) {
  bits = (bits & 0x55555555u) << 1 | (bits >> 1 & 0x55555555u);
  bits = (bits & 0x33333333u) << 2 | (bits >> 2 & 0x33333333u);
  bits = (bits & 0x0f0f0f0fu) << 4 | (bits >> 4 & 0x0f0f0f0fu);
  bits = (bits & 0x00ff00ffu) << 8 | (bits >> 8 & 0x00ff00ffu);
  return bits << 16 | bits >> 16;
}

/// Nested uniform scrambling (Owen 1995) of digits that stand in reverse, by hashing (Laine and Karras 2011): no step lets a
/// bit depend on those above it, which are the later digits. The random number that is added last makes every place as likely
/// as every other, whatever comes before.
constexpr float scrambled(std::uint32_t digits, std::uint32_t factor, std::uint32_t random) {
  digits ^= digits * 0x6c1a86b2u;
  digits = digits * factor + factor;
  digits ^= digits * 0x9be5b4d6u;
  digits += random;
  return static_cast<float>(static_cast<std::int32_t>(reversed(digits) >> 8)) * 0x1p-24f;
}

/// Places of a sequence, their digits in reverse, each by a scramble of its own.
GNOMON_VECTORIZED void scramble(const std::uint32_t* x, const std::uint32_t* y, const std::uint32_t* random_x,
                                const std::uint32_t* random_y, const std::uint32_t* factor, Squares& __restrict squares) {
  for (int k = 0; k < lanes; ++k) squares.x[k] = scrambled(x[k], factor[k], random_x[k]);
  for (int k = 0; k < lanes; ++k) squares.y[k] = scrambled(y[k], factor[k], random_y[k]);
}

/// Sobol's sequence with its digits in reverse: the first dimension is the index itself (van der Corput), the direction numbers
/// of the second are the rows of Pascal's triangle modulo 2.
constexpr std::uint32_t second_of(std::uint32_t index) {
  std::uint32_t result = 0;
  for (std::uint32_t direction = 1; index != 0; index >>= 1) {
    if (index & 1) result ^= direction;
    direction ^= direction << 1;
  }
  return result;
}

/// SplitMix64 (Steele, Lea and Flood 2014): numbers that look random from a counter.
std::uint64_t mixed(std::uint64_t z) {
  z += 0x9e3779b97f4a7c15u;
  z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
  z = (z ^ z >> 27) * 0x94d049bb133111ebu;
  return z ^ z >> 31;
}

struct Share {
  double value = 1, error = 0;
};

/// The share seen: all replicas together, and the standard error of that by their spread. Of a ratio: each replica is off by
/// what its dark part differs from the share of all that it asked, in units of a mean replica.
Share share_of(const std::array<double, replicas>& all, const std::array<double, replicas>& dark) {
  double sum = 0, sum_dark = 0;
  for (int k = 0; k < replicas; ++k) {
    sum += all[k];
    sum_dark += dark[k];
  }
  if (!(sum > 0)) return {};
  double squares = 0;
  for (int k = 0; k < replicas; ++k) {
    const double off = (dark[k] - sum_dark / sum * all[k]) * replicas / sum;
    squares += off * off;
  }
  return {1 - sum_dark / sum, std::sqrt(squares / (replicas - 1) / replicas)};
}

/// Asks for places of a chunk of rounds in the order of where they lie, so that the sixteen rays of a packet go nearly the same
/// way: in penumbrae twice as fast as in the order of the sequence.
class Rounds {
 public:
  static constexpr std::uint32_t most_at_once = 32;

  void operator()(const FaceRays& rays, const Scramble& scramble, std::uint32_t from, std::uint32_t to, Sums& sums) {
    for (; from < to; from += most_at_once) ask_chunk(rays, scramble, from, std::min(to, from + most_at_once), sums);
  }

 private:
  void ask_chunk(const FaceRays& rays, const Scramble& scramble, std::uint32_t from, std::uint32_t to, Sums& sums) {
    const std::uint32_t count = (to - from) * lanes;
    std::array<std::uint16_t, cells + 1> first{};
    for (std::uint32_t round = 0; round < to - from; ++round) {
      squares_[round] = scramble.of_each(from + round);
      for (int k = 0; k < lanes; ++k) {
        const auto cell = cell_of(squares_[round].x[k], squares_[round].y[k]);
        cell_[round * lanes + k] = cell;
        ++first[cell + 1u];
      }
    }
    for (int cell = 0; cell < cells; ++cell) first[cell + 1] = static_cast<std::uint16_t>(first[cell + 1] + first[cell]);
    for (std::uint32_t place = 0; place < count; ++place) order_[first[cell_[place]]++] = static_cast<std::uint16_t>(place);
    for (std::uint32_t begin = 0; begin < count; begin += lanes) {
      Squares squares;
      for (int k = 0; k < lanes; ++k) {
        const std::uint32_t place = order_[begin + k];
        squares.x[k] = squares_[place / lanes].x[place % lanes];
        squares.y[k] = squares_[place / lanes].y[place % lanes];
      }
      const FaceHits hits = rays.ask(squares);
      for (std::uint32_t left = hits.asked; left; left &= left - 1) {
        const int k = std::countr_zero(left);
        const std::size_t replica = order_[begin + k] % replicas;
        const double is_blocked = hits.blocked >> k & 1;
        sums.asked[replica] += 1;
        sums.weight[replica] += hits.weight[k];
        sums.blocked[replica] += is_blocked;
        sums.blocked_weight[replica] += is_blocked * hits.weight[k];
      }
    }
  }

  /// Of 8 x 8 cells, along Morton's curve.
  static std::uint8_t cell_of(float x, float y) {
    static constexpr std::array<std::uint8_t, 8> spread = {0, 1, 4, 5, 16, 17, 20, 21};
    return static_cast<std::uint8_t>(spread[static_cast<int>(x * 8)] | spread[static_cast<int>(y * 8)] << 1);
  }

  static constexpr int cells = 64;
  std::array<Squares, most_at_once> squares_;
  std::array<std::uint8_t, most_at_once * lanes> cell_;
  std::array<std::uint16_t, most_at_once * lanes> order_;
};

SampledShares shares_of(const Sums& sums) {
  const Share area = share_of(sums.asked, sums.blocked), irradiance = share_of(sums.weight, sums.blocked_weight);
  double rays = 0;
  for (const double asked : sums.asked) rays += asked;
  return {area.value, irradiance.value, area.error, irradiance.error, static_cast<std::uint32_t>(rays), 0};
}

glm::vec3 lift_of(const GBuffer& gbuffer, std::size_t pixel) {
  return static_cast<float>(ray_offset(gbuffer.position(pixel))) * gbuffer.normal(pixel);
}

}  // namespace

FaceRays::FaceRays(const RayScene& casters, const glm::vec3& origin, const glm::vec3& lift, std::uint32_t mesh,
                   std::uint32_t triangle, const LightFace& face)
    : casters_(casters) {
  mesh_.fill(mesh);
  triangle_.fill(triangle);
  // Weights of 1 straight above the light's center keep within float32.
  const glm::dvec3 axis = glm::normalize(glm::cross(face.half_u(), face.half_v())) * glm::dot(face.center(), face.center());
  float* next = numbers_.data();
  for (const glm::dvec3& vector :
       {face.center(), face.half_u(), face.half_v(), face.normal(), axis, glm::dvec3(origin), glm::dvec3(lift), face.horizon()})
    for (int k = 0; k < 3; ++k) *next++ = static_cast<float>(vector[k]);
  const LightFace::Box& box = face.box();
  for (const double number : {box.low.x, box.low.y, box.high.x - box.low.x, box.high.y - box.low.y, face.is_disc() ? 1.0 : 0.0})
    *next++ = static_cast<float>(number);
}

FaceRays::FaceRays(const RayScene& casters, const GBuffer& gbuffer, std::size_t pixel, const LightFace& face)
    : FaceRays(casters, gbuffer.position(pixel) + lift_of(gbuffer, pixel), lift_of(gbuffer, pixel), gbuffer.mesh[pixel],
               gbuffer.triangle[pixel], face) {}

FaceHits FaceRays::ask(const Squares& squares, std::uint32_t wanted) const {
  FaceHits hits;
  ShadowPacket packet;
  hits.asked = aim(numbers_.data(), squares.x.data(), squares.y.data(), packet, hits.weight.data()) & wanted;
  if (hits.asked) hits.blocked = casters_.occluded(hits.asked, packet, {mesh_.data(), triangle_.data()});
  return hits;
}

Squares places_on(const LightFace& face, const Squares& squares) {
  const LightFace::Box& box = face.box();
  Squares result;
  for (int k = 0; k < lanes; ++k) {
    glm::dvec2 place(2.0 * squares.x[k] - 1, 2.0 * squares.y[k] - 1);
    if (face.is_disc()) {
      const bool is_flat = std::abs(place.x) > std::abs(place.y);
      const double radius = is_flat ? place.x : place.y, other = is_flat ? place.y : place.x;
      const double turn = radius != 0 ? std::numbers::pi / 4 * other / radius : 0;
      place = radius * (is_flat ? glm::dvec2(std::cos(turn), std::sin(turn)) : glm::dvec2(std::sin(turn), std::cos(turn)));
    }
    const glm::dvec2 along = (place - box.low) / (box.high - box.low);
    result.x[k] = static_cast<float>(along.x);
    result.y[k] = static_cast<float>(along.y);
  }
  return result;
}

Scramble::Scramble(std::uint64_t seed) {
  for (int k = 0; k < lanes; ++k) {
    const std::uint64_t number = mixed(mixed(seed) + static_cast<std::uint64_t>(k % replicas));
    x_[k] = static_cast<std::uint32_t>(number);
    y_[k] = static_cast<std::uint32_t>(number >> 32);
    factor_[k] = static_cast<std::uint32_t>(mixed(number)) | 1;
  }
}

Squares Scramble::of_each(std::uint32_t round) const {
  std::array<std::uint32_t, lanes> x, y;
  for (std::uint32_t k = 0; k < lanes; ++k) x[k] = 2 * round + k / replicas;
  const std::uint32_t first = second_of(2 * round), second = second_of(2 * round + 1);
  for (std::uint32_t k = 0; k < lanes; ++k) y[k] = k < replicas ? first : second;
  Squares squares;
  scramble(x.data(), y.data(), x_.data(), y_.data(), factor_.data(), squares);
  return squares;
}

Squares Scramble::of_first(std::uint32_t group) const {
  std::array<std::uint32_t, lanes> x, y, of_x, of_y, factor;
  for (std::uint32_t k = 0; k < lanes; ++k) {
    x[k] = lanes * group + k;
    y[k] = second_of(x[k]);
  }
  of_x.fill(x_[0]);
  of_y.fill(y_[0]);
  factor.fill(factor_[0]);
  Squares squares;
  scramble(x.data(), y.data(), of_x.data(), of_y.data(), factor.data(), squares);
  return squares;
}

SampledShares sample_shares(const FaceRays& rays, std::uint64_t seed, const AreaTarget& target) {
  const auto error_of = [](const SampledShares& shares) { return std::max(shares.area_error, shares.irradiance_error); };
  Rounds ask;
  // 64 rays; where they differ, 256.
  std::uint32_t pilot_rounds = 4;
  const Scramble pilot_scramble(2 * seed);
  Sums pilot;
  ask(rays, pilot_scramble, 0, pilot_rounds, pilot);
  if (error_of(shares_of(pilot)) > 0) {
    ask(rays, pilot_scramble, pilot_rounds, 16, pilot);
    pilot_rounds = 16;
  }
  const SampledShares foretold = shares_of(pilot);

  // One ray more or less is an error of 1 / rays. That of an edge across the light falls as the number of rays to -0.75.
  const double most = std::max(target.cap / lanes, 1u), rays_per_round = std::max(foretold.rays, 1u) * 1.0 / pilot_rounds;
  const auto rounds_for_one_ray = [&](double rays_so_far) {
    return std::ceil((1 / target.error - rays_so_far) / rays_per_round);
  };
  const double for_spread = std::ceil(pilot_rounds * std::pow(error_of(foretold) / (0.85 * target.error), 1 / 0.75));
  const Scramble scramble(2 * seed + 1);
  Sums sums;
  double asked = 0, rounds = std::clamp(std::max(for_spread, rounds_for_one_ray(0)), 1.0, most);
  for (;;) {
    ask(rays, scramble, static_cast<std::uint32_t>(asked), static_cast<std::uint32_t>(rounds), sums);
    asked = rounds;
    SampledShares shares = shares_of(sums);
    shares.pilot_rays = foretold.rays;
    const double spread = error_of(shares), one_ray = 1.0 / std::max(shares.rays, 1u);
    // Eight replicas that happen to agree would state too little: what the pilot foretells for so many rays is a floor.
    const double by_now = std::pow(pilot_rounds / asked, 0.75);
    shares.area_error = std::max({shares.area_error, one_ray, by_now * foretold.area_error});
    shares.irradiance_error = std::max({shares.irradiance_error, one_ray, by_now * foretold.irradiance_error});
    if (error_of(shares) <= target.error || asked >= most) return shares;
    const double more = spread > target.error ? std::ceil(0.3 * asked) : std::max(rounds_for_one_ray(shares.rays), 1.0);
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
      const LightFace face(light, gbuffer.position(i), gbuffer.normal(i));
      if (!face.is_seen()) continue;
      const SampledShares shares = sample_shares(FaceRays(casters, gbuffer, i, face), i, target);
      visibility[i] = static_cast<float>(shares.area);
      rays += shares.rays + shares.pilot_rays;
    }
    ray_count += rays;
  });
  return ray_count;
}

}  // namespace gnomon
