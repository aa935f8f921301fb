// The reference under lights with area against masks made by POV-Ray and Cycles, which share no code with it, within what the
// sampling of both allows.
//
// Cycles takes n random paths to a light, of which half go to the dark side of one that emits on both. Let w be what a path
// carries where nothing is hidden and v whether it is seen. The mask is p' = sum(w v) / sum(w), and for large n
//   variance(p') = mean(w^2 (v - p)^2) / (n mean(w)^2) <= max(w) / mean(w) * p (1 - p) / n,
// because mean(w (v - p)^2) / mean(w) = p (1 - p). Where places are drawn by area, w is the irradiance of the place; by solid
// angle, the cosine at the receiver: the larger factor counts. Places that are spread evenly, as those of Cycles are, do better
// than random ones. One path more or less is 1 / n, as in the reference. Paths of two pixels are independent.
//
// POV-Ray samples the middle of each of n x n cells of a rectangle. Triangles have straight edges on the light, as a point
// sees it. A cell that none crosses is right. Of one that an edge crosses the seen share is anywhere in 0 .. 1 but counted as 0
// or 1: wrong by at most 1/2, and where the edge runs along the cells by a number that is uniform in -1/2 .. 1/2, of variance
// 1/12, which is the most. All m crossed cells may be wrong by the same number, so that
//   standard error <= m / (sqrt(12) n^2).
// The horizon hides in the same way, but also leaves fewer points to divide by. Where an edge runs along the rows or columns of
// the picture, pixels of a row or column see it at the same place; others see it elsewhere: as many differences are independent
// as there are rows or columns, whichever are fewer.
#include <gnomon/error.h>
#include <gnomon/kit/area/area_rays.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <set>

#include "measure/frame/certify_soft.h"
#include "measure/frame/soft_reference.h"
#include "measure/statistics/distributions.h"
#include "measure/statistics/statistics.h"
#include "witness_mask.h"

