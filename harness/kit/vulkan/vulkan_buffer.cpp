#ifdef GNOMON_VULKAN
#include <gnomon/error.h>
#include <gnomon/kit/vulkan/vulkan.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <memory>

#include "kit/gbuffer_texels.h"

namespace gnomon {

namespace {

constexpr std::size_t least_bytes = 16;

/// A kind of memory among `allowed` with these flags; of several the first, as drivers rank them.
std::optional<std::uint32_t> kind_of_memory(std::uint32_t allowed, VkMemoryPropertyFlags flags) {
  VkPhysicalDeviceMemoryProperties memory;
  vulkan().GetPhysicalDeviceMemoryProperties(vulkan().physical_device(), &memory);
  for (std::uint32_t k = 0; k < memory.memoryTypeCount; ++k)
    if ((allowed >> k & 1) && (memory.memoryTypes[k].propertyFlags & flags) == flags) return k;
  return std::nullopt;
}

std::uint32_t memory_for(std::uint32_t allowed, VulkanBuffer::Lies lies) {
  constexpr VkMemoryPropertyFlags mapped = VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
  const bool is_mapped = lies == VulkanBuffer::Lies::in_host_memory;
  constexpr VkMemoryPropertyFlags near = VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT,
                                  fast = mapped | VK_MEMORY_PROPERTY_HOST_CACHED_BIT;
  // Of what can be mapped, what the processor reads fast.
  if (const auto best = kind_of_memory(allowed, is_mapped ? fast : near)) return *best;
  if (const auto next = kind_of_memory(allowed, is_mapped ? mapped : 0)) return *next;
  throw Error("{} has no memory for a buffer", vulkan().properties().deviceName);
}

/// Copies so many bytes between two buffers, so that what follows sees them.
void copy(VkBuffer from, VkBuffer to, std::size_t bytes, std::size_t offset) {
  vulkan().submit([&](VkCommandBuffer commands) {
    const VkBufferCopy region{0, offset, bytes};
    vulkan().CmdCopyBuffer(commands, from, to, 1, &region);
    auto barrier = vulkan_info<VkMemoryBarrier>(VK_STRUCTURE_TYPE_MEMORY_BARRIER);
    barrier.srcAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT;
    barrier.dstAccessMask = VK_ACCESS_MEMORY_READ_BIT | VK_ACCESS_HOST_READ_BIT;
    vulkan().CmdPipelineBarrier(commands, VK_PIPELINE_STAGE_TRANSFER_BIT,
                                VK_PIPELINE_STAGE_ALL_COMMANDS_BIT | VK_PIPELINE_STAGE_HOST_BIT, 0, 1, &barrier, 0, nullptr, 0,
                                nullptr);
  });
}

std::vector<bool> receivers_of(const Scene& scene) {
  std::vector<bool> receivers;
  for (const Mesh& mesh : scene.meshes) receivers.push_back(mesh.receives);
  return receivers;
}

/// A weak pointer keeps the control block of the G-buffer's storage, so that no later G-buffer can be taken for this one.
/// Those on borrowed arrays (null storage) are never known again.
struct Slot {
  std::weak_ptr<const void> storage;
  const float* data = nullptr;
  std::size_t size = 0;
  std::vector<bool> receivers;
  VulkanGBuffer uploaded;

