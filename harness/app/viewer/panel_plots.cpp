// The plots in the magnifier's place: visibility along a line, error against samples, and the curve of a picked texel.
#include <imgui.h>

#include <algorithm>
#include <cmath>

#include "app/viewer/panels.h"
#include "app/viewer/plot.h"
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
  std::vector<PlotCurve> curves;
  if (is_known(reference)) {
    const std::string name = profile.is_irradiance ? "reference (irradiance)" : "reference";
    curves.push_back(
        {band.empty() ? name : name + " and its 95 %", packed(reference_ink.casing), profile.distance, reference, band});
  }
  for (int side = 0; side < 2; ++side)
    if (!profile.is_reference[side] && is_known(sides[side]))
      curves.push_back({side_name(side), packed(technique_inks[side].core), profile.distance, sides[side]});
  if (curves.empty()) return Widgets::wrapped("Nothing is computed along the line yet.", quiet_text);
  draw_plot({"pixels along the line", 0, std::max(profile.distance.back(), 1.0)}, {"visibility", -0.05, 1.05}, curves);
}

void draw_sample_curve(const SampleCurve& curve) {
  if (!curve.why_not.empty()) Widgets::wrapped("The curve ends early: " + curve.why_not, warning_text);
  std::vector<double> samples, errors;  // those that a logarithmic axis can show
  for (std::size_t k = 0; k < curve.error.size(); ++k) {
    if (!(curve.error[k] > 0)) continue;
    samples.push_back(curve.samples[k]);
    errors.push_back(curve.error[k]);
  }
  if (samples.empty()) {
    if (curve.why_not.empty()) Widgets::wrapped(curve.is_complete ? "There is no error." : "measuring", quiet_text);
    return;
  }
  const std::vector<double> ends = {samples.front(), std::max(samples.back(), 4 * samples.front())};
  const std::vector<double> guide = {errors[0], errors[0] * std::sqrt(ends[0] / ends[1])};
  const std::vector<double> own(2, curve.error_floor);
  std::vector<PlotCurve> curves = {{.name = curve.is_complete ? "left" : "left, measuring",
                                    .color = packed(technique_inks[0].core),
                                    .x = samples,
                                    .y = errors,
                                    .has_points = true},
                                   {.name = "slope -1/2", .color = quiet_text, .x = ends, .y = guide, .is_thin = true}};
  double low = std::min(std::ranges::min(errors), guide[1]);
  if (curve.error_floor > 0) {
    curves.push_back({.name = "error floor", .color = packed(reference_ink.casing), .x = ends, .y = own, .is_thin = true});
    low = std::min(low, curve.error_floor);
  }
  draw_plot({.title = "samples", .low = ends[0] / 1.3, .high = ends[1] * 1.3, .is_log = true},
            {.title = "mean error", .low = low / 1.5, .high = 1.5 * std::ranges::max(errors), .is_log = true}, curves);
}

void draw_depth_curve(const DepthCurve& curve, int side) {
  const double at[] = {curve.receiver, curve.receiver}, all[] = {-1, 2};
  const PlotCurve curves[] = {
      {.name = "exact", .color = packed(reference_ink.casing), .x = curve.exact.depth, .y = curve.exact.share},
      {.name = "texel", .color = packed(technique_inks[side].core), .x = curve.held.depth, .y = curve.held.share},
      {.name = "receiver", .color = quiet_text, .x = at, .y = all, .is_thin = true}};
  if (ImGui::BeginChild("depth curve", {0, 10 * ImGui::GetFontSize()}))
    draw_plot({"meters along the texel's ray", curve.held.depth.front(), curve.held.depth.back()},
              {"share of the light", -0.05, 1.05}, curves);
  ImGui::EndChild();
}

}  // namespace gnomon::viewer
