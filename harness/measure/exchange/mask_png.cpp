#include "measure/exchange/mask_png.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <string_view>

namespace gnomon {

namespace {

using Bytes = std::vector<std::uint8_t>;

/// The most significant byte first, as all numbers of the format are.
void put(Bytes& bytes, std::uint32_t number) {
  for (int shift = 24; shift >= 0; shift -= 8) bytes.push_back(static_cast<std::uint8_t>(number >> shift));
}

/// CRC-32 of ISO 3309, bit by bit reversed: polynomial 0xedb88320.
std::uint32_t crc(std::span<const std::uint8_t> bytes) {
  static const std::array<std::uint32_t, 256> of_byte = [] {
    std::array<std::uint32_t, 256> table{};
    for (std::uint32_t n = 0; n < 256; ++n) {
      std::uint32_t c = n;
      for (int k = 0; k < 8; ++k) c = (c >> 1) ^ (c & 1 ? 0xedb88320u : 0u);
      table[n] = c;
    }
    return table;
  }();
  std::uint32_t c = ~0u;
  for (const std::uint8_t byte : bytes) c = of_byte[(c ^ byte) & 255] ^ (c >> 8);
  return ~c;
}

/// Length of the data, kind, data, CRC of kind and data.
void put_chunk(Bytes& png, std::string_view kind, const Bytes& data) {
  put(png, static_cast<std::uint32_t>(data.size()));
  const std::size_t begin = png.size();
  png.insert(png.end(), kind.begin(), kind.end());
  png.insert(png.end(), data.begin(), data.end());
  put(png, crc(std::span(png).subspan(begin)));
}

/// A zlib stream of blocks that are stored as they are, then the Adler-32 of the bytes.
Bytes stored(std::span<const std::uint8_t> bytes) {
  constexpr std::size_t most = 65535;  // of a block
  Bytes stream = {0x78, 0x01};
  std::uint32_t a = 1, b = 0;
  for (std::size_t first = 0; first < bytes.size(); first += most) {
    const auto block = bytes.subspan(first, std::min(most, bytes.size() - first));
    const auto size = static_cast<std::uint32_t>(block.size());
    stream.push_back(first + most >= bytes.size());  // whether it is the last one
    for (const std::uint32_t part : {size, size >> 8, ~size, ~size >> 8}) stream.push_back(static_cast<std::uint8_t>(part));
    stream.insert(stream.end(), block.begin(), block.end());
    for (const std::uint8_t byte : block) {
      a = (a + byte) % 65521;
      b = (b + a) % 65521;
    }
  }
  put(stream, b << 16 | a);
  return stream;
}

}  // namespace

std::vector<std::byte> png_of(int width, int height, int channels, std::span<const std::uint8_t> texels) {
  assert(channels >= 1 && channels <= 4 && texels.size() == std::size_t(width) * height * channels);
  constexpr std::uint8_t kinds[] = {0, 4, 2, 6};  // gray, gray with alpha, color, color with alpha
  Bytes header;
  put(header, static_cast<std::uint32_t>(width));
  put(header, static_cast<std::uint32_t>(height));
  for (const std::uint8_t fact : {std::uint8_t{8}, kinds[channels - 1], std::uint8_t{0}, std::uint8_t{0}, std::uint8_t{0}})
    header.push_back(fact);  // bits, kind, no choice, not interlaced
  Bytes rows;
  const std::size_t row = std::size_t(width) * channels;
  rows.reserve((row + 1) * height);
  for (std::size_t y = 0; y < std::size_t(height); ++y) {
    rows.push_back(0);  // no filter
    const auto bytes = texels.subspan(y * row, row);
    rows.insert(rows.end(), bytes.begin(), bytes.end());
  }
  Bytes png = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
  put_chunk(png, "IHDR", header);
  put_chunk(png, "IDAT", stored(rows));
  put_chunk(png, "IEND", {});
  const auto bytes = std::as_bytes(std::span(png));
  return {bytes.begin(), bytes.end()};
}

std::vector<std::byte> mask_png(const AlphaMask& mask) {
  Bytes texels;
  texels.reserve(2 * std::size_t(mask.width()) * mask.height());
  for (int y = 0; y < mask.height(); ++y)
    for (int x = 0; x < mask.width(); ++x) {
      texels.push_back(255);
      texels.push_back(mask.is_solid(x, y) ? 255 : 0);
    }
  return png_of(mask.width(), mask.height(), 2, texels);
}

}  // namespace gnomon
