#pragma once
#include "measure/worker/technique_device.h"

namespace gnomon {

/// The Vulkan device of this process. Where there is none, a device of which `missing` says why.
std::unique_ptr<TechniqueDevice> vulkan_device();

}  // namespace gnomon
