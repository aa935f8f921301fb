#pragma once
#include <cstdint>
#include <string_view>

// Which samples of a texel a triangle covers, on the processor and, with the same numbers, in a shader.
//
// A triangle that lets t through covers each of the S samples with probability 1 - t. Why the share of samples that nothing
// covers has the product of all t as its mean: a sample is free with probability t of one triangle, and, because each triangle
// has a hash of its own, with the product of all t of several; the mean of S such samples is that product. The samples of *one*
// triangle may depend on each other, for the mean does not change with that. So they are stratified: the triangle covers
// (1 - t) S of them, rounded up or down at random, and chance decides which. Were the hash that of the texel alone, triangles
// would cover the same samples, and the mean would be the least of all t.
namespace gnomon::stochastic_map {

inline constexpr std::uint32_t most_samples = 64;

/// The last steps of MurmurHash3: bits that look random.
constexpr std::uint32_t mixed(std::uint32_t bits) {
  bits ^= bits >> 16;
  bits *= 0x85ebca6bu;
  bits ^= bits >> 13;
  bits *= 0xc2b2ae35u;
  return bits ^ bits >> 16;
}

/// Of a texel of an image (0 .. 5), of a triangle by its number in the scene, and of the seed.
constexpr std::uint32_t hash_of(std::uint32_t triangle, std::uint32_t column, std::uint32_t row, std::uint32_t image,
                                std::uint32_t seed) {
  return mixed(triangle ^ mixed(column ^ mixed(row ^ mixed(image ^ mixed(seed)))));
}

/// Place of an item among `count` when a key shuffles them (Kensler 2013): nearly a draw without replacement, but one that
/// needs no list.
constexpr std::uint32_t shuffled(std::uint32_t item, std::uint32_t count, std::uint32_t key) {
  std::uint32_t bits = count - 1;
  bits |= bits >> 1;
  bits |= bits >> 2;
  bits |= bits >> 4;
  do {
    item ^= key;
    item *= 0xe170893du;
    item ^= key >> 16;
    item ^= (item & bits) >> 4;
    item ^= key >> 8;
    item *= 0x0929eb3fu;
    item ^= key >> 23;
    item ^= (item & bits) >> 1;
    item *= 1u | key >> 27;
    item *= 0x6935fa69u;
    item ^= (item & bits) >> 11;
    item *= 0x74dcb303u;
    item ^= (item & bits) >> 2;
    item *= 0x9e501cc3u;
    item ^= (item & bits) >> 2;
    item *= 0xc860a3dfu;
    item &= bits;
    item ^= item >> 5;
  } while (item >= count);
  return (item + key) % count;
}

/// Whether a triangle covers a sample of 0 .. count - 1, count up to most_samples. In whole numbers of 2^-24: opaque (0) covers
/// all samples, and 1 none.
constexpr bool covers(std::uint32_t hash, float transmission, std::uint32_t sample, std::uint32_t count) {
  const float opacity = 1 - transmission;
  const auto covered = static_cast<std::uint32_t>(opacity * static_cast<float>(count) * 0x1p24f);
  return (shuffled(sample, count, hash) << 24) + (mixed(hash + 0x9e3779b9u) >> 8) < covered;
}

/// For shaders: `uint cover_hash(uint triangle, uvec2 texel, uint image, uint seed)` and
/// `bool covers(uint hash, float transmission, uint item, uint count)`.
inline constexpr std::string_view cover_snippet = R"(
uint cover_mixed(uint bits) {
  bits ^= bits >> 16u;
  bits *= 0x85ebca6bu;
  bits ^= bits >> 13u;
  bits *= 0xc2b2ae35u;
  return bits ^ bits >> 16u;
}
uint cover_hash(uint triangle, uvec2 texel, uint image, uint seed) {
  return cover_mixed(triangle ^ cover_mixed(texel.x ^ cover_mixed(texel.y ^ cover_mixed(image ^ cover_mixed(seed)))));
}
uint cover_shuffled(uint item, uint count, uint key) {
  uint bits = count - 1u;
  bits |= bits >> 1u;
  bits |= bits >> 2u;
  bits |= bits >> 4u;
  do {
    item ^= key;
    item *= 0xe170893du;
    item ^= key >> 16u;
    item ^= (item & bits) >> 4u;
    item ^= key >> 8u;
    item *= 0x0929eb3fu;
    item ^= key >> 23u;
    item ^= (item & bits) >> 1u;
    item *= 1u | key >> 27u;
    item *= 0x6935fa69u;
    item ^= (item & bits) >> 11u;
    item *= 0x74dcb303u;
    item ^= (item & bits) >> 2u;
    item *= 0x9e501cc3u;
    item ^= (item & bits) >> 2u;
    item *= 0xc860a3dfu;
    item &= bits;
    item ^= item >> 5u;
  } while (item >= count);
  return (item + key) % count;
}
bool covers(uint hash, float transmission, uint item, uint count) {
  precise float opacity = 1 - transmission;
  precise float covered = opacity * float(count) * 16777216.0;
  return (cover_shuffled(item, count, hash) << 24u) + (cover_mixed(hash + 0x9e3779b9u) >> 8u) < uint(covered);
}
)";

}  // namespace gnomon::stochastic_map
