#pragma once
#include <gnomon/kit/vulkan/vulkan.h>

namespace gnomon {

/// A shader module during its lifetime: words of SPIR-V.
class VulkanShader {
 public:
  explicit VulkanShader(std::span<const std::uint32_t> words);
  VulkanShader(const VulkanShader&) = delete;
  ~VulkanShader();
  VkPipelineShaderStageCreateInfo as(VkShaderStageFlagBits stage) const;

 private:
  VkShaderModule name_ = VK_NULL_HANDLE;
};

/// What the shaders of a program see: at binding 0 an acceleration structure, where they have one, and behind it storage
/// buffers; and constants of so many bytes.
class VulkanLayout {
 public:
  VulkanLayout(VkShaderStageFlags stages, bool has_tree, std::uint32_t buffers, std::uint32_t constant_bytes);
  VulkanLayout(VulkanLayout&& other) noexcept;
  ~VulkanLayout();

  VkPipelineLayout name() const { return layout_; }
  VkPipeline compute_pipeline(std::span<const std::uint32_t> words) const;
  /// Before a dispatch: `constants` has the bytes that the layout has.
  void push(VkCommandBuffer commands, const void* constants) const;

 private:
  friend class VulkanBindings;
  VkShaderStageFlags stages_;
  bool has_tree_;
  std::uint32_t buffers_, constant_bytes_;
  VkDescriptorSetLayout bindings_ = VK_NULL_HANDLE;
  VkPipelineLayout layout_ = VK_NULL_HANDLE;
};

/// The things that a program sees, for one layout.
class VulkanBindings {
 public:
  VulkanBindings() = default;
  explicit VulkanBindings(const VulkanLayout& layout);
  VulkanBindings(VulkanBindings&& other) noexcept { swap(other); }
  VulkanBindings& operator=(VulkanBindings&& other) noexcept {
    VulkanBindings(std::move(other)).swap(*this);
    return *this;
  }
  ~VulkanBindings();
  explicit operator bool() const { return set_ != VK_NULL_HANDLE; }
  /// As many buffers as the layout has; no tree where it has none.
  void see(VkAccelerationStructureKHR tree, std::span<const VkBuffer> buffers) const;
  /// Of a pipeline with that layout.
  void bind(VkCommandBuffer commands, VkPipelineBindPoint point, const VulkanLayout& layout) const;

 private:
  void swap(VulkanBindings& other) noexcept {
    std::swap(pool_, other.pool_);
    std::swap(set_, other.set_);
  }
  VkDescriptorPool pool_ = VK_NULL_HANDLE;
  VkDescriptorSet set_ = VK_NULL_HANDLE;
};

}  // namespace gnomon
