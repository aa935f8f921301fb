// Image files as other programs write them, byte by byte: PNG by the specification of 2003 (ISO/IEC 15948), EXR by "The OpenEXR
// File Layout", uncompressed.
#include <gnomon/error.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <array>
#include <bit>
#include <cmath>
#include <fstream>
#include <random>
#ifdef __SANITIZE_ADDRESS__
#include <sanitizer/lsan_interface.h>
#endif

#include "measure/picture/picture.h"
#include "measure/scratch_folder.h"

namespace image_formats_test {

using namespace gnomon;
namespace fs = std::filesystem;
using Bytes = std::string;

void save(const fs::path& path, const Bytes& bytes) { std::ofstream(path, std::ios::binary) << bytes; }

std::string refusal(const std::function<void()>& act) {
  try {
    act();
  } catch (const Error& error) {
    return error.what();
  }
  return "nothing was refused";
}

// --- PNG

Bytes big_endian(std::uint32_t value) {
  Bytes bytes;
  for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(value >> shift & 255);
  return bytes;
}

Bytes chunk(const Bytes& kind, const Bytes& data) {
  const Bytes body = kind + data;
  const auto crc = crc32(0, reinterpret_cast<const Bytef*>(body.data()), static_cast<uInt>(body.size()));
  return big_endian(static_cast<std::uint32_t>(data.size())) + body + big_endian(static_cast<std::uint32_t>(crc));
}

struct Png {
  int width, height, bits, type, channels;  // type: 0 gray, 2 RGB, 3 palette, 4 gray and alpha, 6 RGB and alpha
  bool is_interlaced = false;
  Bytes before_pixels;  // chunks
  std::vector<std::uint32_t> samples = std::vector<std::uint32_t>(static_cast<std::size_t>(width) * height * channels);

  std::uint32_t& sample(int x, int y, int c) {
    return samples[(static_cast<std::size_t>(y) * width + x) * channels + static_cast<std::size_t>(c)];
  }
  void fill(unsigned seed, std::uint32_t count) {
    std::mt19937 random(seed);
    for (std::uint32_t& s : samples) s = static_cast<std::uint32_t>(random() % count);
  }

