#ifdef GNOMON_VULKAN
#include "device/vulkan_stopwatch.h"

namespace gnomon {

VulkanStopwatch::VulkanStopwatch() {
  if (!vulkan().has_clock()) return;
  auto info = vulkan_info<VkQueryPoolCreateInfo>(VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO);
  info.queryType = VK_QUERY_TYPE_TIMESTAMP;
  info.queryCount = 2;
  Vulkan::check(vulkan().CreateQueryPool(vulkan().device(), &info, nullptr, &queries_), "a pool of queries");
  for (std::uint32_t k = 0; k < 2; ++k)
    marks_[k] = vulkan().recorded([&](VkCommandBuffer commands) {
      vulkan().CmdResetQueryPool(commands, queries_, k, 1);
      vulkan().CmdWriteTimestamp(commands, VK_PIPELINE_STAGE_BOTTOM_OF_PIPE_BIT, queries_, k);
    });
}

VulkanStopwatch::~VulkanStopwatch() {
  if (const Vulkan* const v = current_vulkan(); v && queries_) v->DestroyQueryPool(v->device(), queries_, nullptr);
}

void VulkanStopwatch::mark(int which) {
  if (queries_) vulkan().hand_over(marks_[static_cast<std::size_t>(which)]);
}

std::optional<double> VulkanStopwatch::milliseconds() const {
  if (!queries_) return std::nullopt;
  vulkan().finish();
  std::uint64_t times[2] = {};
  const VkResult found = vulkan().GetQueryPoolResults(vulkan().device(), queries_, 0, 2, sizeof times, times, sizeof times[0],
                                                      VK_QUERY_RESULT_64_BIT | VK_QUERY_RESULT_WAIT_BIT);
  Vulkan::check(found, "timestamps");
  return vulkan().nanoseconds(times[0], times[1]) / 1e6;
}

}  // namespace gnomon
#endif
