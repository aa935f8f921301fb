#pragma once
#include "app/viewer/panels.h"

namespace gnomon::viewer {

/// The picture as it was composed last, and what its colors mean. Keeps alive what its composition points at.
class Canvas {
 public:
  /// Composes anew when anything that shows has changed; answers whether it did.
  bool compose(const Session& session, const EngineState& state, const PixelRect& place);

  /// Whether the state has other masks, verdicts or layers than those that the picture was composed of.
  bool is_outdated(const EngineState& state) const;

  const Composition& composition() const { return composition_; }
  std::span<const std::uint32_t> pixels() const { return pixels_; }
  std::span<const LegendEntry> legend_of(int side) const { return legends_[side]; }

 private:
  EngineState state_;
  Composition composition_;
  bool is_made_ = false;
  std::vector<std::uint32_t> pixels_;
  std::vector<LegendEntry> legends_[2];
};

}  // namespace gnomon::viewer
