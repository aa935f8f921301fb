#pragma once
#include <gnomon/kit/vulkan/programs.h>

#include <array>

#include "tracer.h"

namespace gnomon::vulkan_rays {

/// Buffers that shaders see beside the tree, from binding 1 on.
inline constexpr std::uint32_t buffer_count = 7;

/// The shaders of one way of tracing, ready to run.
class Programs {
 public:
  explicit Programs(Trace trace);
  Programs(Programs&& other) noexcept;
  ~Programs();

  const VulkanLayout& layout() const { return layout_; }
  void trace(VkCommandBuffer commands, const VulkanBindings& bindings, const FrameConstants& constants) const;
  /// Where in the pipeline of the device they run.
  VkPipelineStageFlags stage() const;
  std::size_t bytes() const { return table_.bytes(); }

 private:
  void make_pipeline();
  void make_table();

  Trace trace_;
  VulkanLayout layout_;
  VkPipeline pipeline_ = VK_NULL_HANDLE;
  VulkanBuffer table_;  // of shaders
  std::array<VkStridedDeviceAddressRegionKHR, 4> regions_{};
};

}  // namespace gnomon::vulkan_rays
