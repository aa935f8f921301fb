#pragma once
#include <gnomon/kit/vulkan/vulkan.h>

#include "tracer.h"

namespace gnomon::vulkan_rays {

/// An acceleration structure with the buffer that it lies in.
class Tree {
 public:
  Tree() = default;
  Tree(std::size_t bytes, VkAccelerationStructureTypeKHR type);
  Tree(Tree&& other) noexcept { swap(other); }
  Tree& operator=(Tree&& other) noexcept {
    Tree(std::move(other)).swap(*this);
    return *this;
  }
  ~Tree();
  explicit operator bool() const { return name_ != VK_NULL_HANDLE; }
  const VkAccelerationStructureKHR& name() const { return name_; }
  VkDeviceAddress address() const;
  std::size_t bytes() const { return buffer_.bytes(); }

 private:
  void swap(Tree& other) noexcept {
    std::swap(buffer_, other.buffer_);
    std::swap(name_, other.name_);
  }
  VulkanBuffer buffer_;
  VkAccelerationStructureKHR name_ = VK_NULL_HANDLE;
};

/// All triangles that cast, in one tree, and a tree over that one, which shaders look up.
class Trees {
 public:
  void build(const Scene& scene, float scale, const BuildChoices& choices);
  void update(const Changes& changes);

  const Scene& scene() const { return *scene_; }
  float scale() const { return scale_; }
  const VkAccelerationStructureKHR& top() const { return top_.name(); }
  /// Of each mesh its first triangle that casts, how many do, and 1 where it has a curved shape.
  const VulkanBuffer& meshes() const { return meshes_; }
  Sizes sizes() const;

 private:
  void upload();
  void build_bottom(bool is_refit);
  void compact();
  void build_top();

  const Scene* scene_ = nullptr;
  float scale_ = 1;
  BuildChoices choices_;
  bool moves_ = false;
  std::uint32_t vertex_count_ = 0, triangle_count_ = 0;
  std::vector<std::size_t> first_vertices_;  // of each mesh
  VulkanBuffer positions_, corners_, meshes_, instance_, scratch_;
  Tree bottom_, top_;
  std::size_t built_bytes_ = 0;
};

}  // namespace gnomon::vulkan_rays
