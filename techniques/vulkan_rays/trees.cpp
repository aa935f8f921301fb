#ifdef GNOMON_VULKAN
#include "trees.h"

#include <gnomon/kit/geometry/refit.h>

namespace gnomon::vulkan_rays {

namespace {

constexpr VkBufferUsageFlags for_input = VK_BUFFER_USAGE_ACCELERATION_STRUCTURE_BUILD_INPUT_READ_ONLY_BIT_KHR |
                                         VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT;

template <class Value>
VulkanBuffer filled(const std::vector<Value>& values, VkBufferUsageFlags usage) {
  VulkanBuffer buffer(values.size() * sizeof(Value), usage);
  buffer.write(std::as_bytes(std::span(values)));
  return buffer;
}

std::vector<glm::vec3> scaled(const Mesh& mesh, float scale) {
  std::vector<glm::vec3> positions(mesh.positions.begin(), mesh.positions.end());
  for (glm::vec3& place : positions) place *= scale;
  return positions;
}

/// What was built is read by what comes next.
void wait_for_build(VkCommandBuffer commands) {
  auto barrier = vulkan_info<VkMemoryBarrier>(VK_STRUCTURE_TYPE_MEMORY_BARRIER);
  barrier.srcAccessMask = VK_ACCESS_ACCELERATION_STRUCTURE_WRITE_BIT_KHR;
  barrier.dstAccessMask = VK_ACCESS_ACCELERATION_STRUCTURE_READ_BIT_KHR;
  vulkan().CmdPipelineBarrier(commands, VK_PIPELINE_STAGE_ACCELERATION_STRUCTURE_BUILD_BIT_KHR,
                              VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, 0, 1, &barrier, 0, nullptr, 0, nullptr);
}

/// Room for a build, at the alignment that the device wants.
VkDeviceAddress scratch_in(VulkanBuffer& scratch, std::size_t bytes) {
  const std::size_t alignment = vulkan().structure_limits().minAccelerationStructureScratchOffsetAlignment;
  if (!scratch || scratch.bytes() < bytes + alignment) {
    scratch = {};  // before the new one comes
    scratch = VulkanBuffer(bytes + alignment, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT);
  }
  return (scratch.address() + alignment - 1) / alignment * alignment;
}

VkAccelerationStructureBuildSizesInfoKHR sizes_of(const VkAccelerationStructureBuildGeometryInfoKHR& info,
                                                  std::uint32_t count) {
  auto sizes =
      vulkan_info<VkAccelerationStructureBuildSizesInfoKHR>(VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_BUILD_SIZES_INFO_KHR);
  vulkan().GetAccelerationStructureBuildSizesKHR(vulkan().device(), VK_ACCELERATION_STRUCTURE_BUILD_TYPE_DEVICE_KHR, &info,
                                                 &count, &sizes);
  return sizes;
}

void build_now(const VkAccelerationStructureBuildGeometryInfoKHR& info, std::uint32_t count) {
  VkAccelerationStructureBuildRangeInfoKHR range{};
  range.primitiveCount = count;
  const VkAccelerationStructureBuildRangeInfoKHR* const ranges = &range;
  vulkan().submit([&](VkCommandBuffer commands) {
    vulkan().CmdBuildAccelerationStructuresKHR(commands, 1, &info, &ranges);
    wait_for_build(commands);
  });
}

}  // namespace

Tree::Tree(std::size_t bytes, VkAccelerationStructureTypeKHR type)
    : buffer_(bytes, VK_BUFFER_USAGE_ACCELERATION_STRUCTURE_STORAGE_BIT_KHR | VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT) {
  auto info = vulkan_info<VkAccelerationStructureCreateInfoKHR>(VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_CREATE_INFO_KHR);
  info.buffer = buffer_.name();
  info.size = bytes;
  info.type = type;
  Vulkan::check(vulkan().CreateAccelerationStructureKHR(vulkan().device(), &info, nullptr, &name_),
                "an acceleration structure");
}

Tree::~Tree() {
  if (name_) vulkan().DestroyAccelerationStructureKHR(vulkan().device(), name_, nullptr);
}

VkDeviceAddress Tree::address() const {
  auto info = vulkan_info<VkAccelerationStructureDeviceAddressInfoKHR>(
      VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_DEVICE_ADDRESS_INFO_KHR);
  info.accelerationStructure = name_;
  return vulkan().GetAccelerationStructureDeviceAddressKHR(vulkan().device(), &info);
}

void Trees::build(const Scene& scene, float scale, const BuildChoices& choices) {
  *this = {};
  scene_ = &scene;
  scale_ = scale;
  choices_ = choices;
  moves_ = follows_animation(scene);
  upload();
  if (triangle_count_ > 0) {
    build_bottom(false);
    if (choices_.compacts) compact();
  }
  build_top();
  if (!moves_) scratch_ = {};
}

void Trees::upload() {
  std::vector<glm::vec3> positions;
  std::vector<glm::uvec3> corners;
  std::vector<glm::uvec4> meshes;
  for (const Mesh& mesh : scene_->meshes) {
    const auto first = static_cast<std::uint32_t>(positions.size());
    first_vertices_.push_back(first);
    const auto count = static_cast<std::uint32_t>(mesh.casts ? mesh.triangles.size() : 0);
    meshes.emplace_back(static_cast<std::uint32_t>(corners.size()), count, mesh.has_curved_shape() ? 1 : 0, 0);
    if (count == 0) continue;
    const std::vector<glm::vec3> places = scaled(mesh, scale_);
    positions.insert(positions.end(), places.begin(), places.end());
    for (const glm::uvec3& triangle : mesh.triangles) corners.push_back(triangle + first);
  }
  vertex_count_ = static_cast<std::uint32_t>(positions.size());
  triangle_count_ = static_cast<std::uint32_t>(corners.size());
  positions_ = filled(positions, for_input);
  corners_ = filled(corners, for_input);
  meshes_ = filled(meshes, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT);
}

void Trees::build_bottom(bool is_refit) {
  auto geometry = vulkan_info<VkAccelerationStructureGeometryKHR>(VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_KHR);
  geometry.geometryType = VK_GEOMETRY_TYPE_TRIANGLES_KHR;
  auto& triangles = geometry.geometry.triangles;
  triangles.sType = VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_TRIANGLES_DATA_KHR;
  triangles.vertexFormat = VK_FORMAT_R32G32B32_SFLOAT;
  triangles.vertexData.deviceAddress = positions_.address();
  triangles.vertexStride = sizeof(glm::vec3);
  triangles.maxVertex = vertex_count_ - 1;
  triangles.indexType = VK_INDEX_TYPE_UINT32;
  triangles.indexData.deviceAddress = corners_.address();
  auto info = vulkan_info<VkAccelerationStructureBuildGeometryInfoKHR>(
      VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_BUILD_GEOMETRY_INFO_KHR);
  info.type = VK_ACCELERATION_STRUCTURE_TYPE_BOTTOM_LEVEL_KHR;
  info.flags = choices_.is_fast_to_trace ? VK_BUILD_ACCELERATION_STRUCTURE_PREFER_FAST_TRACE_BIT_KHR
                                         : VK_BUILD_ACCELERATION_STRUCTURE_PREFER_FAST_BUILD_BIT_KHR;
  if (choices_.compacts) info.flags |= VK_BUILD_ACCELERATION_STRUCTURE_ALLOW_COMPACTION_BIT_KHR;
  if (moves_ && choices_.refits) info.flags |= VK_BUILD_ACCELERATION_STRUCTURE_ALLOW_UPDATE_BIT_KHR;
  info.geometryCount = 1;
  info.pGeometries = &geometry;
  const auto sizes = sizes_of(info, triangle_count_);
  if (is_refit) {
    info.mode = VK_BUILD_ACCELERATION_STRUCTURE_MODE_UPDATE_KHR;
    info.srcAccelerationStructure = bottom_.name();
  } else {
    bottom_ = {};  // before the new one comes
    bottom_ = Tree(sizes.accelerationStructureSize, VK_ACCELERATION_STRUCTURE_TYPE_BOTTOM_LEVEL_KHR);
    built_bytes_ = bottom_.bytes();
  }
  info.dstAccelerationStructure = bottom_.name();
  info.scratchData.deviceAddress = scratch_in(scratch_, is_refit ? sizes.updateScratchSize : sizes.buildScratchSize);
  build_now(info, triangle_count_);
}

void Trees::compact() {
  const Vulkan& v = vulkan();
  auto info = vulkan_info<VkQueryPoolCreateInfo>(VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO);
  info.queryType = VK_QUERY_TYPE_ACCELERATION_STRUCTURE_COMPACTED_SIZE_KHR;
  info.queryCount = 1;
  VkQueryPool pool = VK_NULL_HANDLE;
  Vulkan::check(v.CreateQueryPool(v.device(), &info, nullptr, &pool), "a pool of queries");
  v.submit([&](VkCommandBuffer commands) {
    v.CmdResetQueryPool(commands, pool, 0, 1);
    v.CmdWriteAccelerationStructuresPropertiesKHR(commands, 1, &bottom_.name(), info.queryType, pool, 0);
  });
  VkDeviceSize bytes = 0;
  const VkResult found = v.GetQueryPoolResults(v.device(), pool, 0, 1, sizeof bytes, &bytes, sizeof bytes,
                                               VK_QUERY_RESULT_64_BIT | VK_QUERY_RESULT_WAIT_BIT);
  v.DestroyQueryPool(v.device(), pool, nullptr);
  Vulkan::check(found, "the size of a compact tree");
  Tree compacted(bytes, VK_ACCELERATION_STRUCTURE_TYPE_BOTTOM_LEVEL_KHR);
  auto copy = vulkan_info<VkCopyAccelerationStructureInfoKHR>(VK_STRUCTURE_TYPE_COPY_ACCELERATION_STRUCTURE_INFO_KHR);
  copy.src = bottom_.name();
  copy.dst = compacted.name();
  copy.mode = VK_COPY_ACCELERATION_STRUCTURE_MODE_COMPACT_KHR;
  v.submit([&](VkCommandBuffer commands) {
    v.CmdCopyAccelerationStructureKHR(commands, &copy);
    wait_for_build(commands);
  });
  bottom_ = std::move(compacted);
}

void Trees::build_top() {
  VkAccelerationStructureInstanceKHR instance{};
  for (int k = 0; k < 3; ++k) instance.transform.matrix[k][k] = 1;
  instance.mask = 0xff;
  instance.flags = VK_GEOMETRY_INSTANCE_TRIANGLE_FACING_CULL_DISABLE_BIT_KHR;
  instance.accelerationStructureReference = bottom_ ? bottom_.address() : 0;
  if (!instance_) instance_ = VulkanBuffer(sizeof instance, for_input);
  instance_.write(std::as_bytes(std::span(&instance, 1)));
  auto geometry = vulkan_info<VkAccelerationStructureGeometryKHR>(VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_KHR);
  geometry.geometryType = VK_GEOMETRY_TYPE_INSTANCES_KHR;
  geometry.geometry.instances.sType = VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_INSTANCES_DATA_KHR;
  geometry.geometry.instances.data.deviceAddress = instance_.address();
  auto info = vulkan_info<VkAccelerationStructureBuildGeometryInfoKHR>(
      VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_BUILD_GEOMETRY_INFO_KHR);
  info.type = VK_ACCELERATION_STRUCTURE_TYPE_TOP_LEVEL_KHR;
  info.flags = VK_BUILD_ACCELERATION_STRUCTURE_PREFER_FAST_TRACE_BIT_KHR;
  info.geometryCount = 1;
  info.pGeometries = &geometry;
  const std::uint32_t count = bottom_ ? 1 : 0;
  const auto sizes = sizes_of(info, count);
  if (!top_) top_ = Tree(sizes.accelerationStructureSize, VK_ACCELERATION_STRUCTURE_TYPE_TOP_LEVEL_KHR);
  info.dstAccelerationStructure = top_.name();
  info.scratchData.deviceAddress = scratch_in(scratch_, sizes.buildScratchSize);
  build_now(info, count);
}

void Trees::update(const Changes& changes) {
  if (!moves_) return build(*scene_, scale_, choices_);
  if (!has_moved_caster(*scene_, changes)) return;
  for (std::uint32_t m = 0; m < scene_->meshes.size(); ++m) {
    const Mesh& mesh = scene_->meshes[m];
    if (!mesh.casts || mesh.triangles.empty() || !has_moved(changes, m)) continue;
    const std::vector<glm::vec3> places = scaled(mesh, scale_);
    positions_.write(std::as_bytes(std::span(places)), first_vertices_[m] * sizeof(glm::vec3));
  }
  build_bottom(choices_.refits);
  if (!choices_.refits && choices_.compacts) compact();
  build_top();
}

Sizes Trees::sizes() const {
  const std::size_t trees = (bottom_ ? bottom_.bytes() : 0) + (top_ ? top_.bytes() : 0);
  return {.triangles = triangle_count_,
          .tree_bytes = trees,
          .built_bytes = built_bytes_ + (top_ ? top_.bytes() : 0),
          .bytes = trees + positions_.bytes() + corners_.bytes() + meshes_.bytes() + instance_.bytes() + scratch_.bytes()};
}

}  // namespace gnomon::vulkan_rays
#endif
