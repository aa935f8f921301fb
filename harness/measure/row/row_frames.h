#pragma once
#include "measure/row/row.h"

namespace gnomon {

/// Pictures that a row on a path keeps, at most.
inline constexpr int most_kept_frames = 120;
/// The frames that have them: all, or so many at even distances, the first and the last among them.
std::vector<int> kept_frame_numbers(int frame_count);

/// A visibility as a byte, in steps of 1/255.
std::uint8_t byte_of_share(float share);

// The alpha of a reference's picture, by the class of a pixel.
inline constexpr std::uint8_t tested_alpha = 255, facing_alpha = 128, other_alpha = 0;

/// Keeps pictures of a row's frames in the run's folder while the row is measured, and names them in the record: 8-bit gray
/// PNG, the mask in a folder of the row, and the reference in one that all rows with the same references share. The reference
/// has alpha: where the surface faces the light it is tested_alpha or, of pixels that are not tested, facing_alpha. Of several
/// lights both are shares of their light; the three channels of one light are taken for so many lights.
class RowFrames {
 public:
  /// Removes what an earlier run of the row left.
  RowFrames(Record& record, std::filesystem::path out, int frame_count);
  RowFrames(const RowFrames&) = delete;
  /// Removes what is unfinished of the reference. The masks are the row's pictures (remove_pictures).
  ~RowFrames();

  /// Every frame in its order. Throws Error when a picture cannot be written.
  void add(int frame, const MeasuredRow& row, const Scene& scene);
  /// After the last one. The folder of the references is named by their content.
  void finish();

 private:
  void write(int frame, const Evidence& evidence);

  Record& record_;
  const std::filesystem::path out_;
  const std::vector<int> numbers_;
  const std::filesystem::path part_;  ///< the references' folder until all are there
  std::string content_;               ///< hash of the references so far
};

}  // namespace gnomon
