#pragma once
#include <algorithm>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "app/viewer/engine.h"
#include "measure/statistics/statistics.h"

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

inline void ResolveTimes::note(const Selection& selection, const EngineState& state) {
  for (int k = 0; k < 2; ++k) {
    Side& side = sides_[k];
    const SideState& now = state.sides[k];
    SideSelection selected = selection.sides[k];
    selected.layer.clear();
    if (!(side.selection == selected) || side.loaded != selection.loaded || now.answer_count < side.answer_count)
      side = {.selection = selected, .loaded = selection.loaded, .answer_count = now.answer_count, .ms = {}};
    const auto ms = now.newest_ms[static_cast<int>(Stage::resolve)];
    if (now.answer_count == side.answer_count || !now.answer || !ms) continue;
    side.answer_count = now.answer_count;
    if (side.frame != now.answer->frame->number) side.at_frame = 0;
    side.frame = now.answer->frame->number;
    if (side.ms.size() == most) side.ms.erase(side.ms.begin());
    side.ms.push_back(static_cast<float>(*ms));
    side.at_frame = std::min(side.at_frame + 1, side.ms.size());
  }
}

inline std::optional<ResolveTimes::Median> ResolveTimes::median(int side) const {
  const Side& s = sides_[side];
  if (s.at_frame < 3) return std::nullopt;
  const std::vector<double> ms(s.ms.end() - static_cast<std::ptrdiff_t>(s.at_frame), s.ms.end());
  return Median{gnomon::median(ms), ms.size()};
}

}  // namespace gnomon::viewer
