#pragma once
#include "measure/record/record.h"
#include "measure/score/flips.h"
#include "measure/score/metrics.h"

namespace gnomon {

/// Which pixels are compared over frames. A pixel is steady while it shows one surface point: mesh, triangle and position have
/// the same bits. It is compared over frames in which it is steady and T.
class SteadyPixels {
 public:
  /// The next frame, of the size of those before, with its G-buffer.
  void add(const Evidence& now);
  /// For each pixel how many frames up to the last one, without a gap, are compared; 0 where the last one is not T.
  std::span<const std::uint32_t> ages() const { return ages_; }
  std::size_t frames() const { return frames_; }
  std::size_t tested_at_first() const { return tested_at_first_; }

 private:
  struct Shown {
    std::uint32_t mesh = no_mesh, triangle = 0;
    std::array<std::uint32_t, 3> position = {};  ///< bits
    bool operator==(const Shown&) const = default;
  };
  std::vector<Shown> shown_;  ///< in the last frame
  std::vector<std::uint32_t> ages_;
  std::size_t frames_ = 0, tested_at_first_ = 0;
};

/// Flicker is the change of the error over a lag.
struct FlickerMetric {
  std::string_view name;
  std::string_view lag;  ///< seconds as people write them
  int sixtieths = 1;     ///< the same in 1/60 s
};
inline constexpr FlickerMetric flicker_metrics[] = {
    {"flicker_1_60", "1/60", 1}, {"flicker_1_15", "1/15", 4}, {"flicker_1_4", "1/4", 15}};

/// The metrics that a row on a path has over all its frames (MetricInfo::Of::row); docs/method.md defines them. Frames are
/// added one by one, and nothing of a frame need outlive its call. Of several channels the metrics are means over them.
///
/// It holds for each pixel, and for each channel: 20 bytes of what the last frame shows, 4 of its age, 16 of mean and variance,
/// 4 for each frame of a quarter of a second and one more, and 3 bits a frame. That is 50 MB for 300 frames of 640x360 at 60
/// Hz, and 92 MB at 240 Hz.
class TimeScore {
 public:
  /// Of a row of so many frames, above 0 of them per second.
  TimeScore(int frames, double frame_rate);
  void add(const Evidence& now);
  /// By name, each of them; nothing where one is not defined.
  Metrics metrics() const;

 private:
  /// Sums over all pairs of frames `lag` apart.
  struct Flicker {
    std::string_view metric;
    std::size_t lag = 0;  ///< frames; 0: no number of the row's frames is so long
    double squares = 0;
    std::uint64_t count = 0;
  };
  /// Of the error of a pixel over time.
  struct Moments {
    double mean = 0, squares = 0;  ///< squares: sum of squared differences from the mean
  };
  void add_flicker(const Evidence& now);
  void add_moments(const Evidence& now);
  std::optional<double> temporal_sd() const;
  double steady_count() const;

  int frames_;
  double frame_rate_;
  SteadyPixels steady_;
  std::array<Flicker, std::size(flicker_metrics)> flicker_;
  std::vector<std::vector<float>> errors_;  ///< of this frame and those before that a lag reaches back to, in turns
  std::vector<Moments> moments_;
  Flips flips_;
  std::vector<TimeScore> channels_;  ///< then all else is empty
};

/// The same names without values: where no pixel is steady because the camera moves.
Metrics no_metrics_over_time();

/// Why flicker is not defined at so many frames per second; empty where it is.
std::string flicker_obstacle(double frame_rate);

}  // namespace gnomon
