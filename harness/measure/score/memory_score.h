#pragma once
#include "measure/record/record.h"
#include "measure/score/metrics.h"

namespace gnomon {

/// Pictures of a path's first frame before the path, for a technique that remembers frames: of a mean that forgets a twentieth
/// with each of them, 0.95^64 = 4 % are older.
inline constexpr int still_frames = 64;
/// The last of these, whose mean error is that of settled memory.
inline constexpr int settled_frames = 16;

/// How long what was remembered shows after a jump.
struct GhostTimes {
  std::optional<double> half_life;  ///< frames until half of the error that the jump has added is gone
  std::optional<double> frames;     ///< frames until the error is within a tenth of the one before; nothing: not in the row
};
/// `errors` from the frame of the jump on, `settled` before it.
GhostTimes ghost_times(std::span<const double> errors, double settled);

/// The metrics of techniques that remember frames, cold, settled and after a jump; docs/method.md defines them. Of a technique
/// that does not remember, those after a jump alone.
class MemoryScore {
 public:
  /// Error of still frame `number`, 0 .. still_frames - 1: the first, and the last settled_frames.
  void add_still(int number, std::optional<double> error);
  /// Error of the next frame of a path, and what the frame shows (SceneRun::shown).
  void add_frame(std::optional<double> error, const std::string& shown);
  /// By name; nothing where one is not defined.
  Metrics metrics() const;

 private:
  /// The frame after which, and before which, all frames show the same; nothing where there is no such.
  std::optional<std::size_t> jump() const;

  std::optional<double> cold_;
  std::vector<double> settled_;  ///< errors
  std::vector<std::optional<double>> errors_;
  std::vector<std::size_t> changes_;  ///< frames that show something other than the one before
  std::string shown_;
};

}  // namespace gnomon
