#include <gnomon/kit/weld.h>

#include <array>
#include <bit>

namespace gnomon {

namespace {

std::array<std::uint32_t, 3> bits(const glm::vec3& p) {
  const glm::vec3 q = p + 0.0f;  // minus zero becomes zero
  return {std::bit_cast<std::uint32_t>(q.x), std::bit_cast<std::uint32_t>(q.y), std::bit_cast<std::uint32_t>(q.z)};
}

}  // namespace

// Open addressing.
std::vector<std::uint32_t> weld(std::span<const glm::vec3> positions, std::span<const std::uint8_t> wanted) {
  constexpr std::uint32_t empty = 0xffffffffu;
  std::vector<std::uint32_t> first(positions.size());
  std::vector<std::uint32_t> table(std::bit_ceil(2 * positions.size() + 1), empty);
  for (std::uint32_t v = 0; v < positions.size(); ++v) {
    first[v] = v;
    if (!wanted.empty() && !wanted[v]) continue;
    const auto b = bits(positions[v]);
    std::uint64_t hash = b[0] * 0x9e3779b97f4a7c15ull ^ b[1] * 0xc2b2ae3d27d4eb4full ^ b[2] * 0x165667b19e3779f9ull;
    hash ^= hash >> 29;
    hash *= 0xbf58476d1ce4e5b9ull;
    hash ^= hash >> 32;
    for (std::size_t place = hash & (table.size() - 1);; place = (place + 1) & (table.size() - 1)) {
      if (table[place] == empty) {
        table[place] = v;
        break;
      }
      if (positions[table[place]] == positions[v]) {
        first[v] = table[place];
        break;
      }
    }
  }
  return first;
}

}  // namespace gnomon
