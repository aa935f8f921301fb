#pragma once
// Private to formats.
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace gnomon::importing {

/// 32 bits at `offset`, the lowest byte first; what lies beyond the end is 0.
inline std::uint32_t word_at(std::string_view bytes, std::size_t offset) {
  std::uint32_t word = 0;
  for (std::size_t k = 0; k < 4 && offset + k < bytes.size(); ++k)
    word |= static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[offset + k])) << (8 * k);
  return word;
}

}  // namespace gnomon::importing
