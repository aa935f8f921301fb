#pragma once
#include <gnomon/gbuffer.h>
#include <gnomon/kit/unset_vector.h>

#include <span>
#include <vector>

namespace gnomon {

// Filters over the pixels of a picture that are linear once their weights are fixed. A share of the light that is seen is a
// ratio of sums: numerators f V over denominators f, with f the irradiance of what was asked, or 1 for shares of area (Heitz,
// Hill and McGuire 2018). Weights come from the geometry (FilterGuides), and in some filters from the first numerators and
// their variance. Denominators and all numerators pass through the very same weights, so a channel of exact shares does as
// well.

/// Room beside every row of the guides and of a filter's planes, so that no tap has to look where the picture ends.
inline constexpr int filter_margin = 32;

/// What filters know of the geometry at pixels. Structure of arrays, rows `stride` apart, with filter_margin pixels that no
/// weight reaches before and after each row.
class FilterGuides {
 public:
  /// `faces`: of each pixel, whether it counts (1) or not (0); such that do not are left as they are and weigh nothing. Pixels
  /// of the background never count. Reuses its memory at the same size.
  void make(const GBuffer& gbuffer, std::span<const std::uint8_t> faces);
  /// Of half of the pixels both ways, rounded up: each the first of up to 2x2 that counts, with its own footprint, so that
  /// weights between two are those of the fine pixels.
  void halve(const FilterGuides& fine);
  int width() const { return width_; }
  int height() const { return height_; }
  int stride() const { return width_ + 2 * filter_margin; }
  /// Where pixel (x, y) is in a plane of filters.
  std::size_t at(int x, int y) const { return static_cast<std::size_t>(y) * stride() + filter_margin + x; }
  bool counts(int x, int y) const { return mesh_[at(x, y)] != no_mesh; }
  /// Meters at a pixel's point, across the line of sight, per pixel; 0 at pixels that do not count.
  float footprint(int x, int y) const { return footprint_[at(x, y)]; }
  /// Whether pixel (x, y) is on the mesh of `other`'s pixel `there`, within two footprints of its plane and turned less than
  /// 30 degrees away from it. Not where one of them does not count.
  bool joins(int x, int y, const FilterGuides& other, glm::ivec2 there) const;
  std::size_t bytes() const;

  struct Row {
    const float *px, *py, *pz, *nx, *ny, *nz;
    const float* per_footprint;  ///< 1 / footprint, 0 where the pixel does not count
    const std::uint32_t* mesh;   ///< no_mesh where the pixel does not count
  };
  /// From pixel (0, y) on.
  Row row(int y) const;

 private:
  void resize(int width, int height);
  void clear_row(int y);

