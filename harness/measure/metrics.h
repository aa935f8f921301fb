#pragma once
#include <gnomon/gbuffer.h>

#include <optional>
#include <span>
#include <string_view>

#include "measure/classify.h"

namespace gnomon {

/// What happened at a pixel, as the error picture and the counts name it.
enum class Verdict : std::uint8_t { untested, right, false_dark, false_lit, beyond_coverage };

/// Everything that scoring one mask may look at. Arrays are width * height, row-major.
struct Evidence {
  int width = 0, height = 0;
  std::span<const PixelClass> classes;
  std::span<const float> reference, mask;
  /// 1 where the technique said that it does not cover the pixel; empty when it covers all. Asked at wrong pixels only.
  std::span<const std::uint8_t> uncovered;

  bool faces_light(std::size_t i) const { return classes[i] > PixelClass::F; }
  bool is_wrong(std::size_t i) const { return std::abs(mask[i] - reference[i]) > 0.5f; }
};

/// Pixels of one mask counted once, for all metrics.
struct Tally {
  std::size_t tested = 0, facing = 0;                         ///< |T|, |T+G+S+U|
  std::size_t wrong = 0, wrong_facing = 0;                    ///< wrong in T, wrong in T+G+S+U
  std::size_t false_dark = 0, false_lit = 0;                  ///< of the wrong in T
  std::size_t beyond_coverage = 0;                            ///< of the wrong in T, not covered by the technique
  double error_sum = 0;                                       ///< sum over T of |mask - reference|
  std::optional<double> displacement_mean, displacement_p95;  ///< pixels; none when a boundary is missing on one side
};
Tally tally(const Evidence& evidence);

/// One metric is one row. A value is nothing where it is not defined, and shown so.
struct MetricInfo {
  std::string_view name, unit;
  std::string_view better;  ///< "lower", "higher" or ""
  std::string_view sentence;
  std::optional<double> (*value)(const Tally&);
};
std::span<const MetricInfo> metric_infos();

/// What the error picture shows; wrong pixels outside T are `untested`.
std::vector<Verdict> verdicts(const Evidence& evidence);

/// Euclidean distance in pixels from every pixel to the nearest marked one; infinity when none is marked.
std::vector<float> distance_transform(std::span<const std::uint8_t> marked, int width, int height);

/// Marks the pixels facing the light that have a 4-neighbor facing the light on the other side of one half.
std::vector<std::uint8_t> shadow_boundary(std::span<const float> mask, std::span<const PixelClass> classes, int width,
                                          int height);

}  // namespace gnomon
