#pragma once
#include <gnomon/kit/denoise/filters.h>

#include <array>
#include <memory>
#include <optional>

#include "pose.h"

namespace gnomon::denoised_rays {

/// Frames from which on a history is long enough: below, it is the noise of a few rays.
inline constexpr float short_history = 4;

/// Where in the picture before a pixel's point was, in pixels whose centers are at whole numbers, and which of the four pixels
/// around it show the same surface: bit k is the one k % 2 to the right and k / 2 down of (floor x, floor y).
struct Source {
  float x = 0, y = 0;
  std::uint32_t kept = 0;  ///< 0: there is no history
};

/// The pixels of a source with bilinear weights, which sum to 1 over those that are kept.
struct SourceTaps {
  std::array<std::size_t, 4> pixel{};
  std::array<float, 4> weight{};
  int count = 0;

  SourceTaps(const Source& source, int width);
  /// The mean of a plane of the picture before.
  float of(std::span<const float> plane) const {
    float sum = 0;
    for (int k = 0; k < count; ++k) sum += weight[k] * plane[pixel[k]];
    return sum;
  }
};

/// A point and its unit normal, turned to the eye.
struct SurfacePoint {
  glm::dvec3 position, normal;
};
/// Where a point of a triangle, with its normal there, was when the corners were those of `before`: by its barycentric
/// coordinates. Nothing where either triangle has no area.
std::optional<SurfacePoint> carried_back(const SurfacePoint& point, const std::array<glm::vec3, 3>& now,
                                         const std::array<glm::vec3, 3>& before);

/// Finds for each pixel where its point was in the frame before. Scenes, lights and cameras move exactly, so there is no guess:
/// the point goes back with its triangle and is projected by the last view. A pixel there counts if it shows the same mesh
/// within two footprints of the point's plane, turned by less than 26 degrees (a cosine of 0.9).
class Reprojection {
 public:
  /// The next frame is the first.
  void forget() { pose_ = nullptr; }
  bool has_last() const { return pose_ != nullptr; }
  const Pose* last_pose() const { return pose_.get(); }
  /// Fills `sources`. `lengths` are those of the histories of the frame before. With `drops` no pixel has a history, and none
  /// counts as refused.
  void follow(const Scene& scene, const std::shared_ptr<const Pose>& pose, const GBuffer& gbuffer, const FilterGuides& guides,
              std::span<const std::uint8_t> faces, std::span<const float> lengths, bool drops);
  /// This frame becomes the one before the next.
  void keep(const GBuffer& gbuffer, std::shared_ptr<const Pose> pose);

  std::span<const Source> sources() const { return sources_; }
  /// Of the picture that sources lie in.
  int source_width() const { return source_width_; }
  /// Whether a pixel's history began with a refusal and has been short since: the picture before did not show its point.
  bool began_refused(std::size_t pixel) const { return states_[pixel] == State::after_refusal; }
  /// Whether it was refused in this very frame.
  bool is_refused(std::size_t pixel) const { return began_refused(pixel) && sources_[pixel].kept == 0; }
  /// With the arrays of the G-buffer that is kept.
  std::size_t bytes() const;

 private:
  enum class State : std::uint8_t { none, from_start, after_refusal };
  struct Frame;
  Source find(const Frame& frame, std::size_t pixel) const;

  GBuffer gbuffer_;  ///< of the frame before
  std::shared_ptr<const Pose> pose_;
  int source_width_ = 0;
  UnsetVector<Source> sources_;
  UnsetVector<State> states_, last_states_;
};

}  // namespace gnomon::denoised_rays
