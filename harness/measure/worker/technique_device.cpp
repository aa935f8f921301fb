#include "measure/worker/technique_device.h"

#include <algorithm>

#include "measure/worker/opengl_device.h"
#include "measure/worker/vulkan_device.h"

namespace gnomon {

FloorRequest::Reply TechniqueDevice::draw_floor(Floor floor, const Scene&, const GBuffer&, int) {
  throw Error("there is no bare pass {}: the processor draws nothing", name(floor));
}

void TechniqueDevice::fill(VisibilityMask& mask, float value) { std::ranges::fill(mask.pixels(), value); }

std::unique_ptr<TechniqueDevice> device_of(const About& about) {
  switch (about.device) {
    case Device::processor:
      return std::make_unique<TechniqueDevice>();
    case Device::opengl:
      return std::make_unique<OpenGlDevice>();
    case Device::vulkan:
      return vulkan_device();
  }
  throw Error("there is no device {}", static_cast<int>(about.device));
}

}  // namespace gnomon
