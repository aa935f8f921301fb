#pragma once
#include "measure/frame/frame.h"
#include "measure/frame/stated_errors.h"

namespace gnomon {

struct PixelCertifyOptions {
  double random_share = 0.02;      ///< of the pixels away from the reference's shadow boundary
  std::size_t most_pixels = 4000;  ///< near it; drawn at random where there are more
  /// Pixels times casting triangles, at most: behind more triangles fewer pixels are decided.
  std::size_t most_tests = 200'000'000;
  std::uint64_t seed = 1;  ///< of all draws
  /// Chance that a truth which keeps Student's law to the letter is refused, for each comparison.
  double false_alarm = 1e-4;
};

/// How far the truth over the pixel may be trusted under a light without area: exact shares (ExactCoverage) of pixels of class
/// T that one triangle fills and whose rays are all kept, compared with the errors that the truth states. Pixels are chosen by
/// the truth at their centers, which the rays compared have no part in.
struct PixelCertificate {
  std::string scene, light, view;
  double false_alarm = 0;
  std::size_t tested_count = 0;                ///< pixels of T that keep half of their rays or more
  std::size_t filled_count = 0;                ///< of these, pixels that keep all and that one triangle fills
  std::vector<StatedErrors> comparisons = {};  ///< at shadow boundaries, and elsewhere

  bool holds() const { return all_hold(comparisons); }
};

/// On a G-buffer of mesh truth. Same inputs, same certificate. Throws Error on a light with area, on a G-buffer of exact curved
/// shapes, and on casters with holes or transmission.
PixelCertificate certify_pixels(const Scene& scene, const Light& light, const GBuffer& gbuffer, const Reference& reference,
                                const PixelTruth& truth, const PixelCertifyOptions& options = {});

/// A few lines for the terminal.
std::string text(const PixelCertificate& certificate);
/// Keys in alphabetical order.
void to_json(Json& json, const PixelCertificate& certificate);

}  // namespace gnomon
