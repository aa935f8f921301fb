#pragma once
#include "measure/images/image_files.h"

namespace gnomon::image_module {

/// Of a picture that can be scored.
inline constexpr int most_side = 16384;

/// An image file whose header has been read. Where its size says more than `most_side`, nothing else of it has.
class ImageReader {
 public:
  ImageReader() = default;
  ImageReader(const ImageReader&) = delete;
  virtual ~ImageReader() = default;

  /// One channel, row-major from the top left, as the file has it: neither linear where it is sRGB nor multiplied by alpha.
  /// Whole numbers come as shares of the largest that their bits hold. Once for each reader. Throws Error with the reason
  /// alone.
  virtual std::vector<float> read(std::size_t channel) = 0;

  int width = 0, height = 0;
  std::vector<std::string> channels;  ///< names; R, G, B, A or Y, A come first
  std::string legend_rows;            ///< how many rows at the bottom hold a legend; empty: none
};

/// What a PNG says of itself when rows at its bottom hold a legend.
inline constexpr const char* legend_rows = "gnomon legend rows";

/// Of each format; throw Error with the reason alone. Files may be hostile: memory is taken for what they hold, not for what
/// they declare.
std::unique_ptr<ImageReader> open_png(const std::filesystem::path& path);
std::unique_ptr<ImageReader> open_exr(const std::filesystem::path& path);

/// Each writes to a file that is under that name already; throws Error with the reason alone.
void write_png_file(const std::filesystem::path& path, const Picture& picture);
void write_gray_png_file(const std::filesystem::path& path, int width, int height, std::span<const std::uint8_t> values,
                         bool has_alpha);
void write_exr_file(const std::filesystem::path& path, int width, int height, std::span<const std::string> names,
                    std::span<const std::span<const float>> channels);

/// See ImageFiles.
int draw_text(std::span<std::uint8_t> rgb, int width, int height, int x, int y, const std::string& words);

}  // namespace gnomon::image_module

/// Any other format, in a module of its own: see ImageFiles. The caller deletes it.
extern "C" gnomon::image_module::ImageReader* gnomon_open_other_image(const char* path);
