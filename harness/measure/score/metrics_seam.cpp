// What pixels are off by, by their distance to a seam of the technique's images.
#include <gnomon/kit/geometry/camera.h>

#include <algorithm>

#include "measure/frame/boundary.h"
#include "measure/score/metrics.h"

namespace gnomon {

namespace {

/// Ends of the bins of distance in pixels to the nearest pixel beside a seam, which is 0 on both its sides. A bin holds the
/// values above the one before it, up to its end.
constexpr double seam_bin_ends[] = {1, 2, 4, 8, 16, 32, 64, INFINITY};

/// Finds the pixels beside seams.
class Seams {
 public:
  explicit Seams(const Evidence& e) : e_(e) {
    if (e.gbuffer) camera_.emplace(e.gbuffer->view, e.width, e.height);
  }

  std::vector<std::uint8_t> marked() const {
    std::vector<std::uint8_t> marks(e_.parts.size());
    const auto compare = [&](std::size_t i, std::size_t j) {
      if (is_seam(i, j)) marks[i] = marks[j] = 1;
    };
    for (int y = 0; y < e_.height; ++y)
      for (int x = 0; x < e_.width; ++x) {
        const std::size_t i = static_cast<std::size_t>(y) * e_.width + x;
        if (x + 1 < e_.width) compare(i, i + 1);
        if (y + 1 < e_.height) compare(i, i + e_.width);
      }
    return marks;
  }

 private:
  bool is_seam(std::size_t i, std::size_t j) const {
    return e_.parts[i] != e_.parts[j] && e_.parts[i] != 0 && e_.parts[j] != 0 && e_.faces_light(i) && e_.faces_light(j) &&
           (!camera_ || (goes_on(i, j) && goes_on(j, i)));
  }
  /// Whether neighbor j shows what i shows: along its ray it lies off the tangent plane of i by less than that plane's own step
  /// from i to the ray. Where another surface begins, parts differ because depth jumps, and no seam is seen.
  bool goes_on(std::size_t i, std::size_t j) const {
    const glm::dvec3 point = e_.gbuffer->position(i), normal = e_.gbuffer->normal(i);
    const auto width = static_cast<std::size_t>(e_.width);
    const glm::dvec3 ray = camera_->ray(static_cast<double>(j % width) + 0.5, static_cast<double>(j / width) + 0.5);
    const double t = glm::dot(normal, point - camera_->eye) / glm::dot(normal, ray);
    const glm::dvec3 expected = camera_->eye + t * ray;
    return t > 0 && glm::distance(glm::dvec3(e_.gbuffer->position(j)), expected) <= glm::distance(point, expected);
  }

  const Evidence& e_;
  std::optional<Camera> camera_;
};

}  // namespace

std::vector<SeamBin> measure_seam_bins(const Evidence& e) {
  if (e.parts.empty()) return {};
  const std::vector<float> distance = distance_transform(Seams(e).marked(), e.width, e.height);
  std::vector<SeamBin> bins(std::size(seam_bin_ends));
  for (std::size_t i = 0; i < e.mask.size(); ++i) {
    if (e.classes[i] != PixelClass::T) continue;
    SeamBin& bin = bins[static_cast<std::size_t>(std::ranges::lower_bound(seam_bin_ends, double(distance[i])) - seam_bin_ends)];
    ++bin.tested;
    bin.error_sum += std::abs(static_cast<double>(e.mask[i]) - e.reference[i]);
  }
  return bins;
}

}  // namespace gnomon
