#pragma once
// The only header of this folder that is of use where GNOMON_VULKAN is not defined.

namespace gnomon {

class Vulkan;

/// The device that techniques of this process work with; null while nobody has set one. It belongs to who set it.
const Vulkan* current_vulkan();
void set_current_vulkan(const Vulkan* vulkan);

}  // namespace gnomon
