#include "report/site/pictures.h"

#include <algorithm>
#include <array>
#include <fstream>

#include "measure/part_file.h"
#include "measure/picture/picture.h"
#include "measure/printable.h"
#include "measure/scene/blob.h"

namespace gnomon::site {

namespace fs = std::filesystem;

namespace {

/// All pictures of a site: less than the 30 MB that it may be sent with.
constexpr std::uintmax_t most_bytes = 4'000'000;

/// Width and height as the header of a PNG has them; nothing of another file.
std::optional<std::pair<int, int>> png_size(const fs::path& file) {
  std::array<char, 24> head{};
  std::ifstream stream(file, std::ios::binary);
  if (!stream.read(head.data(), head.size()) || std::string_view(head.data() + 1, 3) != "PNG") return std::nullopt;
  const auto number = [&](std::size_t at) {
    std::uint32_t value = 0;
    for (std::size_t k = 0; k < 4; ++k) value = value << 8 | static_cast<unsigned char>(head[at + k]);
    return static_cast<int>(std::min<std::uint32_t>(value, 1 << 20));
  };
  return std::pair(number(16), number(20));
}

std::uint8_t byte_of(float share) { return static_cast<std::uint8_t>(std::clamp(share, 0.0f, 1.0f) * 255 + 0.5f); }

/// In steps of 8 of 255: finer shades make files larger, and eyes do not need them.
Picture in_few_colors(Picture picture) {
  for (std::uint8_t& value : picture.rgb) value = static_cast<std::uint8_t>(std::min(255, (value + 4) / 8 * 8));
  return picture;
}

}  // namespace

std::optional<fs::path> file_of(const fs::path& dir, const std::optional<std::string>& name) {
  if (!name) return std::nullopt;
  const fs::path path = fs::path(*name).lexically_normal();
  if (path.empty() || path.is_absolute() || *path.begin() == "..") return std::nullopt;
  fs::path file = dir;
  for (const fs::path& part : path) {
    file /= part;
    if (fs::is_symlink(fs::symlink_status(file))) return std::nullopt;
  }
  return is_plain_file(file) ? std::optional(file) : std::nullopt;
}

Picture made_small(const Picture& picture, int width) {
  if (picture.width <= width) return picture;
  const int height = std::max(1, static_cast<int>(static_cast<std::int64_t>(picture.height) * width / picture.width));
  Picture small{.width = width, .height = height, .rgb = {}};
  small.rgb.reserve(3 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  const auto first = [](int at, int from, int to) { return static_cast<int>(static_cast<std::int64_t>(at) * from / to); };
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const int left = first(x, picture.width, width), right = std::max(left + 1, first(x + 1, picture.width, width));
      const int top = first(y, picture.height, height), bottom = std::max(top + 1, first(y + 1, picture.height, height));
      for (std::size_t channel = 0; channel < 3; ++channel) {
        unsigned sum = 0;
        for (int v = top; v < bottom; ++v)
          for (int u = left; u < right; ++u)
            sum += picture.rgb[3 * (static_cast<std::size_t>(v) * static_cast<std::size_t>(picture.width) +
                                    static_cast<std::size_t>(u)) +
                               channel];
        const auto count = static_cast<unsigned>((right - left) * (bottom - top));
        small.rgb.push_back(static_cast<std::uint8_t>((sum + count / 2) / count));
      }
    }
  return small;
}

Pictures::Pictures(Folder& folder, std::size_t row_count)
    : folder_(folder),
      width_(row_count <= 500    ? 320
             : row_count <= 2000 ? 240
                                 : 160) {}

const RowPictures& Pictures::of(const Record& record, const fs::path& dir) {
  const auto [found, is_new] = rows_.try_emplace(&record);
  if (is_new && record.status == Status::ok) found->second = {add_mask(record, dir), add_error(record, dir)};
  return found->second;
}

std::string Pictures::add_mask(const Record& record, const fs::path& dir) {
  const std::optional<fs::path> file = file_of(dir, record.mask);
  const std::vector<std::string> lights = light_names(record);
  if (!file || lights.empty()) return "";
  try {
    const std::vector<float> values = read_exr(*file, lights.front() + ".V", record.width, record.height);
    return keep(draw_mask(values, record.width, record.height));
  } catch (const Error& error) {
    folder_.notes.push_back(fmt::format("no picture: {}", printable(error.what(), true)));
    return "";
  }
}

std::string Pictures::add_error(const Record& record, const fs::path& dir) {
  const std::optional<fs::path> file = file_of(dir, record.error_picture);
  if (!file) return "";
  try {
    const auto size = png_size(*file);
    if (!size || size->first != record.width || size->second < record.height)
      throw Error("{} is no PNG of {} pixels across", file->string(), record.width);
    const auto pixels = static_cast<std::size_t>(record.width) * static_cast<std::size_t>(record.height);
    Picture picture{.width = record.width, .height = record.height, .rgb = {}};
    picture.rgb.resize(3 * pixels);
    constexpr const char* names[] = {"R", "G", "B"};
    for (std::size_t channel = 0; channel < 3; ++channel) {
      const std::vector<float> values = read_exr(*file, names[channel], size->first, size->second);
      for (std::size_t k = 0; k < pixels; ++k) picture.rgb[3 * k + channel] = byte_of(values[k]);  // its legend is below
    }
    return keep(picture);
  } catch (const Error& error) {
    folder_.notes.push_back(fmt::format("no picture: {}", printable(error.what(), true)));
    return "";
  }
}

std::string Pictures::keep(const Picture& whole) {
  const Picture picture = in_few_colors(made_small(whole, width_));
  const std::string hash = content_hash(std::string(picture.rgb.begin(), picture.rgb.end()));
  const std::string path = fmt::format("pictures/{}.png", hash.substr(0, 20));
  if (fs::exists(folder_.stage() / path)) return path;
  if (bytes_ > most_bytes) {
    if (!std::exchange(is_full_, true))
      folder_.notes.push_back(fmt::format("pictures: the first {} MB of them are in the site", most_bytes / 1'000'000));
    return "";
  }
  write_png(folder_.stage() / path, picture);
  bytes_ += fs::file_size(folder_.stage() / path);
  return path;
}

}  // namespace gnomon::site
