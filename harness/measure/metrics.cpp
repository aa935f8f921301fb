#include "measure/metrics.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "measure/statistics.h"

namespace gnomon {

namespace {

std::optional<double> share(double part, double whole) {
  if (whole == 0) return std::nullopt;
  return part / whole;
}

constexpr MetricInfo rows[] = {
    {"wrong_rate", "", "lower", "Share of the tested pixels (T) whose visibility is off by more than one half.",
     [](const Tally& t) { return share(t.wrong, t.tested); }},
    {"wrong_rate_all", "", "lower", "The same over every pixel that faces the light (T, G, S and U): nothing hidden.",
     [](const Tally& t) { return share(t.wrong_facing, t.facing); }},
    {"false_dark_rate", "", "lower", "Share of T that is dark where the reference is lit.",
     [](const Tally& t) { return share(t.false_dark, t.tested); }},
    {"false_lit_rate", "", "lower", "Share of T that is lit where the reference is dark.",
     [](const Tally& t) { return share(t.false_lit, t.tested); }},
    {"beyond_coverage", "", "lower", "Share of T that is wrong where the technique says that it does not cover the pixel.",
     [](const Tally& t) { return share(t.beyond_coverage, t.tested); }},
    {"error_mean", "", "lower", "Mean over T of the absolute difference from the reference.",
     [](const Tally& t) { return share(t.error_sum, t.tested); }},
    {"displacement_mean", "px", "lower", "Mean distance between the shadow boundaries of technique and reference, both ways.",
     [](const Tally& t) { return t.displacement_mean; }},
    {"displacement_p95", "px", "lower", "95th percentile of the same distances.",
     [](const Tally& t) { return t.displacement_p95; }},
    {"tested_share", "", "higher", "Share of the pixels facing the light that is tested (T).",
     [](const Tally& t) { return share(t.tested, t.facing); }},
};

/// One-dimensional squared distance transform by the lower envelope of parabolas (Felzenszwalb and Huttenlocher 2012). In
/// double: squares of pixel coordinates above 4096 are no float32 numbers any more.
void transform_line(const double* f, double* d, int n, std::vector<int>& v, std::vector<double>& z) {
  int k = -1;
  for (int q = 0; q < n; ++q) {
    if (std::isinf(f[q])) continue;
    double s = -INFINITY;
    while (k >= 0) {
      const int p = v[k];
      s = ((f[q] + static_cast<double>(q) * q) - (f[p] + static_cast<double>(p) * p)) / (2.0 * (q - p));
      if (s > z[k]) break;
      --k;
    }
    if (k < 0) s = -INFINITY;
    v[++k] = q;
    z[k] = s;
    z[k + 1] = INFINITY;
  }
  if (k < 0) {
    std::fill_n(d, n, INFINITY);
    return;
  }
  for (int q = 0, j = 0; q < n; ++q) {
    while (z[j + 1] < q) ++j;
    d[q] = f[v[j]] + static_cast<double>(q - v[j]) * (q - v[j]);
  }
}

/// The dark side of the boundary alone: with both sides marked, an edge displaced by k pixels would be found k - 1/2 away.
std::vector<std::uint8_t> shadow_rim(const Evidence& e, std::span<const float> mask) {
  std::vector<std::uint8_t> marked = shadow_boundary(mask, e.classes, e.width, e.height);
  for (std::size_t i = 0; i < marked.size(); ++i) marked[i] &= mask[i] <= 0.5f;
  return marked;
}

void measure_displacement(const Evidence& e, Tally& t) {
  const auto ours = shadow_rim(e, e.mask), theirs = shadow_rim(e, e.reference);
  const bool have_ours = std::find(ours.begin(), ours.end(), 1) != ours.end();
  const bool have_theirs = std::find(theirs.begin(), theirs.end(), 1) != theirs.end();
  if (!have_ours && !have_theirs) t.displacement_mean = t.displacement_p95 = 0;
  if (!have_ours || !have_theirs) return;
  const auto to_ours = distance_transform(ours, e.width, e.height), to_theirs = distance_transform(theirs, e.width, e.height);
  std::vector<double> distances;
  for (std::size_t i = 0; i < ours.size(); ++i) {
    if (ours[i]) distances.push_back(to_theirs[i]);
    if (theirs[i]) distances.push_back(to_ours[i]);
  }
  t.displacement_mean = std::accumulate(distances.begin(), distances.end(), 0.0) / static_cast<double>(distances.size());
  t.displacement_p95 = quantile(distances, 0.95);
}

}  // namespace

std::span<const MetricInfo> metric_infos() { return rows; }

Tally tally(const Evidence& e) {
  Tally t;
  for (std::size_t i = 0; i < e.mask.size(); ++i) {
    if (!e.faces_light(i)) continue;
    const bool wrong = e.is_wrong(i);
    ++t.facing;
    t.wrong_facing += wrong;
    if (e.classes[i] != PixelClass::T) continue;
    ++t.tested;
    t.error_sum += std::abs(e.mask[i] - e.reference[i]);
    if (!wrong) continue;
    ++t.wrong;
    ++(e.mask[i] < e.reference[i] ? t.false_dark : t.false_lit);
    t.beyond_coverage += !e.uncovered.empty() && e.uncovered[i];
  }
  measure_displacement(e, t);
  return t;
}

std::vector<Verdict> verdicts(const Evidence& e) {
  std::vector<Verdict> result(e.mask.size(), Verdict::untested);
  for (std::size_t i = 0; i < result.size(); ++i) {
    if (e.classes[i] != PixelClass::T) continue;
    if (!e.is_wrong(i))
      result[i] = Verdict::right;
    else if (!e.uncovered.empty() && e.uncovered[i])
      result[i] = Verdict::beyond_coverage;
    else
      result[i] = e.mask[i] < e.reference[i] ? Verdict::false_dark : Verdict::false_lit;
  }
  return result;
}

std::vector<std::uint8_t> shadow_boundary(std::span<const float> mask, std::span<const PixelClass> classes, int width,
                                          int height) {
  std::vector<std::uint8_t> marked(mask.size(), 0);
  const auto mark = [&](std::size_t i, std::size_t j) {
    if (classes[i] > PixelClass::F && classes[j] > PixelClass::F && (mask[i] > 0.5f) != (mask[j] > 0.5f))
      marked[i] = marked[j] = 1;
  };
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const std::size_t i = static_cast<std::size_t>(y) * width + x;
      if (x + 1 < width) mark(i, i + 1);
      if (y + 1 < height) mark(i, i + width);
    }
  return marked;
}

std::vector<float> distance_transform(std::span<const std::uint8_t> marked, int width, int height) {
  std::vector<double> squared(marked.size());
  const int longest = std::max(width, height);
  std::vector<double> in(longest), out(longest), z(longest + 1);
  std::vector<int> v(longest);
  for (int x = 0; x < width; ++x) {
    for (int y = 0; y < height; ++y) in[y] = marked[static_cast<std::size_t>(y) * width + x] ? 0.0 : INFINITY;
    transform_line(in.data(), out.data(), height, v, z);
    for (int y = 0; y < height; ++y) squared[static_cast<std::size_t>(y) * width + x] = out[y];
  }
  for (int y = 0; y < height; ++y) {
    double* row = &squared[static_cast<std::size_t>(y) * width];
    std::copy_n(row, width, in.data());
    transform_line(in.data(), row, width, v, z);
  }
  std::vector<float> distances(squared.size());
  std::ranges::transform(squared, distances.begin(), [](double d) { return static_cast<float>(std::sqrt(d)); });
  return distances;
}

}  // namespace gnomon