  bool holds(const GBuffer& g, const std::vector<bool>& of) const {
    return g.storage && data == g.px.data() && size == g.size() && receivers == of && !storage.owner_before(g.storage) &&
           !g.storage.owner_before(storage);
  }
};

/// How many G-buffers are held; the oldest goes first.
constexpr std::size_t slot_count = 4;

// Not destroyed at exit: the device may be gone by then.
std::vector<std::unique_ptr<Slot>>& slots() {
  static auto* const slots = new std::vector<std::unique_ptr<Slot>>;
  return *slots;
}

template <class Value>
VulkanBuffer uploaded(const std::vector<Value>& values) {
  VulkanBuffer buffer(values.size() * sizeof(Value), VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT);
  buffer.write(std::as_bytes(std::span(values)));
  return buffer;
}

VulkanGBuffer upload(const GBuffer& g, const Scene& scene) {
  const GBufferTexels texels(g, scene);
  const auto start = std::chrono::steady_clock::now();
  VulkanGBuffer result{uploaded(texels.positions), uploaded(texels.normals), uploaded(texels.ids)};
  result.upload_ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  return result;
}

}  // namespace

// What throws after the delegated constructor is cleaned up by the destructor.
VulkanBuffer::VulkanBuffer(std::size_t bytes, VkBufferUsageFlags usage, Lies lies) : VulkanBuffer() {
  bytes_ = std::max(bytes, least_bytes);
  const Vulkan& v = vulkan();
  auto info = vulkan_info<VkBufferCreateInfo>(VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO);
  info.size = bytes_;
  info.usage = usage;
  Vulkan::check_made(v.CreateBuffer(v.device(), &info, nullptr, &buffer_), buffer_, "a buffer");
  VkMemoryRequirements needed;
  v.GetBufferMemoryRequirements(v.device(), buffer_, &needed);
  auto flags = vulkan_info<VkMemoryAllocateFlagsInfo>(VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_FLAGS_INFO);
  flags.flags = VK_MEMORY_ALLOCATE_DEVICE_ADDRESS_BIT;
  auto allocation = vulkan_info<VkMemoryAllocateInfo>(VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO);
  allocation.pNext = usage & VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT ? &flags : nullptr;
  allocation.allocationSize = needed.size;
  allocation.memoryTypeIndex = memory_for(needed.memoryTypeBits, lies);
  Vulkan::check_made(v.AllocateMemory(v.device(), &allocation, nullptr, &memory_), memory_, "memory of a buffer");
  Vulkan::check(v.BindBufferMemory(v.device(), buffer_, memory_, 0), "memory of a buffer");
  if (lies == Lies::on_device) return;
  void* data = nullptr;
  Vulkan::check(v.MapMemory(v.device(), memory_, 0, VK_WHOLE_SIZE, 0, &data), "memory of a buffer");
  data_ = static_cast<std::byte*>(data);
}

VulkanBuffer::~VulkanBuffer() {
  const Vulkan* const v = current_vulkan();
  if (!v || !buffer_) return;
  v->DestroyBuffer(v->device(), buffer_, nullptr);
  v->FreeMemory(v->device(), memory_, nullptr);
}

void VulkanBuffer::swap(VulkanBuffer& other) noexcept {
  std::swap(buffer_, other.buffer_);
  std::swap(memory_, other.memory_);
  std::swap(bytes_, other.bytes_);
  std::swap(data_, other.data_);
}

VkDeviceAddress VulkanBuffer::address() const {
  auto info = vulkan_info<VkBufferDeviceAddressInfo>(VK_STRUCTURE_TYPE_BUFFER_DEVICE_ADDRESS_INFO);
  info.buffer = buffer_;
  return vulkan().GetBufferDeviceAddress(vulkan().device(), &info);
}

void VulkanBuffer::write(std::span<const std::byte> values, std::size_t offset) const {
  if (values.empty()) return;
  const VulkanBuffer staging(values.size(), VK_BUFFER_USAGE_TRANSFER_SRC_BIT, Lies::in_host_memory);
  std::memcpy(staging.data(), values.data(), values.size());
  copy(staging.name(), buffer_, values.size(), offset);
}

void VulkanBuffer::read(std::span<std::byte> values) const {
  const VulkanBuffer staging(values.size(), VK_BUFFER_USAGE_TRANSFER_DST_BIT, Lies::in_host_memory);
  copy(buffer_, staging.name(), values.size(), 0);
  std::memcpy(values.data(), staging.data(), values.size());
}

const VulkanGBuffer& vulkan_gbuffer(const GBuffer& gbuffer, const Scene& scene) {
  std::vector<bool> receivers = receivers_of(scene);
  for (const auto& slot : slots())
    if (slot->holds(gbuffer, receivers)) return slot->uploaded;
  if (slots().size() == slot_count) slots().erase(slots().begin());
  slots().push_back(std::make_unique<Slot>(
      Slot{gbuffer.storage, gbuffer.px.data(), gbuffer.size(), std::move(receivers), upload(gbuffer, scene)}));
  return slots().back()->uploaded;
}

void forget_vulkan_gbuffers() { slots().clear(); }

}  // namespace gnomon
#endif
