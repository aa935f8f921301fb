// The plot of error against samples.
#include <imgui.h>

#include <algorithm>
#include <cmath>

#include "app/viewer/panels.h"
#include "app/viewer/plot.h"
#include "app/viewer/widgets.h"
#include "measure/picture/signed_color.h"

namespace gnomon::viewer {

void draw_sample_curve(const SampleCurve& curve) {
  if (!curve.why_not.empty()) Widgets::wrapped("The curve ends early: " + curve.why_not, warning_text);
  std::vector<double> samples, errors;  // those that a logarithm has a place for
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
  const auto color_of = [](const Color& c) { return packed(c[0], c[1], c[2]); };
  std::vector<PlotCurve> curves = {{.name = curve.is_complete ? "left" : "left, measuring",
                                    .color = color_of(technique_inks[0].core),
                                    .x = samples,
                                    .y = errors,
                                    .has_points = true},
                                   {.name = "slope -1/2", .color = quiet_text, .x = ends, .y = guide, .is_thin = true}};
  double low = std::min(std::ranges::min(errors), guide[1]);
  if (curve.error_floor > 0) {
    curves.push_back({.name = "error floor", .color = color_of(reference_ink.casing), .x = ends, .y = own, .is_thin = true});
    low = std::min(low, curve.error_floor);
  }
  draw_plot({.title = "samples", .low = ends[0] / 1.3, .high = ends[1] * 1.3, .is_log = true},
            {.title = "mean error", .low = low / 1.5, .high = 1.5 * std::ranges::max(errors), .is_log = true}, curves);
}

}  // namespace gnomon::viewer
