#include "measure/frame/certify.h"

#include <gnomon/kit/random.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <bit>

#include "measure/fields.h"
#include "measure/frame/classify.h"

namespace gnomon {

namespace {

struct Sample {
  std::size_t pixel;
  ExactAnswer answer;
  EdgeMargin margin;  ///< within the floor for all; without limit where the reference disagrees
  bool disagrees = false;
};

/// Answers that differ by more than rounding to float32 does.
constexpr float one_step = 0x1p-24f;

/// Whether a pixel facing the light within `band` columns and rows has another answer.
bool near_boundary(const std::vector<char>& facing, std::span<const float> reference, int width, int height, std::size_t i,
                   int band) {
  const int x = static_cast<int>(i % width), y = static_cast<int>(i / width);
  for (int v = std::max(0, y - band); v <= std::min(height - 1, y + band); ++v)
    for (int u = std::max(0, x - band); u <= std::min(width - 1, x + band); ++u) {
      const std::size_t j = static_cast<std::size_t>(v) * width + u;
      if (facing[j] && std::abs(reference[j] - reference[i]) > most_off_behind_glass) return true;
    }
  return false;
}

/// Exponent of the coarsest binary lattice that holds all vertices and the light's position.
int lattice_exponent(const Scene& scene, const glm::dvec4& light) {
  int exponent = 127;
  const auto add = [&](const glm::vec3& p) {
    for (int k = 0; k < 3; ++k) {
      if (p[k] == 0) continue;
      int e;
      const auto mantissa = static_cast<std::uint32_t>(std::ldexp(std::abs(std::frexp(p[k], &e)), 24));
      exponent = std::min(exponent, e - 24 + std::countr_zero(mantissa));
    }
  };
  for (const Mesh& mesh : scene.meshes)
    for (const glm::vec3& p : mesh.positions) add(p);
  if (light.w != 0) add(glm::vec3(light));
  return exponent;
}

/// Width of a pixel across the view, at the distance of a point, meters.
double footprint(const GBuffer& gbuffer, std::size_t i) {
  const double height = 2 * std::tan(glm::radians(static_cast<double>(gbuffer.view.fov_y_degrees)) / 2);
  return glm::distance(glm::dvec3(gbuffer.position(i)), glm::dvec3(gbuffer.view.eye)) * height / gbuffer.height;
}

/// The pixels to decide exactly, counted in the certificate: all that face the light near the shadow boundary, and the random
/// share of the others.
std::vector<Sample> choose_pixels(const Scene& scene, const Light& light, const GBuffer& gbuffer,
                                  std::span<const float> reference, const CertifyOptions& options, Certificate& result) {
  std::vector<char> facing(gbuffer.size());
  for (std::size_t i = 0; i < gbuffer.size(); ++i) facing[i] = faces_light(scene, gbuffer, light, i);
  std::vector<Sample> samples;
  Random random(options.seed);
  for (std::size_t i = 0; i < gbuffer.size(); ++i) {
    const bool drawn = random.uniform(0, 1) < options.random_share;
    if (!facing[i]) continue;
    ++result.facing_count;
    const bool in_band = near_boundary(facing, reference, gbuffer.width, gbuffer.height, i, options.band);
    result.band_count += in_band;
    result.random_count += drawn && !in_band;
    if (drawn || in_band) samples.push_back({.pixel = i, .answer = {}, .margin = {}});
  }
  result.query_count = samples.size();
  return samples;
}

/// Counts how the exact answers agree with the reference. M0 and the margin carry an edge's clearance to the receiver by the
/// same factor, so it cancels.
void compare(std::span<const Sample> samples, const GBuffer& gbuffer, const CertifyOptions& options, Certificate& result) {
  for (const Sample& sample : samples) {
    const bool is_close = sample.margin.clearance < result.clearance_floor;
    const bool is_uncertain =
        is_close || sample.answer.degenerate || (options.is_uncertain && options.is_uncertain(sample.pixel));
    result.close_count += is_close;
    result.degenerate_count += sample.answer.degenerate;
    result.uncertain_count += is_uncertain;
    if (!sample.disagrees) continue;
    if (!is_uncertain) {
      result.disagreements.push_back(sample.pixel);
      continue;
    }
    ++result.uncertain_disagreement_count;
    result.worst_margin = std::max(result.worst_margin, sample.margin.carried);
    result.worst_margin_pixels = std::max(result.worst_margin_pixels, sample.margin.carried / footprint(gbuffer, sample.pixel));
  }
}

}  // namespace

double upper_bound_95(std::size_t count, std::size_t total) {
  if (count >= total) return 1;
  // The bound is the rate p at which `count` events or fewer have probability 0.05; that probability falls as p grows.
  const double n = static_cast<double>(total);
  const auto probability_of_at_most_count = [&](double p) {
    double sum = 0;
    for (std::size_t k = 0; k <= count; ++k) {
      const double x = static_cast<double>(k);
      sum += std::exp(std::lgamma(n + 1) - std::lgamma(x + 1) - std::lgamma(n - x + 1) + x * std::log(p) +
                      (n - x) * std::log1p(-p));
    }
    return sum;
  };
  double low = static_cast<double>(count) / n, high = 1;
  for (int step = 0; step < 60; ++step) {
    const double middle = (low + high) / 2;
    (probability_of_at_most_count(middle) > 0.05 ? low : high) = middle;
  }
  return high;
}

Certificate certify(const Scene& scene, const Light& light, const GBuffer& gbuffer, std::span<const float> reference,
                    const CertifyOptions& options) {
  if (has_area(light))
    throw Error("light {} is a {} light, only point, spot and directional lights can be certified", light.name,
                kind_name(light));
  if (gbuffer.truth == Truth::shape && scene.has_curved_shapes())
    throw Error("scene {} has exact curved shapes, only a G-buffer of mesh truth can be certified", scene.name);

  const glm::dvec4 l = homogeneous(light);
  Certificate result{.scene = scene.name, .light = light.name, .view = gbuffer.view.name, .reference = options.reference};
  result.clearance_floor = 4 * 0x1p-24 * extent(scene, light, gbuffer.view);
  result.lattice_exponent = lattice_exponent(scene, l);

  std::vector<Sample> samples = choose_pixels(scene, light, gbuffer, reference, options, result);

  // On all threads.
  const ExactScene exact(scene);
  const auto decide = [&](const tbb::blocked_range<std::size_t>& range, ExactTally tally) {
    for (std::size_t k = range.begin(); k < range.end(); ++k) {
      Sample& sample = samples[k];
      const Receiver receiver = receiver_at(scene, gbuffer, sample.pixel);
      float share;
      if (exact.has_transmission()) {
        const ExactShare answer = exact.transmitted(receiver, l, tally);
        share = static_cast<float>(answer.light.share.x);
        sample.answer = {share == 0, answer.degenerate};
      } else {
        sample.answer = exact.occluded(receiver, l, tally);
        share = sample.answer.blocked ? 0.0f : 1.0f;
      }
      sample.disagrees = std::abs(share - reference[sample.pixel]) > one_step;
      sample.margin = exact.edge_margin(receiver, l, sample.disagrees ? INFINITY : result.clearance_floor);
    }
    return tally;
  };
  result.tally = tbb::parallel_reduce(tbb::blocked_range<std::size_t>(0, samples.size(), 64), ExactTally{}, decide,
                                      [](ExactTally a, const ExactTally& b) { return a += b; });

  compare(samples, gbuffer, options, result);
  result.bound = upper_bound_95(result.disagreements.size(), result.query_count - result.uncertain_count);
  return result;
}

std::string text(const Certificate& c) {
  std::string out = fmt::format("{} / {} / {}: {}\n", c.scene, c.light, c.view, c.holds() ? "certified" : "NOT certified");
  if (!c.reference.empty()) out += fmt::format("  reference      {}\n", c.reference);
  out += fmt::format("  exact queries  {} of {} light-facing pixels: {} near the shadow boundary, {} at random\n",
                     c.query_count, c.facing_count, c.band_count, c.random_count);
  out += fmt::format("  outside U      {} queries, {} disagreements, rate below {:.3g} (95 %)\n",
                     c.query_count - c.uncertain_count, c.disagreements.size(), c.bound);
  out += fmt::format("  inside U       {} queries ({} below the margin, {} degenerate), {} disagreements", c.uncertain_count,
                     c.close_count, c.degenerate_count, c.uncertain_disagreement_count);
  if (c.uncertain_disagreement_count > 0)
    out += fmt::format(", worst margin {:.3g} m = {:.3g} pixels", c.worst_margin, c.worst_margin_pixels);
  out +=
      fmt::format("\n  margin floor   {:.3g} m; lattice 2^{} m; {} signs by int128, {} by GMP, the rest by the double filter\n",
                  c.clearance_floor, c.lattice_exponent, c.tally.signs.lattice, c.tally.signs.big);
  return out;
}

void for_each_field(MaybeConst<Certificate> auto& c, const auto& use) {
  const bool holds = c.holds();
  use("below_margin", c.close_count, "bound_95", c.bound, "clearance_floor_meters", c.clearance_floor, "degenerate",
      c.degenerate_count, "disagreements", c.disagreements, "disagreements_uncertain", c.uncertain_disagreement_count, "facing",
      c.facing_count, "holds", holds, "lattice_exponent", c.lattice_exponent, "light", c.light, "queries", c.query_count,
      "queries_band", c.band_count, "queries_random", c.random_count, "reference", c.reference, "scene", c.scene, "signs_gmp",
      c.tally.signs.big, "signs_int128", c.tally.signs.lattice, "uncertain", c.uncertain_count, "view", c.view,
      "worst_margin_meters", c.worst_margin, "worst_margin_pixels", c.worst_margin_pixels);
}
void to_json(Json& json, const Certificate& c) { json = written(c); }

}  // namespace gnomon
