#pragma once
#include <cstddef>
#include <string_view>

namespace gnomon {

/// What the reference is true of, under a light without area.
enum class TruthOver {
  center,  ///< pixel centers
  pixel,   ///< pixel centers and pixels as wholes (PixelTruth), and rows are judged by the second
  both,    ///< the same, and rows are judged by the first
};
inline constexpr std::string_view truth_over_names[] = {"center", "pixel", "both"};
constexpr std::string_view name(TruthOver over) { return truth_over_names[static_cast<std::size_t>(over)]; }

}  // namespace gnomon
