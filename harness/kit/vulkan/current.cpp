#include <gnomon/kit/vulkan/current.h>

namespace gnomon {

namespace {
const Vulkan* current = nullptr;
}

const Vulkan* current_vulkan() { return current; }
void set_current_vulkan(const Vulkan* vulkan) { current = vulkan; }

}  // namespace gnomon
