#pragma once
#include "measure/cause/causes.h"

namespace gnomon {

/// A change of the whole mask: it is the reference's but for this one, the same at every pixel. Then no pixel's error says
/// anything of a shadow.
struct WholeMask {
  enum class Change : std::uint8_t { shift, gamma, blur, upside_down, mirrored, turned, inverted };
  Change change;
  glm::dvec2 shift{0};              ///< pixels right and down, from the reference to the mask
  double gamma = 1;                 ///< the mask is the reference to this power
  double sigma = 0;                 ///< of a Gaussian filter, pixels
  double explained = 0;             ///< the share of the error that goes when the reference is changed alike
  std::vector<float> changed = {};  ///< the reference so changed, NaN where that is undefined; width * height

  /// Whether the change has a cause of its own and leaves less than half of the pixel's error.
  bool explains(const Attribution& attribution, std::size_t pixel) const;
  /// `none` of the last four changes.
  Cause cause() const;
  /// "shifted by 1 px right and 2 px down"
  std::string words() const;
};

/// "shift", "upside_down", ...
std::string_view name(WholeMask::Change change);

/// The limits of the search, in pixels; and the share of the error that must go.
inline constexpr int most_shift = 8;
inline constexpr double most_sigma = 8, least_explained = 0.75;

/// The change that explains the most of the mask's error, over the tested pixels whose value under the change is defined;
/// nothing where it explains too little, or these pixels hold less than half of the error. docs/causes.md describes the search.
std::optional<WholeMask> find_whole_mask(const Attribution& attribution);

}  // namespace gnomon
