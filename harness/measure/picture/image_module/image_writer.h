#pragma once
#include "measure/picture/picture.h"

namespace gnomon::image_module {

/// Each writes to a file that is under that name already; throws Error with the reason alone.
void write_png_file(const std::filesystem::path& path, const Picture& picture);
void write_exr_file(const std::filesystem::path& path, int width, int height, std::span<const std::string> names,
                    std::span<const std::span<const float>> channels);

/// See ImageFiles.
int draw_text(std::span<std::uint8_t> rgb, int width, int height, int x, int y, const std::string& words);

}  // namespace gnomon::image_module
