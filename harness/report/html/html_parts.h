#pragma once
#include <filesystem>

#include "measure/cause/causes.h"
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
/// The page's list of causes: the common ones, then those that its techniques have of their own.
std::vector<CauseInfo> page_causes(const Layout& layout);

/// JSON that may stand inside a script element: no `<` in it, and text that is not UTF-8 mended.
std::string script_text(const Json& json);

/// Text that may stand between tags or in a quoted attribute.
std::string html_text(std::string_view text);

/// Pictures for the image comparer: base64 of deflated bytes, each read by the page when it is first shown.
struct PictureSet {
  std::vector<std::string> blobs;
  /// By group of the layout: null, or {bits, lit, dark, bright, white, reference, reference_error, irradiance,
  /// irradiance_error, classes}: the bits of all shares of the group (see share_bytes), the others but `white` numbers of
  /// blobs. `lit` and `dark` are the shaded colors with all and without any direct light: red, green and blue planes, each byte
  /// less its left neighbor modulo 256. `bright` is `lit` with the linear light `white` shown as white, null where `lit` hides
  /// nothing above white, 1: a penumbra mixes what is above it. `classes` is one byte a pixel, index of PixelClass.
  /// `irradiance` is the reference of the rows that estimate the share of a light's irradiance, null where there is none. The
  /// errors are standard errors (see error_bytes) of the references of lights with area, else null.
  Json groups = Json::array();
  /// By row in the layout's order: null, or {mask, causes}; causes is null or one byte a pixel: 0, or k for the k-th of
  /// page_causes.
  Json rows = Json::array();
  std::vector<std::string> notes;  ///< which groups and rows have none, and why
};

/// Masks come from the run's folder `dir`, the rest from the frame cache, made anew where it is not there. A scene that is not
/// the one measured is left out.
PictureSet collect_pictures(const std::filesystem::path& dir, const Layout& layout);

/// How finely the page knows visibilities under a light: 8 bits, under one with area 12, a step of 0.00024. Of 8 bits a step
/// is 0.004, as wide as the usual reference's standard error makes its 95 % band.
int bits_of_shares(AnswerKind kind);
/// Shares, taken to 0 .. 1, as whole numbers up to 2^bits - 1: the upper 8 bits of every pixel; of 12 bits after these the
/// lower 4, two pixels a byte, the first one's above.
std::vector<std::uint8_t> share_bytes(std::span<const float> shares, int bits);
/// Standard errors in one byte: 0 is 0, and k from 1 is 10^(6 (k - 255) / 254), 1e-6 to 1, off by 2.8 % at most.
std::vector<std::uint8_t> error_bytes(std::span<const float> errors);

/// zlib format, then base64.
std::string packed(std::span<const std::uint8_t> bytes);

}  // namespace gnomon
