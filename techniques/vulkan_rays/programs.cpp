#ifdef GNOMON_VULKAN
#include "programs.h"

#include <algorithm>
#include <cstring>
#include <iterator>
#include <utility>

#include "vulkan_rays/pipeline.rahit.h"
#include "vulkan_rays/pipeline.rgen.h"
#include "vulkan_rays/pipeline.rmiss.h"
#include "vulkan_rays/query.comp.h"

namespace gnomon::vulkan_rays {

namespace {

constexpr std::uint32_t group_side = 8;  // of query.comp

VkShaderStageFlags stages_of(Trace trace) {
  if (trace == Trace::query) return VK_SHADER_STAGE_COMPUTE_BIT;
  return VK_SHADER_STAGE_RAYGEN_BIT_KHR;
}

}  // namespace

Programs::Programs(Trace trace)
    : trace_(trace), layout_(stages_of(trace), true, buffer_count, static_cast<std::uint32_t>(sizeof(FrameConstants))) {
  if (trace == Trace::query) {
    pipeline_ = layout_.compute_pipeline(query_comp);
  } else {
    make_pipeline();
    make_table();
  }
}

Programs::Programs(Programs&& other) noexcept
    : trace_(other.trace_),
      layout_(std::move(other.layout_)),
      pipeline_(std::exchange(other.pipeline_, VK_NULL_HANDLE)),
      table_(std::move(other.table_)),
      regions_(other.regions_) {}

Programs::~Programs() {
  if (const Vulkan* const v = current_vulkan(); v && pipeline_) v->DestroyPipeline(v->device(), pipeline_, nullptr);
}

void Programs::make_pipeline() {
  const VulkanShader generation(pipeline_rgen), miss(pipeline_rmiss), any_hit(pipeline_rahit);
  const VkPipelineShaderStageCreateInfo stages[] = {generation.as(VK_SHADER_STAGE_RAYGEN_BIT_KHR),
                                                    miss.as(VK_SHADER_STAGE_MISS_BIT_KHR),
                                                    any_hit.as(VK_SHADER_STAGE_ANY_HIT_BIT_KHR)};
  std::array<VkRayTracingShaderGroupCreateInfoKHR, 3> groups{};
  for (std::uint32_t k = 0; k < groups.size(); ++k) {
    groups[k].sType = VK_STRUCTURE_TYPE_RAY_TRACING_SHADER_GROUP_CREATE_INFO_KHR;
    groups[k].type =
        k < 2 ? VK_RAY_TRACING_SHADER_GROUP_TYPE_GENERAL_KHR : VK_RAY_TRACING_SHADER_GROUP_TYPE_TRIANGLES_HIT_GROUP_KHR;
    groups[k].generalShader = k < 2 ? k : VK_SHADER_UNUSED_KHR;
    groups[k].closestHitShader = VK_SHADER_UNUSED_KHR;
    groups[k].anyHitShader = k < 2 ? VK_SHADER_UNUSED_KHR : k;
    groups[k].intersectionShader = VK_SHADER_UNUSED_KHR;
  }
  auto info = vulkan_info<VkRayTracingPipelineCreateInfoKHR>(VK_STRUCTURE_TYPE_RAY_TRACING_PIPELINE_CREATE_INFO_KHR);
  info.stageCount = static_cast<std::uint32_t>(std::size(stages));
  info.pStages = stages;
  info.groupCount = static_cast<std::uint32_t>(groups.size());
  info.pGroups = groups.data();
  info.maxPipelineRayRecursionDepth = 1;
  info.layout = layout_.name();
  const Vulkan& v = vulkan();
  Vulkan::check(v.CreateRayTracingPipelinesKHR(v.device(), VK_NULL_HANDLE, VK_NULL_HANDLE, 1, &info, nullptr, &pipeline_),
                "a ray tracing pipeline");
}

// One record for each of the three groups, each where a table may begin.
void Programs::make_table() {
  const Vulkan& v = vulkan();
  const auto& limits = v.pipeline_limits();
  const std::size_t handle = limits.shaderGroupHandleSize, base = limits.shaderGroupBaseAlignment;
  const std::size_t record = (handle + base - 1) / base * base;
  std::vector<std::byte> handles(3 * handle), table(4 * record);
  Vulkan::check(v.GetRayTracingShaderGroupHandlesKHR(v.device(), pipeline_, 0, 3, handles.size(), handles.data()),
                "the handles of shaders");
  table_ = VulkanBuffer(table.size(), VK_BUFFER_USAGE_SHADER_BINDING_TABLE_BIT_KHR | VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT |
                                          VK_BUFFER_USAGE_TRANSFER_DST_BIT);
  const VkDeviceAddress address = table_.address(), start = (address + base - 1) / base * base;
  for (std::size_t k = 0; k < 3; ++k) {
    std::memcpy(&table[start - address + k * record], &handles[k * handle], handle);
    regions_[k] = {start + k * record, record, record};
  }
  table_.write(table);
}

VkPipelineStageFlags Programs::stage() const {
  if (trace_ == Trace::query) return VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT;
  return VK_PIPELINE_STAGE_RAY_TRACING_SHADER_BIT_KHR;
}

void Programs::trace(VkCommandBuffer commands, const VulkanBindings& bindings, const FrameConstants& constants) const {
  const Vulkan& v = vulkan();
  const bool is_query = trace_ == Trace::query;
  const VkPipelineBindPoint point = is_query ? VK_PIPELINE_BIND_POINT_COMPUTE : VK_PIPELINE_BIND_POINT_RAY_TRACING_KHR;
  v.CmdBindPipeline(commands, point, pipeline_);
  bindings.bind(commands, point, layout_);
  layout_.push(commands, &constants);
  if (is_query) {
    const auto groups = [](std::uint32_t pixels) { return (pixels + group_side - 1) / group_side; };
    v.CmdDispatch(commands, groups(constants.width), groups(constants.height), 1);
  } else {
    v.CmdTraceRaysKHR(commands, &regions_[0], &regions_[1], &regions_[2], &regions_[3], constants.width, constants.height, 1);
  }
}

}  // namespace gnomon::vulkan_rays
#endif
