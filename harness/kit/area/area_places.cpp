#include <gnomon/kit/area/light_points.h>
#include <gnomon/kit/random.h>
#include <gnomon/kit/vectorized.h>

#include <bit>
#include <cmath>
#include <numbers>

namespace gnomon {

namespace {

constexpr std::uint32_t reversed(std::uint32_t bits) {
  bits = (bits & 0x55555555u) << 1 | (bits >> 1 & 0x55555555u);
  bits = (bits & 0x33333333u) << 2 | (bits >> 2 & 0x33333333u);
  bits = (bits & 0x0f0f0f0fu) << 4 | (bits >> 4 & 0x0f0f0f0fu);
  bits = (bits & 0x00ff00ffu) << 8 | (bits >> 8 & 0x00ff00ffu);
  return bits << 16 | bits >> 16;
}

/// Nested uniform scrambling (Owen 1995) of digits in reverse order, by hashing (Laine and Karras 2011): no step lets a
/// bit depend on those above it, which are the later digits. The random number that is added last makes every place as likely
/// as every other, whatever comes before.
constexpr float scrambled(std::uint32_t digits, std::uint32_t factor, std::uint32_t random) {
  digits ^= digits * 0x6c1a86b2u;
  digits = digits * factor + factor;
  digits ^= digits * 0x9be5b4d6u;
  digits += random;
  return static_cast<float>(static_cast<std::int32_t>(reversed(digits) >> 8)) * 0x1p-24f;
}

/// Places of one sequence from number `first` on, by one scramble; `second` has their digits in the second dimension.
GNOMON_VECTORIZED void scramble_first(std::uint32_t first, const std::uint32_t* second, std::uint32_t random_x,
                                      std::uint32_t random_y, std::uint32_t factor, Squares& __restrict squares) {
  constexpr std::uint32_t count = ray_lanes;
  for (std::uint32_t k = 0; k < count; ++k) squares.x[k] = scrambled(first + k, factor, random_x);
  for (std::uint32_t k = 0; k < count; ++k) squares.y[k] = scrambled(second[k], factor, random_y);
}

/// The places of a round, each sequence by a scramble of its own: of sequence k the places `index` and the one after it, whose
/// digits in the second dimension are `second` and that with its first digit turned over.
GNOMON_VECTORIZED void scramble_round(std::uint32_t index, std::uint32_t second, const std::uint32_t* random_x,
                                      const std::uint32_t* random_y, const std::uint32_t* factor, Squares& __restrict squares) {
  constexpr std::uint32_t count = ray_lanes;
  for (std::uint32_t k = 0; k < count; ++k) squares.x[k] = scrambled(index + k / ray_replicas, factor[k], random_x[k]);
  for (std::uint32_t k = 0; k < count; ++k) squares.y[k] = scrambled(second ^ k / ray_replicas, factor[k], random_y[k]);
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

/// The cell of each of sixteen places, of 8 x 8 along Morton's curve.
GNOMON_VECTORIZED void find_cells(const float* x, const float* y, std::uint32_t* cell) {
  for (int k = 0; k < ray_lanes; ++k) {
    const auto i = static_cast<std::uint32_t>(static_cast<std::int32_t>(x[k] * 8));
    const auto j = static_cast<std::uint32_t>(static_cast<std::int32_t>(y[k] * 8));
    cell[k] = (i & 1) | (i & 2) << 1 | (i & 4) << 2 | (j & 1) << 1 | (j & 2) << 2 | (j & 4) << 3;
  }
}

}  // namespace

glm::dvec2 place_in_disc(const glm::dvec2& square) {
  const bool is_flat = std::abs(square.x) > std::abs(square.y);
  const double radius = is_flat ? square.x : square.y, other = is_flat ? square.y : square.x;
  const double turn = radius != 0 ? std::numbers::pi / 4 * other / radius : 0;
  return radius * (is_flat ? glm::dvec2(std::cos(turn), std::sin(turn)) : glm::dvec2(std::sin(turn), std::cos(turn)));
}

Squares places_on(const LightFigure& figure, const Squares& squares, int count) {
  const LightFigure::Box& box = figure.box();
  Squares result{};
  for (int k = 0; k < count; ++k) {
    glm::dvec2 place(2.0 * squares.x[k] - 1, 2.0 * squares.y[k] - 1);
    if (figure.is_disc()) place = place_in_disc(place);
    const glm::dvec2 along = (place - box.low) / (box.high - box.low);
    result.x[k] = static_cast<float>(along.x);
    result.y[k] = static_cast<float>(along.y);
  }
  return result;
}

Scramble::Scramble(std::uint64_t seed) {
  for (int k = 0; k < ray_lanes; ++k) {
    const std::uint64_t number = mixed(mixed(seed) + static_cast<std::uint64_t>(k % ray_replicas));
    x_[k] = static_cast<std::uint32_t>(number);
    y_[k] = static_cast<std::uint32_t>(number >> 32);
    factor_[k] = static_cast<std::uint32_t>(mixed(number)) | 1;
  }
}

Squares Scramble::of_each(std::uint32_t round) const {
  Squares squares;
  scramble_round(2 * round, second_of(2 * round), x_.data(), y_.data(), factor_.data(), squares);
  return squares;
}

Squares Scramble::of_first(std::uint32_t group) const {
  const std::uint32_t first = ray_lanes * group;
  std::array<std::uint32_t, ray_lanes> second;
  for (std::uint32_t k = 0; k < ray_lanes; ++k) second[k] = second_of(first + k);
  Squares squares;
  scramble_first(first, second.data(), x_[0], y_[0], factor_[0], squares);
  return squares;
}

// Of 64 places of one sequence from a multiple of 64 on each cell holds one: no two have the same slot.
void SortedRounds::sort(const Scramble& scramble, std::uint32_t from, std::uint32_t to) {
  count_ = to - from;
  std::array<std::uint64_t, ray_replicas> taken{};
  const auto slot = [&](std::array<float, ray_lanes> Squares::*along, std::uint32_t cell, std::uint32_t replica) -> float& {
    return (packets_[cell / 2].*along)[cell % 2 * ray_replicas + replica];
  };
  for (std::uint32_t round = from; round < to; ++round) {
    const Squares squares = scramble.of_each(round);
    alignas(64) std::array<std::uint32_t, ray_lanes> cell;
    find_cells(squares.x.data(), squares.y.data(), cell.data());
    for (std::uint32_t k = 0; k < ray_lanes; ++k) {
      slot(&Squares::x, cell[k], k % ray_replicas) = squares.x[k];
      slot(&Squares::y, cell[k], k % ray_replicas) = squares.y[k];
    }
    for (std::uint32_t k = 0; k < ray_lanes && count_ < most; ++k) taken[k % ray_replicas] |= std::uint64_t{1} << cell[k];
  }
  if (count_ == most) return;
  // Each sequence closes its own gaps.
  for (std::uint32_t replica = 0; replica < ray_replicas; ++replica) {
    std::uint32_t rank = 0;
    for (std::uint64_t left = taken[replica]; left; left &= left - 1, ++rank)
      for (const auto along : {&Squares::x, &Squares::y})
        slot(along, rank, replica) = slot(along, static_cast<std::uint32_t>(std::countr_zero(left)), replica);
  }
}

}  // namespace gnomon
