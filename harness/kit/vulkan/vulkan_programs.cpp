#ifdef GNOMON_VULKAN
#include <gnomon/kit/vulkan/programs.h>

#include <utility>

namespace gnomon {

VulkanShader::VulkanShader(std::span<const std::uint32_t> words) {
  auto info = vulkan_info<VkShaderModuleCreateInfo>(VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO);
  info.codeSize = words.size_bytes();
  info.pCode = words.data();
  Vulkan::check(vulkan().CreateShaderModule(vulkan().device(), &info, nullptr, &name_), "a shader");
}

VulkanShader::~VulkanShader() { vulkan().DestroyShaderModule(vulkan().device(), name_, nullptr); }

VkPipelineShaderStageCreateInfo VulkanShader::as(VkShaderStageFlagBits stage) const {
  auto info = vulkan_info<VkPipelineShaderStageCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO);
  info.stage = stage;
  info.module = name_;
  info.pName = "main";
  return info;
}

VulkanLayout::VulkanLayout(VkShaderStageFlags stages, bool has_tree, std::uint32_t buffers, std::uint32_t constant_bytes)
    : stages_(stages), has_tree_(has_tree), buffers_(buffers), constant_bytes_(constant_bytes) {
  const Vulkan& v = vulkan();
  std::vector<VkDescriptorSetLayoutBinding> bindings(buffers + (has_tree ? 1 : 0));
  for (std::uint32_t k = 0; k < bindings.size(); ++k) {
    const bool is_tree = has_tree && k == 0;
    bindings[k].binding = k;
    bindings[k].descriptorType = is_tree ? VK_DESCRIPTOR_TYPE_ACCELERATION_STRUCTURE_KHR : VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
    bindings[k].descriptorCount = 1;
    bindings[k].stageFlags = stages;
  }
  auto set = vulkan_info<VkDescriptorSetLayoutCreateInfo>(VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO);
  set.bindingCount = static_cast<std::uint32_t>(bindings.size());
  set.pBindings = bindings.data();
  Vulkan::check(v.CreateDescriptorSetLayout(v.device(), &set, nullptr, &bindings_), "a layout of bindings");
  const VkPushConstantRange constants{stages, 0, constant_bytes};
  auto info = vulkan_info<VkPipelineLayoutCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO);
  info.setLayoutCount = 1;
  info.pSetLayouts = &bindings_;
  info.pushConstantRangeCount = 1;
  info.pPushConstantRanges = &constants;
  Vulkan::check(v.CreatePipelineLayout(v.device(), &info, nullptr, &layout_), "a layout of a pipeline");
}

VulkanLayout::VulkanLayout(VulkanLayout&& other) noexcept
    : stages_(other.stages_),
      has_tree_(other.has_tree_),
      buffers_(other.buffers_),
      constant_bytes_(other.constant_bytes_),
      bindings_(std::exchange(other.bindings_, VK_NULL_HANDLE)),
      layout_(std::exchange(other.layout_, VK_NULL_HANDLE)) {}

VulkanLayout::~VulkanLayout() {
  const Vulkan* const v = current_vulkan();
  if (!v || !layout_) return;
  v->DestroyPipelineLayout(v->device(), layout_, nullptr);
  v->DestroyDescriptorSetLayout(v->device(), bindings_, nullptr);
}

VkPipeline VulkanLayout::compute_pipeline(std::span<const std::uint32_t> words) const {
  const VulkanShader shader(words);
  auto info = vulkan_info<VkComputePipelineCreateInfo>(VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO);
  info.stage = shader.as(VK_SHADER_STAGE_COMPUTE_BIT);
  info.layout = layout_;
  const Vulkan& v = vulkan();
  VkPipeline pipeline = VK_NULL_HANDLE;
  Vulkan::check(v.CreateComputePipelines(v.device(), VK_NULL_HANDLE, 1, &info, nullptr, &pipeline), "a compute pipeline");
  return pipeline;
}

void VulkanLayout::push(VkCommandBuffer commands, const void* constants) const {
  vulkan().CmdPushConstants(commands, layout_, stages_, 0, constant_bytes_, constants);
}

VulkanBindings::VulkanBindings(const VulkanLayout& layout) {
  const Vulkan& v = vulkan();
  const VkDescriptorPoolSize sizes[] = {{VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, layout.buffers_},
                                        {VK_DESCRIPTOR_TYPE_ACCELERATION_STRUCTURE_KHR, 1}};
  auto pool = vulkan_info<VkDescriptorPoolCreateInfo>(VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO);
  pool.maxSets = 1;
  pool.poolSizeCount = layout.has_tree_ ? 2 : 1;
  pool.pPoolSizes = sizes;
  Vulkan::check(v.CreateDescriptorPool(v.device(), &pool, nullptr, &pool_), "a pool of bindings");
  auto set = vulkan_info<VkDescriptorSetAllocateInfo>(VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO);
  set.descriptorPool = pool_;
  set.descriptorSetCount = 1;
  set.pSetLayouts = &layout.bindings_;
  Vulkan::check(v.AllocateDescriptorSets(v.device(), &set, &set_), "a set of bindings");
}

VulkanBindings::~VulkanBindings() {
  if (const Vulkan* const v = current_vulkan(); v && pool_) v->DestroyDescriptorPool(v->device(), pool_, nullptr);
}

void VulkanBindings::see(VkAccelerationStructureKHR tree, std::span<const VkBuffer> buffers) const {
  auto structures = vulkan_info<VkWriteDescriptorSetAccelerationStructureKHR>(
      VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET_ACCELERATION_STRUCTURE_KHR);
  structures.accelerationStructureCount = 1;
  structures.pAccelerationStructures = &tree;
  std::vector<VkDescriptorBufferInfo> infos;
  for (const VkBuffer buffer : buffers) infos.push_back({buffer, 0, VK_WHOLE_SIZE});
  std::vector<VkWriteDescriptorSet> writes;
  const auto add = [&](VkDescriptorType type) -> VkWriteDescriptorSet& {
    auto write = vulkan_info<VkWriteDescriptorSet>(VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET);
    write.dstSet = set_;
    write.dstBinding = static_cast<std::uint32_t>(writes.size());
    write.descriptorCount = 1;
    write.descriptorType = type;
    return writes.emplace_back(write);
  };
  if (tree) add(VK_DESCRIPTOR_TYPE_ACCELERATION_STRUCTURE_KHR).pNext = &structures;
  for (const VkDescriptorBufferInfo& info : infos) add(VK_DESCRIPTOR_TYPE_STORAGE_BUFFER).pBufferInfo = &info;
  vulkan().UpdateDescriptorSets(vulkan().device(), static_cast<std::uint32_t>(writes.size()), writes.data(), 0, nullptr);
}

void VulkanBindings::bind(VkCommandBuffer commands, VkPipelineBindPoint point, const VulkanLayout& layout) const {
  vulkan().CmdBindDescriptorSets(commands, point, layout.name(), 0, 1, &set_, 0, nullptr);
}

}  // namespace gnomon
#endif
