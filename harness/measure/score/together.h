#pragma once
#include "measure/scene/channels.h"
#include "measure/score/metrics.h"

namespace gnomon {

/// Several lights as one answer. Its visibility is the share that a pixel receives of the light that it would receive of all of
/// them without shadows (received_light); 1 where that is nothing. Where a light is not tested at a pixel (its class is not T),
/// its reference counts on both sides. Arrays are width * height, row-major.
///
/// Lights of several channels (sun.red, sun.green, ...) are put together channel by channel, and all else at a pixel is that of
/// the channel whose share errs most there, among those that are tested: a mask that is too red and too little blue is wrong,
/// though the two errors cancel in gray. Metrics are means over the channels.
struct Together {
  const Scene* scene = nullptr;
  const GBuffer* gbuffer = nullptr;
  std::vector<double> received;                  ///< of all lights, or of one channel's, without shadows, W/m2
  std::vector<float> mask = {}, reference = {};  ///< shares of it
  /// The mask's share where lights are not tested, too: for pictures. Of several channels the mean.
  std::vector<float> shown = {};
  std::vector<float> reference_error = {};  ///< standard errors of `reference`; empty where no light has an area
  std::vector<float> reference_half = {};   ///< what half of its rays say; the same
  /// The truth over the pixel, empty where no light has it. A light that has none, or is not tested, counts by its reference.
  /// Of rays kept the fewest of a light that is tested.
  std::vector<float> pixel_mean = {}, pixel_half = {};
  std::vector<std::uint8_t> pixel_kept = {};
  std::vector<PixelClass> classes;         ///< T where a light is tested; else the first of U, S, G, F, B that one has
  std::vector<Cause> causes = {};          ///< of the light that errs most there; empty where no light has causes
  std::vector<CauseInfo> own_causes = {};  ///< of the technique
  AnswerKind kind = AnswerKind::received;  ///< of the channels of one light that light's
  std::optional<Channel> channel = {};     ///< that all lights are of
  std::vector<Together> channels = {};     ///< in the order red, green, blue; empty where lights are of one or of none

  /// It must not outlive this.
  Evidence evidence() const;
};

/// Lights of one scene and G-buffer, one at least, whose evidence has both and the light.
Together together(std::span<const Evidence> lights);
/// The same with their channels taken for so many lights: in gray, which hides errors that cancel.
Together together_in_gray(std::span<const Evidence> lights);

}  // namespace gnomon
