#pragma once
#include <gnomon/kit/geometry/camera.h>

#include <optional>

#include "measure/score/metrics.h"

namespace gnomon {

/// Finds the point that a pixel shows again in the frames before, where the camera moves. A pixel that is not T is found
/// nowhere.
///
/// It holds 12 bytes a pixel for each frame that it keeps.
class EarlierViews {
 public:
  /// Keeps so many frames, the last one included.
  explicit EarlierViews(std::size_t kept) : kept_(kept) {}
  /// The next frame, of the size of those before, with its G-buffer.
  void add(const Evidence& now);
  /// Pixel of the frame `lag` frames before the last one that shows the point P of its pixel i; lag < kept and at most the
  /// number of frames before. It is the pixel q whose center is the nearest to P in the earlier picture; nothing unless
  /// - P projects into that picture, and its eye is on the side of the surface that the last frame shows,
  /// - both pixels are T, and show one mesh and one triangle,
  /// - the point of q is within the width of a pixel, at its depth, of the plane through P across P's normal. That tells the
  ///   near side of an exact curved shape from its far side: both are triangle 0.
  /// `now` is the evidence of the last frame.
  std::optional<std::size_t> pixel_of(const Evidence& now, std::size_t i, std::size_t lag) const;

 private:
  struct PixelSeen {
    std::uint32_t mesh = no_mesh;  ///< no_mesh also where a pixel is not T
    std::uint32_t triangle = 0;
    float depth = 0;  ///< meters along the camera's forward
  };
  struct FrameSeen {
    Camera camera;
    std::vector<PixelSeen> shown;
  };
  std::size_t kept_, added_ = 0;
  std::vector<FrameSeen> frames_;  ///< in turns
};

}  // namespace gnomon
