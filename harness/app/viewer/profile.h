#pragma once
#include <string>
#include <vector>

#include "app/viewer/compose.h"

namespace gnomon::viewer {

/// A line that is drawn over the picture, in pixels of it; the middle of the first pixel is at 0.5.
struct ProfileLine {
  glm::dvec2 from{0}, to{0};
  bool operator==(const ProfileLine&) const = default;
};

/// Visibility along a line, one value a pixel of its length. NAN where there is none: beside the picture, on the background,
/// without a mask.
struct Profile {
  std::vector<double> distance;   ///< from the line's beginning, pixels of the picture
  std::vector<glm::ivec2> pixel;  ///< of the picture
  std::vector<float> sides[2], reference;
  std::vector<float> error;   ///< standard errors of the reference; empty under lights without area and until they are computed
  bool is_reference[2] = {};  ///< the side shows the reference itself
  /// The reference is the share of the irradiance, which the first side with a mask of its own estimates.
  bool is_irradiance = false;
};
Profile profile_along(const Composition& composition, const ProfileLine& line);

/// A head line, and a line a pixel: distance_pixels, column, row, left, right, reference, standard_error; nothing between the
/// commas where there is no value.
std::string profile_csv(const Profile& profile);

/// How many standard errors to each side hold 95 % of a normal distribution.
inline constexpr double band_errors = 1.96;

}  // namespace gnomon::viewer
