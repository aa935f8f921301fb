// Mutants of bytes: bits flip, numbers become extreme, parts are dropped, repeated and taken from elsewhere.
#include <zlib.h>

#include <algorithm>
#include <cstring>
#include <limits>

#include "fuzz.h"

namespace fuzz {
namespace {

template <class T>
void put(std::string& bytes, std::size_t at, T value) {
  if (bytes.size() < sizeof value) return;
  std::memcpy(bytes.data() + std::min(at, bytes.size() - sizeof value), &value, sizeof value);
}

std::uint32_t big_endian(std::uint32_t x) { return __builtin_bswap32(x); }

void put_number(Random& random, std::string& bytes) {
  static constexpr std::uint64_t wholes[] = {0,
                                             1,
                                             2,
                                             3,
                                             127,
                                             128,
                                             255,
                                             256,
                                             0x7fff,
                                             0xffff,
                                             60000,
                                             0x7fffffff,
                                             0x80000000,
                                             0xffffffff,
                                             0x100000000,
                                             0x7fffffffffffffff,
                                             0x8000000000000000,
                                             0xffffffffffffffff};
  static constexpr double reals[] = {0,
                                     -1,
                                     1e-45,
                                     1e17,
                                     1e18,
                                     2e18,
                                     1e30,
                                     3e38,
                                     1e300,
                                     std::numeric_limits<double>::infinity(),
                                     -std::numeric_limits<double>::infinity(),
                                     std::numeric_limits<double>::quiet_NaN()};
  const std::size_t step = std::size_t{1} << random.below(4), at = random.below(bytes.size()) / step * step;
  const std::uint64_t whole = random.chance(0.2) ? bytes.size() + random.below(3) - 1 : random.pick(wholes);
  switch (random.below(7)) {
    case 0:
      return put(bytes, at, static_cast<std::uint8_t>(whole));
    case 1:
      return put(bytes, at, static_cast<std::uint16_t>(whole));
    case 2:
      return put(bytes, at, static_cast<std::uint32_t>(whole));
    case 3:
      return put(bytes, at, whole);
    case 4:
      return put(bytes, at, big_endian(static_cast<std::uint32_t>(whole)));
    case 5:
      return put(bytes, at, static_cast<float>(random.pick(reals)));
    default:
      return put(bytes, at, random.pick(reals));
  }
}

std::string mend_glb(std::string bytes) {
  std::uint32_t json = 0;
  if (bytes.size() < 20) return bytes;
  put(bytes, 8, static_cast<std::uint32_t>(bytes.size()));
  std::memcpy(&json, &bytes[12], sizeof json);
  const std::size_t end = std::min<std::size_t>(20 + std::size_t{json}, bytes.size());
  put(bytes, 12, static_cast<std::uint32_t>(end - 20));
  if (end + 8 <= bytes.size()) put(bytes, end, static_cast<std::uint32_t>(bytes.size() - end - 8));
  return bytes;
}

std::string mend_png(std::string bytes) {
  for (std::size_t at = 8; at + 12 <= bytes.size();) {
    std::uint32_t size = 0;
    std::memcpy(&size, &bytes[at], sizeof size);
    size = big_endian(size);
    if (size > bytes.size() - at - 12) break;
    const auto sum = crc32(0, reinterpret_cast<const Bytef*>(&bytes[at + 4]), size + 4);
    put(bytes, at + 8 + size, big_endian(static_cast<std::uint32_t>(sum)));
    at += 12 + std::size_t{size};
  }
  return bytes;
}

}  // namespace

std::string mend(const std::string& name, std::string bytes) {
  if (name.ends_with(".glb")) return mend_glb(std::move(bytes));
  if (name.ends_with(".png")) return mend_png(std::move(bytes));
  return bytes;
}

std::string mutate_binary(Random& random, const std::string& seed, const std::string& other) {
  std::string bytes = seed;
  do {
    if (bytes.empty()) return other;
    const std::size_t at = random.below(bytes.size()), size = 1 + random.below(std::min<std::size_t>(64, bytes.size() - at));
    switch (random.below(8)) {
      case 0:
        bytes[at] = static_cast<char>(bytes[at] ^ (1 << random.below(8)));
        break;
      case 1:
        bytes.erase(at, size);
        break;
      case 2:
        for (std::size_t k = 1 + random.below(random.chance(0.1) ? 500 : 3); k > 0; --k)
          bytes.insert(at, bytes.substr(at, size));
        break;
      case 3: {
        const std::size_t from = random.below(other.size() + 1);
        bytes.replace(at, size, other, from, size);
        break;
      }
      case 4:
        if (random.chance(0.3)) bytes.resize(at);
        break;
      case 5:
        bytes.insert(at, size, static_cast<char>(random.below(256)));
        break;
      default:
        put_number(random, bytes);
    }
  } while (random.chance(0.6) && bytes.size() < (1 << 17));
  return bytes;
}

}  // namespace fuzz
