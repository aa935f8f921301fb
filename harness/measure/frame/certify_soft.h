#pragma once
#include <gnomon/kit/area/area_scene.h>

#include "measure/frame/frame.h"
#include "measure/frame/stated_errors.h"
#include "measure/json.h"

namespace gnomon {

struct SoftCertifyOptions {
  std::string reference = "";         ///< how the reference was made
  AreaTarget target = {};             ///< to which target
  std::size_t most_penumbra = 20000;  ///< pixels of the penumbra to decide, drawn at random where there are more
  double random_share = 0.02;         ///< of the other pixels of class T
  std::uint64_t seed = 1;             ///< of both draws
  /// Chance that a reference which keeps Student's law to the letter is refused, for each comparison.
  double false_alarm = 1e-4;
};

/// How far a reference under a light with area may be trusted: exact shares (AreaScene) for pixels of class T, compared with
/// the errors that the reference states. Of differences of its seven degrees of freedom Student's law lets so many lie beyond
/// 2, 3 and 4 standard errors, and their mean is 0.
struct SoftCertificate {
  std::string scene, light, view, reference;
  AreaTarget target = {};
  double false_alarm = 0;
  std::size_t tested_count = 0, uncertain_count = 0, penumbra_count = 0;  ///< pixels of T, of U, of T in the penumbra
  std::vector<StatedErrors> comparisons = {};  ///< area and irradiance, each in penumbrae and elsewhere
  AreaTally tally = {};

  bool holds() const { return all_hold(comparisons); }
};

/// Certifies a reference under a light with area, on a G-buffer of mesh truth. Same inputs, same certificate. Throws Error on
/// a light without area, on a G-buffer of exact curved shapes, and on casters with holes or transmission.
SoftCertificate certify_soft(const Scene& scene, const Light& light, const GBuffer& gbuffer, const Reference& reference,
                             const SoftCertifyOptions& options = {});

/// A few lines for the terminal.
std::string text(const SoftCertificate& certificate);
/// Keys in alphabetical order.
void to_json(Json& json, const SoftCertificate& certificate);

}  // namespace gnomon
