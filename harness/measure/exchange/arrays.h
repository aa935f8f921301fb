#pragma once
#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <span>
#include <vector>

#include "measure/json.h"

namespace gnomon {

/// An array of numbers as a file: format NPY 1.0, little-endian, row-major, so that numpy opens it by its name alone. Its
/// numbers begin at byte `array_offset` of every file written here.
inline constexpr std::size_t array_offset = 128;

/// Numbers in memory, one type throughout; parts follow each other in the file.
struct ArrayParts {
  std::string_view type;  ///< "float32" or "uint32"
  std::vector<std::size_t> shape;
  std::vector<std::span<const std::byte>> parts;
};
template <class Number>
ArrayParts array_of(std::vector<std::size_t> shape, std::initializer_list<std::span<const Number>> parts) {
  static_assert(std::is_same_v<Number, float> || std::is_same_v<Number, std::uint32_t>);
  ArrayParts array{std::is_same_v<Number, float> ? "float32" : "uint32", std::move(shape), {}};
  for (const auto& part : parts) array.parts.push_back(std::as_bytes(part));
  return array;
}

/// Writes it, as a new file where there is one of that name, and returns {"file", "type", "shape", "offset"}, the file by its
/// whole path. Throws Error when the parts do not fill the shape, or the file cannot be written.
Json write_array(const std::filesystem::path& file, const ArrayParts& array);

/// 64-bit hash of shape and numbers, by which a caller recognizes a file that already contains them.
std::uint64_t hash_of(const ArrayParts& array);

}  // namespace gnomon
