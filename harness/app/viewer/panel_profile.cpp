// The plot of visibility along a line.
#include <imgui.h>

#include <cmath>

#include "app/viewer/panels.h"
#include "app/viewer/plot.h"
#include "app/viewer/profile.h"
#include "app/viewer/widgets.h"
#include "measure/picture/signed_color.h"

namespace gnomon::viewer {

void draw_profile(const PanelData& shown, const ProfileLine& line) {
  const Profile profile = profile_along(shown.composition, line);
  const auto widened = [](const std::vector<float>& values) { return std::vector<double>(values.begin(), values.end()); };
  const std::vector<double> reference = widened(profile.reference),
                            sides[] = {widened(profile.sides[0]), widened(profile.sides[1])};
  std::vector<double> band = widened(profile.error);
  for (double& error : band) error *= band_errors;
  const auto is_known = [](const std::vector<double>& values) {
    return std::ranges::any_of(values, [](double v) { return std::isfinite(v); });
  };
  // As the contours: the reference white as its casing, the sides as their cores.
  const auto color_of = [](const Color& c) { return packed(c[0], c[1], c[2]); };
  std::vector<PlotCurve> curves;
  if (is_known(reference)) {
    const std::string name = profile.is_irradiance ? "reference (irradiance)" : "reference";
    curves.push_back(
        {band.empty() ? name : name + " and its 95 %", color_of(reference_ink.casing), profile.distance, reference, band});
  }
  for (int side = 0; side < 2; ++side)
    if (!profile.is_reference[side] && is_known(sides[side]))
      curves.push_back({side_name(side), color_of(technique_inks[side].core), profile.distance, sides[side]});
  if (curves.empty()) return Widgets::wrapped("Nothing is known along the line yet.", quiet_text);
  draw_plot({"pixels along the line", 0, std::max(profile.distance.back(), 1.0)}, {"visibility", -0.05, 1.05}, curves);
}

}  // namespace gnomon::viewer
