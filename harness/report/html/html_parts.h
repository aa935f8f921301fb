#pragma once
#include <filesystem>

#include "report/table/layout.h"

namespace gnomon {

// What the page of a run is put together from: template, numbers, pictures.

/// The page without its data, made from harness/report/html/web by the build: it holds each slot once. Empty when the program
/// was built without it (GNOMON_REPORT=OFF).
std::string_view page_template();

// What stands in the template where data belongs.
inline constexpr std::string_view title_slot = "@GNOMON_TITLE@";
inline constexpr std::string_view data_slot = "@GNOMON_DATA@";
inline constexpr std::string_view pictures_slot = "@GNOMON_PICTURES@";

// The numbers as JSON; harness/report/html/web/data.js reads it. docs/report.md is for people who want the numbers:
// they take `gnomon table --format json`.

/// Columns, rows, groups, legends, provenance: everything but pictures. The rows are those of the layout in its order, which
/// must have been laid out with every column.
Json report_data(const Layout& layout, std::span<const Record> records);

/// JSON that may stand inside a script element: no `<` in it, and text that is not UTF-8 mended.
std::string script_text(const Json& json);

/// Text that may stand between tags or in a quoted attribute.
std::string html_text(std::string_view text);

/// Pictures for the image comparer: base64 of deflated bytes, each read by the page when it is first shown.
struct PictureSet {
  std::vector<std::string> blobs;
  /// By group of the layout: null, or {lit, dark, reference, irradiance, classes} with numbers of blobs. `lit` and `dark` are
  /// the shaded colors with all and without any direct light: red, green and blue planes, each byte less its left neighbor
  /// modulo 256. The others are one byte a pixel: 255 times the mask, index of PixelClass. `irradiance` is the reference of the
  /// rows that estimate the share of a light's irradiance, null where there is none.
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