namespace gnomon::soft_witness_test {

constexpr int width = 160, height = 90;
constexpr int grid = 32;             // of POV-Ray, along each side
constexpr double path_count = 1024;  // of Cycles

/// Of the cells of POV-Ray's grid, the share that an edge or the horizon crosses, of those above the horizon: where corners and
/// center of one are not all the same.
double crossed_share(const WitnessedFrame& frame, const Light& light, std::size_t pixel) {
  const LightFigure face(light, frame.gbuffer.position(pixel), frame.gbuffer.normal(pixel));
  const FaceRays rays(frame.casters, frame.gbuffer, pixel, face);
  const auto ask = [&](int side, double first) {
    const auto place_of = [&](std::size_t along) { return static_cast<float>((first + static_cast<double>(along)) / grid); };
    std::vector<unsigned> found(static_cast<std::size_t>(side) * side);  // bit 0: above the horizon; bit 1: and seen
    for (std::size_t from = 0; from < found.size(); from += 16) {
      const std::size_t count = std::min<std::size_t>(16, found.size() - from);
      Squares squares;
      for (std::size_t k = 0; k < 16; ++k) {
        const std::size_t place = from + std::min(k, count - 1);
        squares.x[k] = place_of(place % side);
        squares.y[k] = place_of(place / side);
      }
      const FaceHits hits = rays.ask(places_on(face, squares));
      const std::uint32_t seen = hits.asked & ~hits.blocked;
      for (std::size_t k = 0; k < count; ++k) found[from + k] = (hits.asked >> k & 1) | (seen >> k & 1) << 1;
    }
    return found;
  };
  constexpr int stride = grid + 1;
  const std::vector<unsigned> corners = ask(stride, 0), centers = ask(grid, 0.5);
  int crossed = 0, above = 0;
  for (int y = 0; y < grid; ++y) {
    for (int x = 0; x < grid; ++x) {
      const unsigned center = centers[y * grid + x];
      const unsigned* corner = &corners[y * stride + x];
      const unsigned all = center & corner[0] & corner[1] & corner[stride] & corner[stride + 1];
      const unsigned some = center | corner[0] | corner[1] | corner[stride] | corner[stride + 1];
      crossed += std::popcount(all ^ some);
      above += static_cast<int>(center & 1);
    }
  }
  return above > 0 ? static_cast<double>(crossed) / above : 1;
}

double grid_error(const WitnessedFrame& frame, const Light& light, std::size_t pixel) {
  return crossed_share(frame, light, pixel) / std::sqrt(12.0);
}

bool is_one_sided(const Light& light) {
  const auto* rect = std::get_if<RectLight>(&light.kind);
  return (rect ? rect->emits : std::get<DiscLight>(light.kind).emits) == Emits::in_front;
}

double path_error(const WitnessedFrame& frame, const Light& light, std::size_t pixel, double share) {
  constexpr int side = 8;
  const LightFigure face(light, frame.gbuffer.position(pixel), frame.gbuffer.normal(pixel));
  double count = 0, angle = 0, irradiance = 0, most_irradiance = 0, most_cosine = 0;
  for (int k = 0; k < side * side; ++k) {
    const glm::dvec2 place((2 * (k % side) + 1.0) / side - 1, (2 * (k / side) + 1.0) / side - 1);
    if (face.is_disc() && glm::dot(place, place) > 1) continue;
    const glm::dvec3 to = face.at(place);
    const double cosine = glm::dot(face.normal(), glm::normalize(to)), weight = face.weight(to);
    ++count;
    angle += cosine != 0 ? weight / cosine : 0;
    if (!face.holds(place)) continue;
    irradiance += weight;
    most_irradiance = std::max(most_irradiance, weight);
    most_cosine = std::max(most_cosine, cosine);
  }
  if (irradiance <= 0) return 1;
  const double factor = std::max(most_irradiance * count, most_cosine * angle) / irradiance;
  const double paths = is_one_sided(light) ? path_count : path_count / 2;
  return std::sqrt(factor * (share * (1 - share) + 1 / paths) / paths);
}

/// Whether the same surface lies all around a pixel: three of a thousand rays of Cycles pass its center by up to half a pixel,
/// and what such a ray finds around a corner may outweigh all that a surface at grazing light gets.
bool is_amid_surface(const GBuffer& g, std::size_t pixel) {
  const int x = static_cast<int>(pixel % width), y = static_cast<int>(pixel / width);
  for (int v = std::max(y - 1, 0); v <= std::min(y + 1, height - 1); ++v) {
    for (int u = std::max(x - 1, 0); u <= std::min(x + 1, width - 1); ++u) {
      const std::size_t other = static_cast<std::size_t>(v) * width + u;
      if (g.mesh[other] != g.mesh[pixel] || glm::dot(g.normal(other), g.normal(pixel)) < 0.9f) return false;
    }
  }
  return true;
}

struct Agreement {
  std::size_t count = 0;        ///< pixels of class T that one of both sees in penumbra
  std::size_t independent = 0;  ///< differences, see above
  std::size_t beyond = 0;       ///< 4 standard errors
  double rms = 0;               ///< root of the mean square of differences, in standard errors
  double mean = 0, error = 0;   ///< of the differences, and the root of the mean square of their standard errors
  std::size_t most_beyond() const { return most_by_chance(count, 2 * student_tail(4, 7), 1e-4); }  // the reference's seven
  /// The mean square of n normal numbers has the standard error sqrt(2 / n); of less wide ones less.
  double most_rms() const { return std::sqrt(1 + 4 * std::sqrt(2 / static_cast<double>(independent))); }
  double most_mean() const { return 4 * error / std::sqrt(static_cast<double>(independent)); }
  bool holds() const { return count >= 200 && beyond <= most_beyond() && rms <= most_rms() && std::abs(mean) <= most_mean(); }
  std::string text() const {
    return fmt::format(
        "{} pixels, {} independent; beyond 4 errors {} (at most {}), rms {:.2f} errors (at most {:.2f}), mean {:.2g} "
        "(at most {:.2g})",
        count, independent, beyond, most_beyond(), rms, most_rms(), mean, most_mean());
  }
};

enum class Share { area, irradiance };

struct Case {
  WitnessInfo witness;
  std::string_view scene, light;

