#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <string_view>
#include <vector>

namespace gnomon {

/// How the places of few rays are spread over a light, over the pixels and over the frames.
enum class RayPattern {
  blue,   ///< a blue-noise mask over pixels (void and cluster, Ulichney 1993), shifted by R2 over rays and frames
  r2,     ///< R2 (Roberts 2018) over rays and frames, shifted by an additive lattice over pixels
  sobol,  ///< Owen-scrambled Sobol over rays and frames, a scramble per pixel: white noise over pixels at one ray
  white   ///< independent random numbers
};
inline constexpr std::array<std::string_view, 4> ray_pattern_names{"blue", "r2", "sobol", "white"};

/// Place `index` of the sequence R2: (0.5 + index / g, 0.5 + index / g^2) mod 1, where g^3 = g + 1.
glm::dvec2 r2_place(std::uint64_t index) noexcept;

/// A square of ranks that wraps around at its borders: the pixels of rank below any r are spread evenly, with no low
/// frequencies. Row-major, side * side ranks, each of 0 .. side * side - 1 once. Same seed, same ranks.
std::vector<std::uint16_t> blue_noise_ranks(int side, std::uint64_t seed);

/// Places of the unit square for the rays of every pixel of every frame. Each is uniform over pixels, so the mean of rays is an
/// unbiased share over any large set of pixels.
class RayPlaces {
 public:
  /// Makes the pattern's tables, for `ray_count` rays a pixel and frame. Takes well below a second; throws Error where
  /// ray_count < 1.
  RayPlaces(RayPattern pattern, int ray_count, std::uint64_t seed = 1);
  /// In [0, 1) both ways. x and y are the pixel's column and row, and ray is 0 .. ray_count - 1. Allocates nothing.
  glm::vec2 place(int x, int y, std::uint32_t frame, int ray) const noexcept;
  RayPattern pattern() const { return pattern_; }
  int ray_count() const { return ray_count_; }
  std::size_t bytes() const { return mask_.size() * sizeof(glm::vec2); }

 private:
  static constexpr int side = 64;  ///< of the mask

  RayPattern pattern_;
  int ray_count_;
  std::uint64_t seed_;
  std::vector<glm::vec2> mask_;  ///< of blue, row-major
};

}  // namespace gnomon
