#pragma once
// Only where GNOMON_VULKAN is defined.
#include <gnomon/kit/vulkan/vulkan.h>

#include "device/stopwatch.h"

namespace gnomon {

/// Timestamps of the current Vulkan device, each after all work that was handed over before it.
class VulkanStopwatch final : public DeviceStopwatch {
 public:
  VulkanStopwatch();
  ~VulkanStopwatch() override;
  std::optional<double> milliseconds() const override;

 private:
  void mark(int which) override;
  VkQueryPool queries_ = VK_NULL_HANDLE;  // null: the device has no clock
  std::array<VkCommandBuffer, 2> marks_{};
};

}  // namespace gnomon
