#include <gnomon/kit/maps/filter_setting.h>

namespace gnomon {

FilterSetting::FilterSetting(Parametrized* owner)
    : filter(owner, "filter", "nearest",
             {"nearest", "pcf", "disc", "bilinear", "optimized", "bicubic", "rotated", "revectorized"}, Stage::setup,
             "One comparison, or the mean of several (percentage-closer filtering): of (2 filter_radius + 1)^2 texels, of a "
             "disc around the point, of the four nearest with the weights of graphics cards, of 3, 5 or 7 a side with fixed "
             "weights that move with the point, of 4 a side with those of a cubic spline, or of filter_taps on a spiral that "
             "noise turns in each pixel. Or one comparison, and lines in the place of the stairs of edges (revectorized)."),
      filter_radius(owner, "filter_radius", 1, {.unit = "texel", .min = 1, .max = 8}, Stage::relight,
                    "Half the side of the square beside its middle texel, less half a texel the disc's radius, at most 3 of "
                    "optimized; for filter=pcf, disc, optimized and rotated."),
      filter_taps(owner, "filter_taps", 8, {.min = 1, .max = MapFilter::most_taps, .log = true}, Stage::resolve,
                  "Comparisons on the spiral, in each frame; for filter=rotated."),
      noise_frame(owner, "noise_frame", 0, {.min = 0, .max = 63}, Stage::resolve,
                  "Which frame's noise turns the spiral: interleaved gradient noise, moved by 5.588238 pixels a frame; for "
                  "filter=rotated."),
      noise_frames(owner, "noise_frames", 1, {.min = 1, .max = 16, .log = true}, Stage::resolve,
                   "How many frames' answers are averaged, from noise_frame on: what an average over time comes to; for "
                   "filter=rotated."),
      edge_search(owner, "edge_search", 16, {.unit = "texel", .min = 1, .max = 64, .log = true}, Stage::relight,
                  "How far an edge is followed either way; for filter=revectorized."),
      early_bail(owner, "early_bail", false, Stage::setup,
                 "Five texels of the filter, the middle one and four around it, decide where they agree; for filter=pcf, "
                 "disc, optimized, bicubic and rotated.") {}

MapFilter FilterSetting::used() const {
  return {.kind = MapFilter::Kind(filter.index()),
          .radius = filter_radius,
          .taps = filter_taps,
          .first_frame = noise_frame,
          .frames = noise_frames,
          .search = edge_search,
          .bails_early = early_bail};
}

Support FilterSetting::support() const {
  if (!filter.is("optimized") || filter_radius <= MapFilter::most_optimized) return Support::full();
  return Support::unsupported(fmt::format("filter=optimized has weights for filter_radius 1 to {}, not for {}",
                                          MapFilter::most_optimized, filter_radius.value()));
}

}  // namespace gnomon
