#pragma once
#include <gnomon/error.h>

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace gnomon {

/// 8-bit sRGB picture, row-major from the top left.
struct Picture {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgb;
  int legend_height = 0;  ///< rows at the bottom that hold a legend; files say so, and `exr_size` refuses them as masks
};

/// What needs libraries of pictures, in a module that is loaded at the first use. Files are PNG or EXR by their first bytes;
/// any other format is read by OpenImageIO, in a module of its own: it brings some 250 libraries along. The functions below say
/// what each call does.
struct ImageFiles {
  void (*write_png)(const std::filesystem::path& path, const Picture& picture);
  /// 8 bits of gray a pixel, as they are; with alpha two bytes a pixel.
  void (*write_gray_png)(const std::filesystem::path& path, int width, int height, std::span<const std::uint8_t> values,
                         bool has_alpha);
  void (*write_exr)(const std::filesystem::path& path, int width, int height, std::span<const std::string> names,
                    std::span<const std::span<const float>> channels);
  std::vector<float> (*read_exr)(const std::filesystem::path& path, const std::string& channel, int width, int height);
  /// Names of the channels of an EXR. Throws Error.
  std::vector<std::string> (*exr_channels)(const std::filesystem::path& path);
  /// Width and height in pixels of an image file that may hold a mask. Throws Error, also where a legend is below the
  /// picture: then it has other rows than the view that it was made of.
  std::pair<int, int> (*exr_size)(const std::filesystem::path& path);
  /// Draws a line of dark text with its baseline at (x, y) and returns its width in pixels; on an empty picture, only that.
  int (*draw_text)(std::span<std::uint8_t> rgb, int width, int height, int x, int y, const std::string& words);
};

/// Throws Error when the module cannot be loaded.
const ImageFiles& image_files();

/// Reads one channel of an EXR. Throws Error.
std::vector<float> read_exr(const std::filesystem::path& path, const std::string& channel, int width, int height);

}  // namespace gnomon