  int width_ = 0, height_ = 0;
  UnsetVector<float> px_, py_, pz_, nx_, ny_, nz_, footprint_, per_footprint_;
  UnsetVector<std::uint32_t> mesh_;
};

/// What is filtered, in place; each span has one number a pixel, row-major. Numbers of pixels that do not count stay as they
/// are, and what they are does not matter.
struct FilterPlanes {
  std::span<float> denominators;
  std::span<const std::span<float>> numerators;  ///< at least one; weights by value look at the first, the others follow
  std::span<float> variance = {};                ///< of the ratio of the first; needed and written by weights by value alone
};

/// Taps and weights of one level, whose step is 2^level pixels.
struct FilterRule {
  int reach = 2;               ///< taps to each side: 2 is (1, 4, 6, 4, 1) / 16 both ways, 1 is (2/3, 1, 2/3) both ways
  bool sharp_normals = true;   ///< max(0, N_p . N_q)^128, else ^32
  float value_deviations = 0;  ///< e of exp(-|V_p - V_q| / (e s + floor)), s^2 the variance blurred by 3x3; 0: no such weight
  float value_floor = 0;
};
/// Edge-avoiding a-trous levels (Dammertz et al. 2010) that follow the geometry alone.
inline constexpr FilterRule atrous_rule{};
/// Those of SVGF (Schied et al. 2017), with the exact distance from the plane in place of differences of depth.
inline constexpr FilterRule svgf_rule{.value_deviations = 4, .value_floor = 1e-4f};
/// The three passes of FidelityFX's shadow denoiser.
inline constexpr FilterRule tile_rule{.reach = 1, .sharp_normals = false, .value_deviations = 1, .value_floor = 1e-4f};
/// Levels that fit into filter_margin: 0 .. 4.
inline constexpr int most_filter_levels = 5;

/// Runs levels over planes. A weight from p to q is the product of the taps, of max(0, N_p . N_q)^128 or ^32 and of exp(-e),
/// with e the sum of |N_p . (P_q - P_p)| / footprint and of what the values differ by; 0 on another mesh and on pixels that do
/// not count. For exp(-e) stands 1 / (1 + e + e^2 / 2 + e^3 / 6). A level's numbers are sum w x / sum w; variance is sum (w
/// f)^2 var / (sum w f)^2, f the denominators. A pixel whose denominator is 0 looks at others as if it were half lit, of
/// variance 1/4.
class GuidedFilter {
 public:
  /// Room for `numerator_count` numerators. `run` does it where it has to; nothing is allocated afterwards.
  void resize(int width, int height, std::size_t numerator_count);
  /// Levels first .. last - 1. `strength`: of each pixel 0 .. 1, how much of the rule's blur it gets, 0 leaves it as it is;
  /// empty: 1. Reach 2 then has per pass twice the taps (s, 1 - 2 s, s), s = strength / 4, of variance strength 4^level
  /// pixels^2; reach 1 has strength 2/3 to the sides. Same first numerators, denominators and variance, same weights: followers
  /// may also come in a second run over copies. Throws Error on sizes that do not agree and levels outside 0 .. 5.
  void run(const FilterGuides& guides, const FilterRule& rule, int first, int last, const FilterPlanes& planes,
           std::span<const float> strength = {});
  /// Spreads each pixel by a Gaussian of its own sigma in pixels, by levels 0 .. 4 of atrous_rule: each has the part of sigma^2
  /// that those below leave, up to 4^level. Sigma above sqrt(341) counts as that.
  void run_by_sigma(const FilterGuides& guides, std::span<const float> sigma, const FilterPlanes& planes);
  std::size_t bytes() const;

 private:
  void load(const FilterGuides& guides, const FilterPlanes& planes, bool by_value);
  void store(const FilterGuides& guides, const FilterPlanes& planes, bool by_value) const;
  void look_at_values(const FilterGuides& guides, const FilterRule& rule);
  void run_level(const FilterGuides& guides, const FilterRule& rule, int level, std::size_t numerator_count,
                 std::span<const float> strength);

  int width_ = 0, height_ = 0;
  std::vector<UnsetVector<float>> now_, next_;       ///< denominators, numerators; with margins
  UnsetVector<float> variance_now_, variance_next_;  ///< with margins
  UnsetVector<float> value_, per_deviation_;         ///< with margins; 0 where values weigh nothing
  UnsetVector<float> strength_;                      ///< row-major, of run_by_sigma
};

/// Sigma in pixels for penumbrae of a width in pixels: 1.8 (w / 12)^(2/3), the least error of one ray a pixel in straight
/// penumbrae of 12 to 48 pixels. 0 at 0: contacts stay as they are.
float sigma_of_width(float width_pixels) noexcept;

/// Width of a penumbra in meters across the light's rays: of a lamp of radius `radius` at `light_distance`, with the caster
/// `caster_distance` from the point: 2 r d / (D - d). D - d counts as D / 1024 at least, so that widths are finite
/// and can be summed up.
float penumbra_width(float radius, float light_distance, float caster_distance) noexcept;

/// Variance of the ratio of the first numerators to the denominators over the 7x7 pixels around each that counts: those on the
/// same mesh and within two footprints of its plane, each weighted by its denominator. Written where `history_length`, in
/// frames, is below `fewest_frames`, and everywhere if that is empty; elsewhere `variance` keeps what it holds.
void spread_variance(const FilterGuides& guides, std::span<const float> numerators, std::span<const float> denominators,
                     std::span<float> variance, std::span<const float> history_length = {}, float fewest_frames = 4);

}  // namespace gnomon
