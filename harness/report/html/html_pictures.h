#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "measure/record/record.h"
#include "report/table/layout.h"

namespace gnomon {

/// Pictures for the image comparer: base64 of deflated bytes, each read by the page when it is first shown.
struct PictureSet {
  std::vector<std::string> blobs;
  /// By group of the layout: null, or {lit, dark, reference, classes} with numbers of blobs. `lit` and `dark` are the shaded
  /// colors with all and without any direct light: red, green and blue planes, each byte less its left neighbor modulo 256.
  /// The others are one byte a pixel: 255 times the mask, index of PixelClass.
  Json groups = Json::array();
  /// By row in the layout's order: null, or {mask, causes}; causes is null or one byte a pixel, index of Cause.
  Json rows = Json::array();
  std::vector<std::string> notes;  ///< which groups and rows have none, and why
};

/// Masks come from the run's folder `dir`, the rest from the frame cache, made anew where it is not there. A scene that is not
/// the one measured is left out.
PictureSet collect_pictures(const std::filesystem::path& dir, const Layout& layout);

/// zlib format, then base64.
std::string packed(std::span<const std::uint8_t> bytes);

}  // namespace gnomon
