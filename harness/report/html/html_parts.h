#pragma once
#include <filesystem>

#include "measure/cause/causes.h"
#include "report/table/layout.h"

namespace gnomon {

// The parts of a run's page: template, numbers, pictures.

/// The page without its data. The build makes it from harness/report/html/web. It contains each slot once. Empty when the
/// program was built without it (GNOMON_REPORT=OFF).
std::string_view page_template();

// The template contains these where the data are inserted.
inline constexpr std::string_view title_slot = "@GNOMON_TITLE@";
inline constexpr std::string_view colors_slot = "@GNOMON_COLORS@";
inline constexpr std::string_view data_slot = "@GNOMON_DATA@";
inline constexpr std::string_view pictures_slot = "@GNOMON_PICTURES@";

// The numbers as JSON; harness/report/html/web/data.js reads it. Other programs take `gnomon table --format json`, see
// docs/report.md.

/// Columns, rows, groups, legends, provenance: everything but pictures. The rows are those of the layout, in its order. The
/// layout must contain every column.
Json report_data(const Layout& layout, std::span<const Record> records);
/// The page's list of causes: the common ones, then the own causes of its techniques.
std::vector<CauseInfo> page_causes(const Layout& layout);

/// JSON for the inside of a script element: without `<`, and with bytes that are not UTF-8 replaced.
std::string script_text(const Json& json);

/// Text for the inside of an element or of a quoted attribute.
std::string html_text(std::string_view text);

/// Pictures for the image comparer: base64 of deflated bytes. The page reads each when it is first shown.
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
  std::vector<std::string> notes;  ///< groups and rows without pictures, and the reasons
};

/// Reads masks from the run's folder `dir`, the rest from the frame cache, which makes what it lacks. Leaves out a scene that
/// has changed since it was measured.
PictureSet collect_pictures(const std::filesystem::path& dir, const Layout& layout);

/// The most base64 of pictures of frames in a page that need not have all.
inline constexpr std::size_t most_frame_bytes = 8'000'000;
/// By row in the layout's order: null of a still and of a row without an answer. Of a row on a path {numbers, start,
/// frame_rate, mask, reference}: the frames that have pictures; seconds at frame 0, null where geometry stands still; frames
/// per second; the numbers of two blobs, which are added to the set. `mask` has one byte a pixel for each frame, `reference` a
/// byte of its visibility for each pixel and then a byte of its alpha (see RowFrames), frame after frame. Each byte is less
/// that of the frame before it, modulo 256. {reason} of a row on a path that the page has no frames of.
Json collect_frames(const std::filesystem::path& dir, const Layout& layout, bool with_pictures, bool with_all_frames,
                    PictureSet& set);

/// The precision of the page's visibilities under a light: 8 bits, under one with area 12, a step of 0.00024. A step of 8 bits
/// is 0.004, as wide as the 95 % band of the usual reference.
int bits_of_shares(AnswerKind kind);
/// Shares, clamped to 0 .. 1, as whole numbers up to 2^bits - 1: the upper 8 bits of every pixel; of 12 bits after these the
/// lower 4, two pixels a byte, the first one's in the upper half.
std::vector<std::uint8_t> share_bytes(std::span<const float> shares, int bits);
/// Standard errors in one byte: 0 is 0, and k from 1 is 10^(6 (k - 255) / 254), 1e-6 to 1, off by 2.8 % at most.
std::vector<std::uint8_t> error_bytes(std::span<const float> errors);

/// zlib format, then base64.
std::string packed(std::span<const std::uint8_t> bytes);

}  // namespace gnomon
