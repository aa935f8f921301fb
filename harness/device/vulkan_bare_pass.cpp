#ifdef GNOMON_VULKAN
#include "device/vulkan_bare_pass.h"

#include <gnomon/error.h>

#include "device/vulkan_fetch.comp.h"

namespace gnomon {

namespace {
constexpr std::uint32_t group_side = 8;  // of vulkan_fetch.comp
}

VulkanBarePass::VulkanBarePass(Floor floor, const Scene& scene, const GBuffer& gbuffer)
    : width_(static_cast<std::uint32_t>(gbuffer.width)),
      height_(static_cast<std::uint32_t>(gbuffer.height)),
      layout_(VK_SHADER_STAGE_COMPUTE_BIT, false, 3, 2 * sizeof(std::uint32_t)) {
  if (floor != Floor::fetch) throw Error("there is no bare pass {} by Vulkan; there is fetch", name(floor));
  const VulkanGBuffer& picture = vulkan_gbuffer(gbuffer, scene);
  values_ = VulkanBuffer(gbuffer.size() * sizeof(float), VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_SRC_BIT);
  bindings_ = VulkanBindings(layout_);
  const VkBuffer seen[] = {picture.position.name(), picture.normal.name(), values_.name()};
  bindings_.see(VK_NULL_HANDLE, seen);
  pipeline_ = layout_.compute_pipeline(vulkan_fetch_comp);
}

VulkanBarePass::~VulkanBarePass() {
  if (const Vulkan* const v = current_vulkan()) v->DestroyPipeline(v->device(), pipeline_, nullptr);
}

void VulkanBarePass::draw(int times) const {
  const Vulkan& v = vulkan();
  const auto groups = [](std::uint32_t pixels) { return (pixels + group_side - 1) / group_side; };
  v.submit([&](VkCommandBuffer commands) {
    const std::uint32_t size[] = {width_, height_};
    v.CmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, pipeline_);
    bindings_.bind(commands, VK_PIPELINE_BIND_POINT_COMPUTE, layout_);
    layout_.push(commands, size);
    auto barrier = vulkan_info<VkMemoryBarrier>(VK_STRUCTURE_TYPE_MEMORY_BARRIER);
    barrier.srcAccessMask = VK_ACCESS_SHADER_WRITE_BIT;
    barrier.dstAccessMask = VK_ACCESS_SHADER_WRITE_BIT | VK_ACCESS_TRANSFER_READ_BIT;
    for (int k = 0; k < times; ++k) {
      v.CmdDispatch(commands, groups(width_), groups(height_), 1);
      v.CmdPipelineBarrier(commands, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT,
                           VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_TRANSFER_BIT, 0, 1, &barrier, 0, nullptr, 0,
                           nullptr);
    }
  });
}

std::vector<float> VulkanBarePass::read() const {
  std::vector<float> values(std::size_t{width_} * height_);
  values_.read(std::as_writable_bytes(std::span(values)));
  return values;
}

}  // namespace gnomon
#endif
