#include "device/vulkan_context.h"

#include <gnomon/error.h>

#include "device/context.h"

#ifdef GNOMON_VULKAN
#include <gnomon/kit/vulkan/vulkan.h>
#endif

namespace gnomon {

namespace {

#ifdef GNOMON_VULKAN
VulkanChoice choice_of(GlChoice choice) {
  switch (choice) {
    case GlChoice::software:
    case GlChoice::zink:
      return VulkanChoice::processor;
    case GlChoice::hardware:
      return VulkanChoice::card;
    case GlChoice::automatic:
      break;
  }
  return VulkanChoice::any;
}

/// Why there is none.
std::string make_device() {
  const VulkanChoice choice = choice_of(gl_choice_from_environment());
  try {
    set_current_vulkan(new Vulkan(choice));  // never deleted
  } catch (const VulkanFailure&) {
    throw;
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}
#else
std::string make_device() {
  return "this program was built without Vulkan: its headers or glslangValidator were missing (Debian: libvulkan-dev, "
         "glslang-tools)";
}
#endif

}  // namespace

const std::string& missing_vulkan() {
  static const std::string* const why = new std::string(make_device());
  return *why;
}

}  // namespace gnomon
