#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace gnomon {

/// Flips of a mask over the frames of a row. A flip is a change of sides (`is_lit`) between two frames that follow each other.
/// It holds three bits a pixel and frame.
class Flips {
 public:
  /// The next frame, of the size of those before. `age`: for each pixel how many frames up to this one, without a gap, are
  /// compared there; 0 where this one is not.
  void add(std::span<const float> mask, std::span<const float> reference, std::span<const std::uint32_t> age);

  struct Counts {
    /// Pairs of a frame and the one before that are both compared, over all pixels.
    std::uint64_t pairs = 0;
    std::uint64_t late = 0;       ///< flips that the reference has in another frame, before or after
    std::uint64_t unmatched = 0;  ///< flips that it has not
  };
  /// Each flip of the mask is matched with a flip of the reference the same way at the same pixel, at most `window` frames
  /// before or after, with all frames between compared. Each flip of the reference is matched once, nearest first; of equal
  /// distances the earlier flip of the mask comes first, and the earlier one of the reference. A flip in the very frame of its
  /// match is right and counts nowhere.
  Counts count(std::size_t window) const;

 private:
  using Plane = std::vector<std::uint64_t>;  ///< a bit a pixel
  struct Frame {
    Plane lit, reference_lit;
    Plane compared;  ///< this frame and the one before
  };
  Counts count_word(std::size_t word, std::size_t window) const;

  std::vector<Frame> frames_;
};

}  // namespace gnomon
