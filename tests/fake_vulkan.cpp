// What stands for Vulkan's loader and a device with rays in tests. It makes, copies and frees buffers, and traces nothing, so
// that masks are dark. The variable GNOMON_TEST_VULKAN says what it lacks and when it fails, in words with a space between two:
//   devices=0            there is none
//   lacks=EXTENSION      of the device
//   triangles=N          it takes into a tree
//   lost=FUNCTION:N      with the N-th call of vkFUNCTION it is lost: from then on all that may say so does
//   full=FUNCTION:N      in that call it is out of memory
//   hangs=FUNCTION:N     work that is handed over after that call is never done
//   once=FILE            a process fails only if it can make this file, so that one of several does
#define VK_NO_PROTOTYPES
#include <fcntl.h>
#include <unistd.h>
#include <vulkan/vulkan.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <map>
#include <sstream>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

namespace {

/// The words of the variable that begin with `key`= without it, the first one alone; empty: there is none.
std::string word(const std::string& key) {
  const char* const value = std::getenv("GNOMON_TEST_VULKAN");
  std::istringstream words(value ? value : "");
  for (std::string one; words >> one;)
    if (one.starts_with(key + "=")) return one.substr(key.size() + 1);
  return {};
}

bool is_lost = false, hangs = false;

/// Counts the call. Whether it is the one that this word names, and this the process that fails.
bool is_due(const std::string& key, std::string_view function, int call) {
  const std::string wanted = word(key);
  const std::size_t colon = wanted.find(':');
  if (colon == wanted.npos || wanted.substr(0, colon) != function || std::stoi(wanted.substr(colon + 1)) != call) return false;
  const std::string file = word("once");
  if (file.empty()) return true;
  const int made = open(file.c_str(), O_CREAT | O_EXCL | O_WRONLY, 0600);
  return made >= 0 && close(made) == 0;
}

/// At the begin of each function that words may name.
VkResult called(const std::string& function) {
  static std::map<std::string, int> calls;
  const int call = ++calls[function];
  is_lost = is_lost || is_due("lost", function, call);
  hangs = hangs || is_due("hangs", function, call);
  if (is_due("full", function, call)) return VK_ERROR_OUT_OF_DEVICE_MEMORY;
  return is_lost ? VK_ERROR_DEVICE_LOST : VK_SUCCESS;
}

/// What waits for the device.
VkResult waited() {
  while (hangs && !is_lost) pause();
  return is_lost ? VK_ERROR_DEVICE_LOST : VK_SUCCESS;
}

template <class Handle>
Handle handle(void* of) {
  return reinterpret_cast<Handle>(of);
}
template <class Handle>
Handle new_handle() {
  static std::uintptr_t last = 0;
  return reinterpret_cast<Handle>(++last * 16);
}

/// Does nothing, and that well.
template <class Function>
struct Nothing;
template <class Result, class... Arguments>
struct Nothing<Result (*)(Arguments...)> {
  static Result call(Arguments...) { return Result(); }
};

/// Makes one thing, to which the last argument points.
template <class Function>
struct Made;
template <class... Arguments>
struct Made<VkResult (*)(Arguments...)> {
  static VkResult call(Arguments... arguments) {
    auto* const made = std::get<sizeof...(Arguments) - 1>(std::tuple(arguments...));
    *made = new_handle<std::remove_pointer_t<decltype(made)>>();
    return VK_SUCCESS;
  }
};

using Memory = std::vector<std::byte>;
struct Buffer {
  std::size_t bytes;
  std::byte* data = nullptr;
};
Buffer& buffer(VkBuffer name) { return *reinterpret_cast<Buffer*>(name); }

VkResult create_instance(const VkInstanceCreateInfo*, const VkAllocationCallbacks*, VkInstance* instance) {
  *instance = new_handle<VkInstance>();
  return VK_SUCCESS;
}
VkResult instance_version(std::uint32_t* version) {
  *version = VK_API_VERSION_1_2;
  return VK_SUCCESS;
}
VkResult instance_extensions(const char*, std::uint32_t* count, VkExtensionProperties*) {
  *count = 0;
  return VK_SUCCESS;
}
VkResult devices(VkInstance, std::uint32_t* count, VkPhysicalDevice* all) {
  *count = word("devices") == "0" ? 0 : 1;
  if (all && *count == 1) *all = new_handle<VkPhysicalDevice>();
  return VK_SUCCESS;
}
VkResult device_extensions(VkPhysicalDevice, const char*, std::uint32_t* count, VkExtensionProperties* all) {
  std::vector<const char*> names{VK_KHR_ACCELERATION_STRUCTURE_EXTENSION_NAME, VK_KHR_DEFERRED_HOST_OPERATIONS_EXTENSION_NAME,
                                 VK_KHR_RAY_TRACING_PIPELINE_EXTENSION_NAME, VK_KHR_RAY_QUERY_EXTENSION_NAME};
  const std::string lacking = word("lacks");
  std::erase_if(names, [&](const char* name) { return lacking == name; });
  *count = static_cast<std::uint32_t>(names.size());
  for (std::size_t k = 0; all && k < names.size(); ++k) std::strcpy(all[k].extensionName, names[k]);
  return VK_SUCCESS;
}

void device_properties(VkPhysicalDevice, VkPhysicalDeviceProperties2* all) {
  all->properties.apiVersion = VK_API_VERSION_1_2;
  all->properties.deviceType = VK_PHYSICAL_DEVICE_TYPE_CPU;
  std::strcpy(all->properties.deviceName, "Abacus");
  all->properties.limits.maxStorageBufferRange = 1 << 30;
  all->properties.limits.timestampPeriod = 1;
  for (auto* next = static_cast<VkBaseOutStructure*>(all->pNext); next; next = next->pNext) {
    if (next->sType == VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES) {
      auto& driver = *reinterpret_cast<VkPhysicalDeviceDriverProperties*>(next);
      std::strcpy(driver.driverName, "beads");
      std::strcpy(driver.driverInfo, "1");
    } else if (next->sType == VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_ACCELERATION_STRUCTURE_PROPERTIES_KHR) {
      auto& limits = *reinterpret_cast<VkPhysicalDeviceAccelerationStructurePropertiesKHR*>(next);
      const std::string triangles = word("triangles");
      limits.maxPrimitiveCount = triangles.empty() ? 1 << 29 : std::stoull(triangles);
      limits.minAccelerationStructureScratchOffsetAlignment = 128;
    } else if (next->sType == VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_RAY_TRACING_PIPELINE_PROPERTIES_KHR) {
      auto& limits = *reinterpret_cast<VkPhysicalDeviceRayTracingPipelinePropertiesKHR*>(next);
      limits.shaderGroupHandleSize = limits.shaderGroupHandleAlignment = 32;
      limits.shaderGroupBaseAlignment = 64;
    }
  }
}
void memory_properties(VkPhysicalDevice, VkPhysicalDeviceMemoryProperties* memory) {
  *memory = {};
  memory->memoryTypeCount = memory->memoryHeapCount = 1;
  memory->memoryTypes[0].propertyFlags = VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT | VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT |
                                         VK_MEMORY_PROPERTY_HOST_COHERENT_BIT | VK_MEMORY_PROPERTY_HOST_CACHED_BIT;
}
/// One, which computes and has no clock.
void queue_families(VkPhysicalDevice, std::uint32_t* count, VkQueueFamilyProperties* families) {
  *count = 1;
  if (families) families->queueFlags = VK_QUEUE_COMPUTE_BIT;
}

VkResult create_device(VkPhysicalDevice, const VkDeviceCreateInfo*, const VkAllocationCallbacks*, VkDevice* device) {
  *device = new_handle<VkDevice>();
  return called("CreateDevice");
}
void device_queue(VkDevice, std::uint32_t, std::uint32_t, VkQueue* queue) { *queue = new_handle<VkQueue>(); }

VkResult allocate(VkDevice, const VkMemoryAllocateInfo* info, const VkAllocationCallbacks*, VkDeviceMemory* memory) {
  const VkResult result = called("AllocateMemory");
  // What is left there after an error is nothing to free.
  *memory = result == VK_SUCCESS ? handle<VkDeviceMemory>(new Memory(info->allocationSize)) : new_handle<VkDeviceMemory>();
  return result;
}
void free_memory(VkDevice, VkDeviceMemory memory, const VkAllocationCallbacks*) { delete reinterpret_cast<Memory*>(memory); }
VkResult map(VkDevice, VkDeviceMemory memory, VkDeviceSize, VkDeviceSize, VkMemoryMapFlags, void** data) {
  *data = reinterpret_cast<Memory*>(memory)->data();
  return VK_SUCCESS;
}
VkResult create_buffer(VkDevice, const VkBufferCreateInfo* info, const VkAllocationCallbacks*, VkBuffer* made) {
  *made = handle<VkBuffer>(new Buffer{info->size});
  return VK_SUCCESS;
}
void destroy_buffer(VkDevice, VkBuffer name, const VkAllocationCallbacks*) { delete &buffer(name); }
void buffer_needs(VkDevice, VkBuffer name, VkMemoryRequirements* needs) { *needs = {buffer(name).bytes, 16, 1}; }
VkResult bind_buffer(VkDevice, VkBuffer name, VkDeviceMemory memory, VkDeviceSize offset) {
  buffer(name).data = reinterpret_cast<Memory*>(memory)->data() + offset;
  return VK_SUCCESS;
}
VkDeviceAddress buffer_address(VkDevice, const VkBufferDeviceAddressInfo* info) {
  return reinterpret_cast<VkDeviceAddress>(buffer(info->buffer).data);
}

VkResult create_pipeline(VkDevice, VkDeferredOperationKHR, VkPipelineCache, std::uint32_t,
                         const VkRayTracingPipelineCreateInfoKHR*, const VkAllocationCallbacks*, VkPipeline* made) {
  *made = new_handle<VkPipeline>();
  return called("CreateRayTracingPipelinesKHR");
}
VkResult group_handles(VkDevice, VkPipeline, std::uint32_t, std::uint32_t, std::size_t bytes, void* data) {
  std::memset(data, 0, bytes);
  return VK_SUCCESS;
}
void tree_sizes(VkDevice, VkAccelerationStructureBuildTypeKHR, const VkAccelerationStructureBuildGeometryInfoKHR*,
                const std::uint32_t* counts, VkAccelerationStructureBuildSizesInfoKHR* sizes) {
  sizes->accelerationStructureSize = sizes->buildScratchSize = sizes->updateScratchSize = 256 + 64 * VkDeviceSize{*counts};
}
VkDeviceAddress tree_address(VkDevice, const VkAccelerationStructureDeviceAddressInfoKHR*) { return 256; }

// Commands are carried out while they are recorded.
void copy_buffer(VkCommandBuffer, VkBuffer from, VkBuffer to, std::uint32_t count, const VkBufferCopy* regions) {
  for (std::uint32_t k = 0; k < count; ++k)
    std::memcpy(buffer(to).data + regions[k].dstOffset, buffer(from).data + regions[k].srcOffset, regions[k].size);
}
void build_trees(VkCommandBuffer, std::uint32_t, const VkAccelerationStructureBuildGeometryInfoKHR*,
                 const VkAccelerationStructureBuildRangeInfoKHR* const*) {
  called("CmdBuildAccelerationStructuresKHR");
}
void trace_rays(VkCommandBuffer, const VkStridedDeviceAddressRegionKHR*, const VkStridedDeviceAddressRegionKHR*,
                const VkStridedDeviceAddressRegionKHR*, const VkStridedDeviceAddressRegionKHR*, std::uint32_t, std::uint32_t,
                std::uint32_t) {
  called("CmdTraceRaysKHR");
}
void dispatch(VkCommandBuffer, std::uint32_t, std::uint32_t, std::uint32_t) { called("CmdDispatch"); }

VkResult submit(VkQueue, std::uint32_t, const VkSubmitInfo*, VkFence) { return called("QueueSubmit"); }
VkResult wait_for_fences(VkDevice, std::uint32_t, const VkFence*, VkBool32, std::uint64_t) { return waited(); }
VkResult wait_for_queue(VkQueue) { return waited(); }
VkResult wait_for_device(VkDevice) { return waited(); }
/// The size of a compact tree.
VkResult query_results(VkDevice, VkQueryPool, std::uint32_t, std::uint32_t, std::size_t, void* data, VkDeviceSize,
                       VkQueryResultFlags) {
  const std::uint64_t bytes = 256;
  std::memcpy(data, &bytes, sizeof bytes);
  return waited();
}

PFN_vkVoidFunction of_device(VkDevice, const char* name);
PFN_vkVoidFunction of_instance(VkInstance, const char* name);

const std::map<std::string_view, PFN_vkVoidFunction>& functions() {
#define GNOMON_FAKE(name, function) \
  { "vk" #name, reinterpret_cast<PFN_vkVoidFunction>(static_cast<PFN_vk##name>(function)) }
#define GNOMON_FAKE_MADE(name) GNOMON_FAKE(name, Made<PFN_vk##name>::call)
#define GNOMON_FAKE_NOTHING(name) GNOMON_FAKE(name, Nothing<PFN_vk##name>::call)
  static const auto* const all =
      new std::map<std::string_view, PFN_vkVoidFunction>{GNOMON_FAKE(CreateInstance, create_instance),
                                                         GNOMON_FAKE(EnumerateInstanceExtensionProperties, instance_extensions),
                                                         GNOMON_FAKE(EnumerateInstanceVersion, instance_version),
                                                         GNOMON_FAKE(CreateDevice, create_device),
                                                         GNOMON_FAKE(EnumerateDeviceExtensionProperties, device_extensions),
                                                         GNOMON_FAKE(EnumeratePhysicalDevices, devices),
                                                         GNOMON_FAKE(GetDeviceProcAddr, of_device),
                                                         GNOMON_FAKE(GetPhysicalDeviceMemoryProperties, memory_properties),
                                                         GNOMON_FAKE(GetPhysicalDeviceProperties2, device_properties),
                                                         GNOMON_FAKE(GetPhysicalDeviceQueueFamilyProperties, queue_families),
                                                         GNOMON_FAKE(AllocateMemory, allocate),
                                                         GNOMON_FAKE(BindBufferMemory, bind_buffer),
                                                         GNOMON_FAKE(CmdBuildAccelerationStructuresKHR, build_trees),
                                                         GNOMON_FAKE(CmdCopyBuffer, copy_buffer),
                                                         GNOMON_FAKE(CmdDispatch, dispatch),
                                                         GNOMON_FAKE(CmdTraceRaysKHR, trace_rays),
                                                         GNOMON_FAKE(CreateBuffer, create_buffer),
                                                         GNOMON_FAKE(CreateRayTracingPipelinesKHR, create_pipeline),
                                                         GNOMON_FAKE(DestroyBuffer, destroy_buffer),
                                                         GNOMON_FAKE(DeviceWaitIdle, wait_for_device),
                                                         GNOMON_FAKE(FreeMemory, free_memory),
                                                         GNOMON_FAKE(GetAccelerationStructureBuildSizesKHR, tree_sizes),
                                                         GNOMON_FAKE(GetAccelerationStructureDeviceAddressKHR, tree_address),
                                                         GNOMON_FAKE(GetBufferDeviceAddress, buffer_address),
                                                         GNOMON_FAKE(GetBufferMemoryRequirements, buffer_needs),
                                                         GNOMON_FAKE(GetDeviceQueue, device_queue),
                                                         GNOMON_FAKE(GetQueryPoolResults, query_results),
                                                         GNOMON_FAKE(GetRayTracingShaderGroupHandlesKHR, group_handles),
                                                         GNOMON_FAKE(MapMemory, map),
                                                         GNOMON_FAKE(QueueSubmit, submit),
                                                         GNOMON_FAKE(QueueWaitIdle, wait_for_queue),
                                                         GNOMON_FAKE(WaitForFences, wait_for_fences),
                                                         GNOMON_FAKE_MADE(AllocateCommandBuffers),
                                                         GNOMON_FAKE_MADE(AllocateDescriptorSets),
                                                         GNOMON_FAKE_MADE(CreateAccelerationStructureKHR),
                                                         GNOMON_FAKE_MADE(CreateCommandPool),
                                                         GNOMON_FAKE_MADE(CreateComputePipelines),
                                                         GNOMON_FAKE_MADE(CreateDescriptorPool),
                                                         GNOMON_FAKE_MADE(CreateDescriptorSetLayout),
                                                         GNOMON_FAKE_MADE(CreateFence),
                                                         GNOMON_FAKE_MADE(CreatePipelineLayout),
                                                         GNOMON_FAKE_MADE(CreateQueryPool),
                                                         GNOMON_FAKE_MADE(CreateShaderModule),
                                                         GNOMON_FAKE_NOTHING(BeginCommandBuffer),
                                                         GNOMON_FAKE_NOTHING(CmdBindDescriptorSets),
                                                         GNOMON_FAKE_NOTHING(CmdBindPipeline),
                                                         GNOMON_FAKE_NOTHING(CmdCopyAccelerationStructureKHR),
                                                         GNOMON_FAKE_NOTHING(CmdPipelineBarrier),
                                                         GNOMON_FAKE_NOTHING(CmdPushConstants),
                                                         GNOMON_FAKE_NOTHING(CmdResetQueryPool),
                                                         GNOMON_FAKE_NOTHING(CmdWriteAccelerationStructuresPropertiesKHR),
                                                         GNOMON_FAKE_NOTHING(DestroyAccelerationStructureKHR),
                                                         GNOMON_FAKE_NOTHING(DestroyCommandPool),
                                                         GNOMON_FAKE_NOTHING(DestroyDescriptorPool),
                                                         GNOMON_FAKE_NOTHING(DestroyDescriptorSetLayout),
                                                         GNOMON_FAKE_NOTHING(DestroyDevice),
                                                         GNOMON_FAKE_NOTHING(DestroyFence),
                                                         GNOMON_FAKE_NOTHING(DestroyInstance),
                                                         GNOMON_FAKE_NOTHING(DestroyPipeline),
                                                         GNOMON_FAKE_NOTHING(DestroyPipelineLayout),
                                                         GNOMON_FAKE_NOTHING(DestroyQueryPool),
                                                         GNOMON_FAKE_NOTHING(DestroyShaderModule),
                                                         GNOMON_FAKE_NOTHING(EndCommandBuffer),
                                                         GNOMON_FAKE_NOTHING(ResetFences),
                                                         GNOMON_FAKE_NOTHING(UpdateDescriptorSets)};
  return *all;
}

PFN_vkVoidFunction of_device(VkDevice, const char* name) {
  const auto found = functions().find(name);
  return found == functions().end() ? nullptr : found->second;
}
PFN_vkVoidFunction of_instance(VkInstance, const char* name) { return of_device(VK_NULL_HANDLE, name); }

}  // namespace

extern "C" {
PFN_vkVoidFunction vkGetInstanceProcAddr(VkInstance instance, const char* name) { return of_instance(instance, name); }
}
