#pragma once
#include <gnomon/kit/maps/alpha_setting.h>
#include <gnomon/kit/maps/glass_setting.h>

namespace gnomon {

/// Causes of techniques that draw depth maps, with an AlphaSetting and a GlassSetting, for their About.
inline constexpr OwnCause map_causes[] = {alpha_causes[0], alpha_causes[1], glass_causes[0]};
static_assert(std::size(map_causes) == std::size(alpha_causes) + std::size(glass_causes));

}  // namespace gnomon
