#pragma once
#include <gnomon/gbuffer.h>
#include <gnomon/kit/geometry/exact_scene.h>

#include <functional>

#include "measure/json.h"

namespace gnomon {

struct CertifyOptions {
  /// Whether a pixel is of class U already, by the classes of this scene, light and view; without it, none is.
  std::function<bool(std::size_t)> is_uncertain = {};
  std::string reference = "";  ///< how the reference was made: library, instruction set, flags, ray recipe
  int band = 2;                ///< every pixel this close to the reference's shadow boundary is queried, pixels
  double random_share = 0.02;  ///< of the other pixels that face the light
  std::uint64_t seed = 1;      ///< of the random share
};

/// How far a hard-shadow reference may be trusted for one scene, light and view: exact answers for its riskiest pixels and a
/// random share of the rest, compared one by one. A pixel is uncertain (class U) when the caller's classes say so, when its
/// exact answer hangs on an edge or a vertex alone, or when its segment passes an edge closer than `clearance_floor`.
struct Certificate {
  std::string scene, light, view, reference;
  std::size_t facing_count = 0;  ///< pixels that face the light
  std::size_t query_count = 0;   ///< pixels decided exactly: band_count + random_count
  std::size_t band_count = 0, random_count = 0;
  std::size_t uncertain_count = 0;               ///< queries in U for any of the three reasons
  std::size_t degenerate_count = 0;              ///< queries whose answer hangs on an edge or a vertex alone
  std::size_t close_count = 0;                   ///< queries below the certified margin M0: an edge closer than the floor
  std::vector<std::size_t> disagreements = {};   ///< pixels outside U where reference and exact answer differ; must be empty
  std::size_t uncertain_disagreement_count = 0;  ///< the same inside U
  double worst_margin = 0;         ///< largest margin m of a disagreement inside U, meters at the receiver; 0 without one
  double worst_margin_pixels = 0;  ///< the same in widths of the pixel's footprint across the view
  double clearance_floor = 0;      ///< 4 * 2^-24 * extent, meters; M0 is this, carried from the edge to the receiver
  double bound = 1;                ///< 95 % upper bound on the rate of disagreement outside U; 3 / N when none was seen
  int lattice_exponent = 0;        ///< vertices and light position are multiples of 2^this
  ExactTally tally = {};           ///< work of the exact queries, and which arithmetic decided

  bool holds() const { return query_count > uncertain_count && disagreements.empty(); }
};

/// Certifies `reference` (1 lit, 0 dark, row-major) on a G-buffer of mesh truth. Same inputs, same certificate. Throws Error on
/// an area light and on a G-buffer of exact curved shapes: the oracle decides triangles and hard shadows only.
Certificate certify(const Scene& scene, const Light& light, const GBuffer& gbuffer, std::span<const float> reference,
                    const CertifyOptions& options = {});

/// One-sided Clopper-Pearson upper bound, at 95 %, on a rate of which `count` events were seen in `total` trials.
double upper_bound_95(std::size_t count, std::size_t total);

/// A few lines for the terminal.
std::string text(const Certificate& certificate);
/// Keys in alphabetical order.
void to_json(Json& json, const Certificate& certificate);

}  // namespace gnomon
