#include "app/viewer/resolve_times.h"

#include <algorithm>

#include "measure/statistics/statistics.h"

namespace gnomon::viewer {

void ResolveTimes::note(const Selection& selection, const EngineState& state) {
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

std::optional<ResolveTimes::Median> ResolveTimes::median(int side) const {
  const Side& s = sides_[side];
  if (s.at_frame < 3) return std::nullopt;
  const std::vector<double> ms(s.ms.end() - static_cast<std::ptrdiff_t>(s.at_frame), s.ms.end());
  return Median{gnomon::median(ms), ms.size()};
}

}  // namespace gnomon::viewer