  Bytes bytes() {
    struct Pass {
      int x0, y0, dx, dy;
    };
    std::vector<Pass> passes{{0, 0, 1, 1}};
    if (is_interlaced)
      passes = {{0, 0, 8, 8}, {4, 0, 8, 8}, {0, 4, 4, 8}, {2, 0, 4, 4}, {0, 2, 2, 4}, {1, 0, 2, 2}, {0, 1, 1, 2}};
    Bytes rows;
    for (const Pass& pass : passes) {
      if (pass.x0 >= width) continue;
      for (int y = pass.y0; y < height; y += pass.dy) {
        rows += '\0';  // no filter
        std::uint32_t packed = 0;
        int held = 0;
        const auto put = [&](std::uint32_t value, int bits_more) {
          packed = packed << bits_more | value;
          for (held += bits_more; held >= 8; held -= 8) rows += static_cast<char>(packed >> (held - 8) & 255);
        };
        for (int x = pass.x0; x < width; x += pass.dx)
          for (int c = 0; c < channels; ++c) put(sample(x, y, c), bits);
        if (held > 0) put(0, 8 - held);
      }
    }
    uLongf size = compressBound(static_cast<uLong>(rows.size()));
    Bytes packed(size, '\0');
    compress(reinterpret_cast<Bytef*>(packed.data()), &size, reinterpret_cast<const Bytef*>(rows.data()),
             static_cast<uLong>(rows.size()));
    packed.resize(size);
    const Bytes header = big_endian(static_cast<std::uint32_t>(width)) + big_endian(static_cast<std::uint32_t>(height)) +
                         Bytes{static_cast<char>(bits), static_cast<char>(type), 0, 0, static_cast<char>(is_interlaced)};
    return "\x89PNG\r\n\x1a\n" + chunk("IHDR", header) + before_pixels + chunk("IDAT", packed) + chunk("IEND", "");
  }
};

TEST(png, every_depth_and_kind_comes_as_shares_of_its_largest_value_interlaced_too) {
  const ScratchFolder folder = ScratchFolder::temporary("gnomon_png");
  const fs::path file = folder.path() / "mask.png";
  const std::array<std::vector<std::string>, 7> names{{{"Y"}, {}, {"R", "G", "B"}, {}, {"Y", "A"}, {}, {"R", "G", "B", "A"}}};
  for (const int type : {0, 2, 4, 6})
    for (const int bits : {1, 2, 4, 8, 16}) {
      if (type != 0 && bits < 8) continue;  // there are none
      for (const bool is_interlaced : {false, true})
        for (const auto& [width, height] : {std::pair(1, 1), std::pair(3, 2), std::pair(13, 9)}) {
          const auto& channels = names[type];
          Png png{width, height, bits, type, static_cast<int>(channels.size()), is_interlaced, {}};
          png.fill(static_cast<unsigned>(100 * type + bits), 1u << bits);
          save(file, png.bytes());
          const std::string what = fmt::format("type {}, {} bits, {}x{}, {}", type, bits, width, height, is_interlaced);
          ASSERT_EQ(image_files().exr_channels(file), channels) << what;
          for (int c = 0; c < static_cast<int>(channels.size()); ++c) {
            // Alpha, 0 in places, multiplies nothing.
            const std::vector<float> values = read_exr(file, channels[c], width, height);
            for (int y = 0; y < height; ++y)
              for (int x = 0; x < width; ++x)
                ASSERT_FLOAT_EQ(values[static_cast<std::size_t>(y) * width + x],
                                static_cast<float>(png.sample(x, y, c)) / static_cast<float>((1u << bits) - 1))
                    << what << " at " << x << ", " << y << " channel " << channels[c];
          }
        }
    }
}

TEST(png, a_palette_comes_as_its_colors_and_transparency_as_alpha) {
  const ScratchFolder folder = ScratchFolder::temporary("gnomon_png");
  const fs::path file = folder.path() / "mask.png";
  // Colors 255 0 51, 102 204 153, and a third without a value of its own in the transparency, which is opaque.
  const Bytes palette = chunk("PLTE", Bytes("\xff\x00\x33\x66\xcc\x99\x00\x00\x00", 9));
  for (const bool is_transparent : {false, true}) {
    Png png{3, 1, 2, 3, 1, false, palette + (is_transparent ? chunk("tRNS", Bytes("\x00\x80", 2)) : Bytes())};
    for (int x = 0; x < 3; ++x) png.sample(x, 0, 0) = static_cast<std::uint32_t>(x);
    save(file, png.bytes());
    EXPECT_EQ(image_files().exr_channels(file).size(), is_transparent ? 4u : 3u);
    EXPECT_EQ(read_exr(file, "R", 3, 1), (std::vector<float>{1, 0.4f, 0}));
    EXPECT_EQ(read_exr(file, "G", 3, 1), (std::vector<float>{0, 0.8f, 0}));
    EXPECT_EQ(read_exr(file, "B", 3, 1), (std::vector<float>{0.2f, 0.6f, 0}));
    if (is_transparent) {
      EXPECT_EQ(read_exr(file, "A", 3, 1), (std::vector<float>{0, 128 / 255.0f, 1}));
    }
  }
  // A gray that is declared transparent keeps its value.
  Png gray{2, 1, 8, 0, 1, false, chunk("tRNS", Bytes("\x00\xff", 2))};
  gray.sample(0, 0, 0) = 255;
  save(file, gray.bytes());
  EXPECT_EQ(read_exr(file, "Y", 2, 1), (std::vector<float>{1, 0}));
  EXPECT_EQ(read_exr(file, "A", 2, 1), (std::vector<float>{0, 1}));
}

TEST(png, what_is_cut_off_or_spoiled_is_refused_at_every_byte) {
  const ScratchFolder folder = ScratchFolder::temporary("gnomon_png");
  const fs::path file = folder.path() / "mask.png";
  for (const bool is_interlaced : {false, true}) {
    Png png{9, 5, 8, 0, 1, is_interlaced, {}};
    png.fill(7, 256);
    const Bytes whole = png.bytes();
    const std::size_t pixels_end = whole.find("IEND") - 4;
    for (std::size_t length = 1; length + 12 < pixels_end; ++length) {
      save(file, whole.substr(0, length));
      ASSERT_THROW(read_exr(file, "Y", 9, 5), Error) << length;
    }
    for (std::size_t k = 8; k < pixels_end; ++k) {  // every chunk has a sum
      Bytes spoiled = whole;
      spoiled[k] = static_cast<char>(spoiled[k] ^ 0x10);
      save(file, spoiled);
      ASSERT_THROW(read_exr(file, "Y", 9, 5), Error) << k;
    }
  }
  // 16,384 x 16,384 of 8 bytes are declared, and a kilobyte is there.
  Png large{1, 1, 16, 6, 4, true, {}};
  const Bytes one = large.bytes();
  const Bytes header = big_endian(16384) + big_endian(16384) + Bytes{16, 6, 0, 0, 1};
  save(file, one.substr(0, 8) + chunk("IHDR", header) + one.substr(8 + 25) + Bytes(4000, 'x'));
  EXPECT_NE(refusal([&] { read_exr(file, "Y", 16384, 16384); }).find("has no channel Y"), std::string::npos);
  EXPECT_NE(refusal([&] { read_exr(file, "R", 16384, 16384); }).find("cannot be read"), std::string::npos);
  save(file, one.substr(0, 8) + chunk("IHDR", big_endian(16385) + big_endian(1) + Bytes{8, 0, 0, 0, 0}) + one.substr(8 + 25));
  EXPECT_NE(refusal([&] { image_files().exr_size(file); }).find("is 16385x1; sides are 1 .. 16384 pixels"), std::string::npos);
}

// --- EXR

template <class Value>
Bytes raw(const Value& value) {
  return Bytes(reinterpret_cast<const char*>(&value), sizeof value);
}

struct Window {
  std::int32_t x0, y0, x1, y1;
};

Bytes attribute(const Bytes& name, const Bytes& type, const Bytes& value) {
  return name + '\0' + type + '\0' + raw(static_cast<std::int32_t>(value.size())) + value;
}

/// Channels of 32-bit floats; pixel (x, y) of channel c holds value(x, y, c).
Bytes exr(const Window& data, const Window& shown, const std::vector<std::string>& channels,
          const std::function<float(int x, int y, int c)>& value, int sampling = 1) {
  Bytes list;
  for (const std::string& name : channels)
    list += name + '\0' + raw(std::int32_t{2}) + Bytes(4, '\0') + raw(std::int32_t{sampling}) + raw(std::int32_t{sampling});
  list += '\0';
  const Bytes head = Bytes("\x76\x2f\x31\x01\x02\0\0\0", 8) + attribute("channels", "chlist", list) +
                     attribute("compression", "compression", Bytes(1, '\0')) + attribute("dataWindow", "box2i", raw(data)) +
                     attribute("displayWindow", "box2i", raw(shown)) + attribute("lineOrder", "lineOrder", Bytes(1, '\0')) +
                     attribute("pixelAspectRatio", "float", raw(1.0f)) +
                     attribute("screenWindowCenter", "v2f", Bytes(8, '\0')) +
                     attribute("screenWindowWidth", "float", raw(1.0f)) + '\0';
  Bytes offsets, rows;
  const std::size_t first = head.size() + 8 * static_cast<std::size_t>(data.y1 - data.y0 + 1);
  for (int y = data.y0; y <= data.y1; ++y) {
    offsets += raw(static_cast<std::uint64_t>(first + rows.size()));
    Bytes row;
    for (int c = 0; c < static_cast<int>(channels.size()); ++c)
      if (y % sampling == 0)
        for (int x = data.x0; x <= data.x1; ++x)
          if (x % sampling == 0) row += raw(value(x, y, c));
    rows += raw(std::int32_t{y}) + raw(static_cast<std::int32_t>(row.size())) + row;
  }
  return head + offsets + rows;
}

float place(int x, int y, int c) { return static_cast<float>(100 * x + y) + 0.25f * static_cast<float>(c); }

TEST(exr, a_picture_is_what_the_display_window_shows) {
  const ScratchFolder folder = ScratchFolder::temporary("gnomon_exr");
  const fs::path file = folder.path() / "mask.exr";
  const Window shown{-2, 5, 7, 9};
  for (const Window& data : {shown, Window{-2, 5, 9, 9}, Window{-7, 0, 7, 9}, Window{-10, -20, 20, 300}}) {
    save(file, exr(data, shown, {"B", "G", "R"}, place));
    ASSERT_EQ(image_files().exr_size(file), std::pair(10, 5));
    EXPECT_EQ(image_files().exr_channels(file), (std::vector<std::string>{"R", "G", "B"}));
    const std::vector<float> green = read_exr(file, "G", 10, 5);
    for (int y = 0; y < 5; ++y)
      for (int x = 0; x < 10; ++x)
        ASSERT_EQ(green[static_cast<std::size_t>(10 * y + x)], place(x - 2, y + 5, 1)) << x << ' ' << y;
  }
  for (const Window& data :
       {Window{-1, 5, 7, 9}, Window{-2, 6, 7, 9}, Window{-2, 5, 6, 9}, Window{-2, 5, 7, 8}, Window{0, 0, 3, 3}}) {
    save(file, exr(data, shown, {"Y"}, place));
    EXPECT_NE(refusal([&] { image_files().exr_size(file); }).find("which is not all of the display window (-2, 5) .. (7, 9)"),
              std::string::npos)
        << refusal([&] { image_files().exr_size(file); });
  }
}

TEST(exr, channels_are_listed_layer_by_layer_in_the_order_that_people_say) {
  const ScratchFolder folder = ScratchFolder::temporary("gnomon_exr");
  const fs::path file = folder.path() / "mask.exr";
  const Window window{0, 0, 1, 1};
  save(file, exr(window, window, {"A", "B", "G", "R", "Z"}, place));
  EXPECT_EQ(image_files().exr_channels(file), (std::vector<std::string>{"R", "G", "B", "A", "Z"}));
  save(file, exr(window, window, {"A", "Y"}, place));
  EXPECT_EQ(image_files().exr_channels(file), (std::vector<std::string>{"Y", "A"}));
  save(file, exr(window, window, {"lamp.B", "lamp.G", "lamp.R", "sun.V"}, place));
  EXPECT_EQ(image_files().exr_channels(file), (std::vector<std::string>{"lamp.R", "lamp.G", "lamp.B", "sun.V"}));
}

TEST(exr, what_is_cut_off_or_sampled_less_is_refused) {
  const ScratchFolder folder = ScratchFolder::temporary("gnomon_exr");
  const fs::path file = folder.path() / "mask.exr";
  const Window window{0, 0, 3, 3};
  const Bytes whole = exr(window, window, {"Y"}, place);
  for (std::size_t length = 1; length < whole.size(); ++length) {
    save(file, whole.substr(0, length));
    ASSERT_THROW(read_exr(file, "Y", 4, 4), Error) << length;
  }
  save(file, exr(window, window, {"Y"}, place, 2));
  EXPECT_NE(refusal([&] { read_exr(file, "Y", 4, 4); }).find("channel Y has a sample for each 2 x 2 pixels"),
            std::string::npos);
  // Windows as wide as numbers go.
  const Window widest{std::numeric_limits<std::int32_t>::min() / 2 + 1, 0, std::numeric_limits<std::int32_t>::max() / 2 - 1, 0};
  for (const auto& [data, shown] : {std::pair(widest, widest), std::pair(widest, window), std::pair(window, widest)}) {
    Bytes head = exr(window, window, {"Y"}, place);
    head.replace(head.find(attribute("dataWindow", "box2i", raw(window))) + 21, 16, raw(data));
    head.replace(head.find(attribute("displayWindow", "box2i", raw(window))) + 24, 16, raw(shown));
    save(file, head);
    EXPECT_THROW(image_files().exr_size(file), Error);
  }
  // Memory would be taken for rows of what is not shown.
  Bytes wide = exr(window, window, {"Y"}, place);
  wide.replace(wide.find(attribute("dataWindow", "box2i", raw(window))) + 21, 16, raw(Window{0, 0, 1 << 18, 3}));
  save(file, wide);
  EXPECT_NE(refusal([&] { image_files().exr_size(file); }).find("sides are 1 .. 16384 pixels"), std::string::npos)
      << refusal([&] { image_files().exr_size(file); });
}

TEST(other_formats, are_read_as_they_are) {
  const ScratchFolder folder = ScratchFolder::temporary("gnomon_formats");
  save(folder.path() / "mask.pgm", Bytes("P5\n3 2\n255\n\x00\x33\x66\x99\xcc\xff", 17));
  const std::vector<float> values =
      read_exr(folder.path() / "mask.pgm", image_files().exr_channels(folder.path() / "mask.pgm")[0], 3, 2);
  for (int k = 0; k < 6; ++k) EXPECT_FLOAT_EQ(values[static_cast<std::size_t>(k)], 0.2f * static_cast<float>(k));
  save(folder.path() / "mask.png", "P5\n3 2\n255\nabcdef");  // what it is, not what it is called
  EXPECT_EQ(image_files().exr_size(folder.path() / "mask.png"), std::pair(3, 2));
  save(folder.path() / "words.png", "no picture");
  EXPECT_NE(refusal([&] { image_files().exr_size(folder.path() / "words.png"); }).find("words.png cannot be read"),
            std::string::npos);
#ifdef __SANITIZE_ADDRESS__
  // A library of OpenImageIO's has threads from when it is loaded until the process ends, and threads that end while it looks
  // for leaks bring the sanitizer down. It looks once: now, while they wait.
  __lsan_do_leak_check();
#endif
}

}  // namespace image_formats_test
