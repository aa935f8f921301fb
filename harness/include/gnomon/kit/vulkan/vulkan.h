#pragma once
// Only where GNOMON_VULKAN is defined: where Vulkan's headers and the compiler of shaders were there when this was built.
#define VK_NO_PROTOTYPES
#include <gnomon/error.h>
#include <gnomon/gbuffer.h>
#include <gnomon/kit/vulkan/current.h>
#include <gnomon/kit/vulkan/functions.h>

#include <functional>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

namespace gnomon {

/// Which devices may be taken: those that are a processor, others, or either, others first.
enum class VulkanChoice { any, processor, card };

/// The device is lost, or has no memory left: it may be another time.
struct VulkanFailure : Error {
  using Error::Error;
};

/// A Vulkan device with acceleration structures, its one queue, and the functions of Vulkan under their own names. The loader
/// is opened by name, so that programs without Vulkan do not need it. Calls come from one thread.
class Vulkan : public VulkanFunctions {
 public:
  /// Throws Error with what is missing: the loader, a driver, a device of the choice, an extension. Throws VulkanFailure where
  /// a device has all that and cannot be made.
  explicit Vulkan(VulkanChoice choice);
  ~Vulkan();
  Vulkan(const Vulkan&) = delete;
  Vulkan& operator=(const Vulkan&) = delete;

  VkDevice device() const { return device_; }
  VkPhysicalDevice physical_device() const { return physical_; }
  const VkPhysicalDeviceProperties& properties() const { return properties_; }
  const VkPhysicalDeviceAccelerationStructurePropertiesKHR& structure_limits() const { return structures_; }
  const VkPhysicalDeviceRayTracingPipelinePropertiesKHR& pipeline_limits() const { return pipelines_; }
  const std::string& driver() const { return driver_; }  ///< name and version
  bool has_pipelines() const { return has_pipelines_; }  ///< of rays
  bool has_queries() const { return has_queries_; }      ///< of rays, from other shaders
  bool has_clock() const { return clock_bits_ > 0; }
  bool is_processor() const { return properties_.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU; }
  /// Nanoseconds from one timestamp to a later one.
  double nanoseconds(std::uint64_t from, std::uint64_t to) const;

  /// Throws Error where the result is an error, "what: the device is lost (VkResult -4)": VulkanFailure where the device is
  /// lost or there is no memory.
  static void check(VkResult result, const char* what);
  /// The same of a call that makes something. Where it fails `made` is null, whatever the driver left there.
  template <class Handle>
  static void check_made(VkResult result, Handle& made, const char* what) {
    if (result < 0) made = VK_NULL_HANDLE;
    check(result, what);
  }
  /// Records commands, hands them over and waits until they are done.
  void submit(const std::function<void(VkCommandBuffer)>& record) const;
  /// Commands to hand over again and again, each time when they are done. They live as long as the device.
  VkCommandBuffer recorded(const std::function<void(VkCommandBuffer)>& record) const;
  /// Hands them over behind all that was handed over before, and does not wait.
  void hand_over(VkCommandBuffer commands) const;
  /// Waits for all of it.
  void finish() const;
  /// What the layers have found wrong since the last call, where some are loaded; empty: nothing.
  std::string take_messages() const;

 private:
  void open_loader();
  void make_instance();
  void choose(VulkanChoice choice);
  void make_device();
  VkCommandBuffer new_commands() const;
  void record_into(VkCommandBuffer commands, VkCommandBufferUsageFlags usage,
                   const std::function<void(VkCommandBuffer)>& record) const;
  void destroy();

  void* loader_ = nullptr;
  VkInstance instance_ = VK_NULL_HANDLE;
  VkDebugUtilsMessengerEXT messenger_ = VK_NULL_HANDLE;
  VkPhysicalDevice physical_ = VK_NULL_HANDLE;
  VkDevice device_ = VK_NULL_HANDLE;
  VkQueue queue_ = VK_NULL_HANDLE;
  VkCommandPool pool_ = VK_NULL_HANDLE;
  VkCommandBuffer commands_ = VK_NULL_HANDLE;
  VkFence fence_ = VK_NULL_HANDLE;
  std::uint32_t family_ = 0, clock_bits_ = 0;
  bool has_pipelines_ = false, has_queries_ = false;
  VkPhysicalDeviceProperties properties_{};
  VkPhysicalDeviceAccelerationStructurePropertiesKHR structures_{};
  VkPhysicalDeviceRayTracingPipelinePropertiesKHR pipelines_{};
  std::string driver_;
  mutable std::string messages_;
};

/// The current one. Throws Error where there is none.
const Vulkan& vulkan();

/// A buffer with memory of its own, of the current device.
class VulkanBuffer {
 public:
  enum class Lies { on_device, in_host_memory };  ///< the latter can be mapped
  VulkanBuffer() = default;
  /// At least 16 bytes, for none can have 0. Throws Error where there is no room.
  VulkanBuffer(std::size_t bytes, VkBufferUsageFlags usage, Lies lies = Lies::on_device);
  VulkanBuffer(VulkanBuffer&& other) noexcept { swap(other); }
  VulkanBuffer& operator=(VulkanBuffer&& other) noexcept {
    VulkanBuffer(std::move(other)).swap(*this);
    return *this;
  }
  ~VulkanBuffer();

  explicit operator bool() const { return buffer_ != VK_NULL_HANDLE; }
  VkBuffer name() const { return buffer_; }
  std::size_t bytes() const { return bytes_; }
  /// On the device, of one with VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT.
  VkDeviceAddress address() const;
  /// In host memory: mapped from the beginning to the end.
  std::byte* data() const { return data_; }
  /// Writes bytes from `offset` on, by way of host memory, and waits. It needs VK_BUFFER_USAGE_TRANSFER_DST_BIT.
  void write(std::span<const std::byte> values, std::size_t offset = 0) const;
  /// All of it, by way of host memory. It needs VK_BUFFER_USAGE_TRANSFER_SRC_BIT.
  void read(std::span<std::byte> values) const;

 private:
  void swap(VulkanBuffer& other) noexcept;

  VkBuffer buffer_ = VK_NULL_HANDLE;
  VkDeviceMemory memory_ = VK_NULL_HANDLE;
  std::size_t bytes_ = 0;
  std::byte* data_ = nullptr;
};

/// A G-buffer on the device: of each pixel position and 1, of the background 0; normal, and 1 where its mesh receives, else 0;
/// mesh plus one and triangle.
struct VulkanGBuffer {
  VulkanBuffer position, normal, ids;  ///< vec4, vec4, uvec2
  double upload_ms = 0;
  std::size_t bytes() const { return position.bytes() + normal.bytes() + ids.bytes(); }
};

/// Of this picture, uploaded at the first call and kept until `forget_vulkan_gbuffers`. The harness calls it before the clock
/// of a stage starts.
const VulkanGBuffer& vulkan_gbuffer(const GBuffer& gbuffer, const Scene& scene);
void forget_vulkan_gbuffers();

}  // namespace gnomon