  bool is_grid() const { return witness.id == pov_ray.id; }
  Share share() const { return is_grid() ? Share::area : Share::irradiance; }
  WitnessedFrame frame() const {
    const std::string own = tree_file(fmt::format("tests/witness/scenes/{}.toml", scene));
    return {std::filesystem::exists(own) ? own : std::string(scene), std::string(light), witness.truth, width, height};
  }
};

/// Throws Error where the mask is missing.
Agreement compare(const Case& c, const WitnessedFrame& frame, const Light& light, Share share) {
  const std::vector<float> witness = read_witness(c.witness, c.scene, c.light, width, height);
  if (witness.empty())
    throw Error("the mask of {} {} {} is missing; run tests/witness/make_witnesses", c.witness.id, c.scene, c.light);
  const SoftReference reference = trace_soft(frame.scene, frame.casters, frame.gbuffer, light, frame.silhouettes, {});
  const bool is_area = share == Share::area;
  const std::vector<float>& shares = is_area ? reference.area : reference.irradiance;
  const std::vector<float>& errors = is_area ? reference.area_error : reference.irradiance_error;
  Agreement result;
  std::set<std::size_t> rows, columns;
  double squares = 0, variances = 0;
  for (std::size_t i = 0; i < witness.size(); ++i) {
    if (reference.classes[i] != PixelClass::T) continue;
    const double p = shares[i], difference = witness[i] - p;
    if ((p == 0 || p == 1) && std::abs(difference) < 1e-4) continue;  // the mask has 16 bits
    if (!c.is_grid() && !is_amid_surface(frame.gbuffer, i)) continue;
    const double error = std::hypot(c.is_grid() ? grid_error(frame, light, i) : path_error(frame, light, i, p), errors[i]);
    ++result.count;
    rows.insert(i / width);
    columns.insert(i % width);
    result.beyond += std::abs(difference) > 4 * error;
    result.mean += difference;
    squares += difference * difference / (error * error);
    variances += error * error;
  }
  const auto n = static_cast<double>(result.count);
  result.independent = c.is_grid() ? std::min(rows.size(), columns.size()) : result.count;
  result.rms = std::sqrt(squares / n);
  result.mean /= n;
  result.error = std::sqrt(variances / n);
  return result;
}

class SoftWitness : public testing::TestWithParam<Case> {};

TEST_P(SoftWitness, agrees_with_the_reference) {
  const Case& c = GetParam();
  const WitnessedFrame frame = c.frame();
  const Agreement a = compare(c, frame, frame.light, c.share());
  std::cout << fmt::format("{} {} {}: {}\n", c.witness.id, c.scene, c.light, a.text());
  EXPECT_TRUE(a.holds()) << a.text() << "\nif scenes/" << c.scene << ".cpp has changed, run tests/witness/make_witnesses";
}

std::string name_of(const testing::TestParamInfo<Case>& info) {
  return fmt::format("{}_{}_{}", info.param.witness.id, info.param.scene, info.param.light);
}

INSTANTIATE_TEST_SUITE_P(
    all, SoftWitness,
    testing::Values(Case{pov_ray, "box_city", "panel"}, Case{pov_ray, "composite", "panel"}, Case{pov_ray, "contact", "tube"},
                    Case{pov_ray, "cornell_box", "ceiling"}, Case{pov_ray, "fence", "panel"}, Case{pov_ray, "soup", "panel"},
                    Case{pov_ray, "sphere_field", "panel"}, Case{pov_ray, "sphere_over_plane", "panel"},
                    Case{cycles, "box_city", "panel"}, Case{cycles, "composite", "panel"}, Case{cycles, "composite", "lamp"},
                    Case{cycles, "contact", "tube"}, Case{cycles, "contact", "lamp"}, Case{cycles, "cornell_box", "ceiling"},
                    Case{cycles, "fence", "panel"}, Case{cycles, "fence", "lamp"}, Case{cycles, "soup", "panel"},
                    Case{cycles, "soup", "lamp"}, Case{cycles, "sphere_field", "panel"},
                    Case{cycles, "sphere_over_plane", "panel"}, Case{cycles, "sphere_over_plane", "lamp"}),
    name_of);

// By a twentieth of its width.
TEST(SoftWitnessOfAnotherLight, is_refused) {
  for (const WitnessInfo& witness : {pov_ray, cycles}) {
    for (const char* scene : {"sphere_over_plane", "fence"}) {
      const Case c{witness, scene, "panel"};
      const WitnessedFrame frame = c.frame();
      Light moved = frame.light;
      auto& rect = std::get<RectLight>(moved.kind);
      rect.center += 0.1f * rect.half_u;
      const Agreement a = compare(c, frame, moved, c.share());
      EXPECT_GT(a.rms, a.most_rms()) << c.witness.id << " " << scene << ": " << a.text();
    }
  }
}

// The irradiance of the room's walls comes for the most part from the places of the lamp that are high above their horizon.
TEST(SoftWitnessOfAnotherShare, is_refused) {
  for (const WitnessInfo& witness : {pov_ray, cycles}) {
    const Case c{witness, "cornell_box", "ceiling"};
    const WitnessedFrame frame = c.frame();
    const Agreement a = compare(c, frame, frame.light, c.is_grid() ? Share::irradiance : Share::area);
    EXPECT_GT(std::abs(a.mean), a.most_mean()) << c.witness.id << ": " << a.text();
  }
}

}  // namespace gnomon::soft_witness_test
