#pragma once
#include <gnomon/technique.h>

namespace gnomon {

/// What the reference, the technique of that role, says of scene, light and view. Where it is unsupported there is no truth to
/// score against: whoever measures asks here first and passes the reason on.
Support reference_support(const Scene& scene, const Light& light, const View& view);

/// Throws Error with scene, light and reason where that is unsupported.
void require_reference(const Scene& scene, const Light& light, const View& view);

}  // namespace gnomon
