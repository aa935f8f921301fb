#pragma once
// Only where GNOMON_VULKAN is defined.
#include <gnomon/kit/vulkan/programs.h>
#include <gnomon/technique.h>

namespace gnomon {

/// The bare pass `fetch` by Vulkan: each pixel reads its position and normal and writes one number.
class VulkanBarePass {
 public:
  /// Throws Error on another floor: Vulkan draws no triangles here, and copies no pictures.
  VulkanBarePass(Floor floor, const Scene& scene, const GBuffer& gbuffer);
  VulkanBarePass(const VulkanBarePass&) = delete;
  ~VulkanBarePass();
  /// So many times in a row; waits for the last.
  void draw(int times = 1) const;
  /// What the last one wrote.
  std::vector<float> read() const;

 private:
  std::uint32_t width_, height_;
  VulkanLayout layout_;
  VkPipeline pipeline_ = VK_NULL_HANDLE;
  VulkanBuffer values_;
  VulkanBindings bindings_;
};

}  // namespace gnomon
