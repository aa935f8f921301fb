// The image module: what ImageFiles offers, by the format of each file.
#include <dlfcn.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <functional>

#include "measure/images/module/image_formats.h"

namespace gnomon::image_module {

namespace fs = std::filesystem;

/// An image file under a temporary name that becomes the real one only when it is whole. The caller has called make_way.
void write_image(const fs::path& path, const std::function<void(const fs::path&)>& write) {
  std::error_code code;
  if (path.has_parent_path()) fs::create_directories(path.parent_path(), code);
  if (code) throw Error("folder {} cannot be made: {}", path.parent_path().string(), code.message());
  const fs::path temporary = path.parent_path() / fmt::format(".{}.part{}", getpid(), path.extension().string());
  try {
    write(temporary);
    fs::rename(temporary, path);
  } catch (const std::exception& error) {
    fs::remove(temporary, code);
    throw Error("{} cannot be written: {}", path.string(), error.what());
  }
}

void write_png(const fs::path& path, const Picture& picture) {
  write_image(path, [&](const fs::path& file) { write_png_file(file, picture); });
}

void write_gray_png(const fs::path& path, int width, int height, std::span<const std::uint8_t> values, bool has_alpha) {
  write_image(path, [&](const fs::path& file) { write_gray_png_file(file, width, height, values, has_alpha); });
}

void write_exr(const fs::path& path, int width, int height, std::span<const std::string> names,
               std::span<const std::span<const float>> channels) {
  write_image(path, [&](const fs::path& file) { write_exr_file(file, width, height, names, channels); });
}

std::unique_ptr<ImageReader> open_other(const fs::path& path) {
  static const auto open = [] {
    void* const module = dlopen("libgnomon_image_formats.so", RTLD_NOW | RTLD_LOCAL);
    if (!module) throw Error("the module of image formats cannot be loaded: {}", dlerror());
    return reinterpret_cast<decltype(&gnomon_open_other_image)>(dlsym(module, "gnomon_open_other_image"));
  }();
  return std::unique_ptr<ImageReader>(open(path.c_str()));
}

/// By the first bytes, whatever the name says.
std::unique_ptr<ImageReader> open_by_format(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw Error("{}", std::strerror(errno));
  std::array<char, 8> head{};
  file.read(head.data(), head.size());
  if (std::memcmp(head.data(), "\x89PNG\r\n\x1a\n", 8) == 0) return open_png(path);
  if (std::memcmp(head.data(), "\x76\x2f\x31\x01", 4) == 0) return open_exr(path);
  return open_other(path);
}

/// What `read` returns; its reason not to with the file's name.
template <class Read>
auto read_from(const fs::path& path, const Read& read) try {
  return read();
} catch (const std::exception& error) {
  throw Error("{} cannot be read: {}", path.string(), error.what());
}

/// A picture from outside, of a size that can be scored, and of which there are bytes enough that it may be whole.
std::unique_ptr<ImageReader> open_image(const fs::path& path) {
  constexpr std::uint64_t most_pixels_per_byte = 100'000;  // of one color throughout, compressed by the best that there is
  if (!fs::exists(path)) throw Error("{} cannot be read: there is no such file", path.string());
  if (!fs::is_regular_file(path)) throw Error("{} cannot be read: it is not a file", path.string());
  std::unique_ptr<ImageReader> input = read_from(path, [&] { return open_by_format(path); });
  const int width = input->width, height = input->height;
  if (std::min(width, height) < 1 || std::max(width, height) > most_side)
    throw Error("{} is {}x{}; sides are 1 .. {} pixels", path.string(), width, height, most_side);
  const std::uint64_t pixels = static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height);
  if (pixels > most_pixels_per_byte * fs::file_size(path))
    throw Error("{} declares {}x{} pixels in {} bytes; it is truncated", path.string(), width, height, fs::file_size(path));
  return input;
}

std::vector<float> read_exr(const fs::path& path, const std::string& channel, int width, int height) {
  const auto input = open_image(path);
  if (input->width != width || input->height != height)
    throw Error("{} is {}x{}; {}x{} is wanted", path.string(), input->width, input->height, width, height);
  const auto found = std::ranges::find(input->channels, channel);
  if (found == input->channels.end())
    throw Error("{} has no channel {}; it has: {}", path.string(), channel, joined(input->channels));
  return read_from(path, [&] { return input->read(static_cast<std::size_t>(found - input->channels.begin())); });
}

std::vector<std::string> exr_channels(const fs::path& path) { return open_image(path)->channels; }

std::pair<int, int> exr_size(const fs::path& path) {
  const auto input = open_image(path);
  if (!input->legend_rows.empty())
    throw Error("{} is a picture with a legend of {} rows below it; a mask without one is required, as in mask.exr",
                path.string(), input->legend_rows);
  return {input->width, input->height};
}

}  // namespace gnomon::image_module

extern "C" const gnomon::ImageFiles gnomon_image_files;
namespace images = gnomon::image_module;
const gnomon::ImageFiles gnomon_image_files{images::write_png,    images::write_gray_png, images::write_exr, images::read_exr,
                                            images::exr_channels, images::exr_size,       images::draw_text};
