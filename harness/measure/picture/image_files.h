#pragma once
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace gnomon {

/// What needs OpenImageIO, in a module that is loaded at the first use: it brings some 250 libraries along, and starting them
/// costs a process 0.2 s, which a worker that never touches a picture should not pay. picture.h says what each call does.
struct ImageFiles {
  void (*write_png)(const std::filesystem::path& path, int width, int height, std::span<const std::uint8_t> rgb);
  void (*write_exr)(const std::filesystem::path& path, int width, int height, std::span<const std::string> names,
                    std::span<const std::span<const float>> channels);
  std::vector<float> (*read_exr)(const std::filesystem::path& path, const std::string& channel, int width, int height);
  /// Names of the channels of an EXR. Throws Error.
  std::vector<std::string> (*exr_channels)(const std::filesystem::path& path);
  /// Width and height in pixels of an image file. Throws Error.
  std::pair<int, int> (*exr_size)(const std::filesystem::path& path);
  /// Draws a line of dark text with its baseline at (x, y) and returns its width in pixels; on an empty picture, only that.
  int (*draw_text)(std::span<std::uint8_t> rgb, int width, int height, int x, int y, const std::string& words);
};

/// Throws Error when the module cannot be loaded.
const ImageFiles& image_files();

}  // namespace gnomon
