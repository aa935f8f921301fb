#pragma once
#include "measure/record/record.h"
#include "measure/score/earlier_views.h"
#include "measure/score/flips.h"
#include "measure/score/metrics.h"

namespace gnomon {

/// Which pixels are compared over frames where the camera stands still. A pixel is steady while it shows one surface point:
/// mesh, triangle and position have the same bits. It is compared over frames in which it is steady and T.
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
/// Where the camera moves, a pixel is compared with the one that showed its point (EarlierViews). Flicker and steady_share are
/// then defined, and nothing else: what follows one point through all frames has no pixel to follow it by.
///
/// It holds for each pixel, and for each channel: 20 bytes of what the last frame shows, 4 of its age, 16 of mean and variance,
/// 4 for each frame of a quarter of a second and one more, and 3 bits a frame. That is 50 MB for 300 frames of 640x360 at 60
/// Hz, and 92 MB at 240 Hz. Where the camera moves it holds 16 for each frame of a quarter of a second and one more, and
/// nothing else: 59 MB and 225 MB.
class TimeScore {
 public:
  /// Of a row of so many frames, above 0 of them per second.
  TimeScore(int frames, double frame_rate, Path::Moves moves);
  void add(const Evidence& now);
  /// By name, each of them; nothing where one is not defined.
  Metrics metrics() const;

 private:
  /// Sums over all pairs of frames `lag` apart.
  struct Flicker {
    std::string_view metric;
    std::size_t lag = 0;  ///< frames; 0: no number of the row's frames is so long
    double squares = 0;
    std::uint64_t count = 0;   ///< compared
    std::uint64_t tested = 0;  ///< pixels of T in the later frames
  };
  /// Of the error of a pixel over time.
  struct Moments {
    double mean = 0, squares = 0;  ///< squares: sum of squared differences from the mean
  };
  bool follows_camera() const { return moves_ == Path::Moves::camera; }
  /// Frames that the longest lag reaches over, both ends included; 1 where no lag is defined.
  std::size_t frames_kept() const;
  /// Pixel of the frame `lag` frames before the last one that pixel i of that is compared with.
  std::optional<std::size_t> compared(const Evidence& now, std::size_t i, std::size_t lag) const;
  void add_flicker(const Evidence& now);
  void add_moments(const Evidence& now);
  std::optional<double> temporal_sd() const;
  double steady_count() const;
  std::optional<double> steady_share() const;
  Metrics mean_of_channels() const;

  int frames_;
  double frame_rate_;
  Path::Moves moves_;
  std::size_t added_ = 0;  ///< frames
  SteadyPixels steady_;    ///< empty where the camera moves, as are moments_ and flips_
  std::array<Flicker, std::size(flicker_metrics)> flicker_;
  std::optional<EarlierViews> views_;       ///< where the camera moves
  std::vector<std::vector<float>> errors_;  ///< of this frame and those before that a lag reaches back to, in turns
  std::vector<Moments> moments_;
  Flips flips_;
  std::vector<TimeScore> channels_;  ///< then all else is empty
};

/// The same names without values.
Metrics no_metrics_over_time();

/// Why flicker is not defined at so many frames per second; empty where it is.
std::string flicker_obstacle(double frame_rate);

}  // namespace gnomon
