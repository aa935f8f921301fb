#pragma once
#include <string>

namespace gnomon {

/// Makes the Vulkan device of this process at the first call, which is never destroyed: current_vulkan()
/// (gnomon/kit/vulkan/vulkan.h) then gives it. Why there is none; empty: there is one. The environment variable GNOMON_GL
/// chooses as it does for OpenGL: `hardware` takes no processor, `software` and `zink` nothing else, `auto` any other device
/// first. Throws Error on another word, and where a device with all that is needed could not be made.
const std::string& missing_vulkan();

}  // namespace gnomon
