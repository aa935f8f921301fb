#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "app/viewer/engine.h"

namespace gnomon::viewer {

/// The last times of resolve, of both sides.
class ResolveTimes {
 public:
  static constexpr std::size_t most = 240;  ///< that are kept of a side

  /// Takes over the times that are new in the state. Those of another technique, setting or scene are forgotten.
  void note(const Selection& selection, const EngineState& state);

  /// Milliseconds, the oldest first.
  std::span<const float> last(int side) const { return sides_[side].ms; }

  struct Median {
    double ms;
    std::size_t count;
  };
  /// Of the times since camera, light and size are as they are now; nothing where there are fewer than three.
  std::optional<Median> median(int side) const;

 private:
  struct Side {
    SideSelection selection;  // without its layer
    std::shared_ptr<const LoadedScene> loaded;
    std::uint64_t answer_count = 0, frame = 0;
    std::vector<float> ms;
    std::size_t at_frame = 0;  // how many of the last are of `frame`
  };
  Side sides_[2];
};

}  // namespace gnomon::viewer
