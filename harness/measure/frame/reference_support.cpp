#include "measure/frame/reference_support.h"

#include <gnomon/error.h>
#include <gnomon/registry.h>

namespace gnomon {

Support reference_support(const Scene& scene, const Light& light, const View& view) {
  const Support support = registry().reference().make()->supports(scene, light, view);
  return support ? support : Support::unsupported(fmt::format("the reference has no answer: {}", support.why()));
}

void require_reference(const Scene& scene, const Light& light, const View& view) {
  if (const Support support = reference_support(scene, light, view); !support)
    throw Error("scene {}, light {}: {}", scene.name, light.name, support.why());
}

}  // namespace gnomon
