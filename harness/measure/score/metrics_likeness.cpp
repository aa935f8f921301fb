// What a viewer sees of a wrong mask: the shaded picture against the reference's.
#include <tbb/parallel_invoke.h>

#include "measure/picture/picture.h"
#include "measure/score/metrics.h"
#include "measure/score/perceptual.h"

namespace gnomon {

Likeness measure_likeness(const Evidence& e) {
  if (!e.scene || !e.gbuffer || !e.light) return {};
  Picture ours, theirs;
  tbb::parallel_invoke([&] { ours = shade(*e.scene, *e.gbuffer, *e.light, e.mask); },
                       [&] { theirs = shade(*e.scene, *e.gbuffer, *e.light, e.reference); });
  return {ssim(theirs, ours), flip(theirs, ours)};
}

}  // namespace gnomon
