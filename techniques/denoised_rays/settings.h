#pragma once

namespace gnomon::denoised_rays {

enum class Filter { width, svgf, tiles, none };
enum class Memory { off, accumulate, clamp };
enum class OnChange { keep, drop, clamp };

/// What of a technique's settings the filters and the memory need. They stay the same within a sequence of frames.
struct Settings {
  Filter filter = Filter::width;
  Memory memory = Memory::off;
  OnChange on_change = OnChange::clamp;
  bool by_pixel = false;  ///< shares are divided before the filter, not after it
  float alpha = 0.05f;    ///< part of the newest frame, where there are many
  float longest = 64;     ///< frames that a history counts as at most

  bool operator==(const Settings&) const = default;
  bool remembers() const { return memory != Memory::off; }
  /// Whether weights of the filter look at values, hence need their variance.
  bool looks_at_values() const { return filter == Filter::svgf || filter == Filter::tiles; }
  bool needs_moments() const { return memory == Memory::clamp || looks_at_values(); }
};

}  // namespace gnomon::denoised_rays
