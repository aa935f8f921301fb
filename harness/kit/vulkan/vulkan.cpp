#ifdef GNOMON_VULKAN
#include <dlfcn.h>
#include <gnomon/error.h>
#include <gnomon/kit/vulkan/vulkan.h>

#include <algorithm>
#include <cmath>
#include <cstring>

namespace gnomon {

namespace {

constexpr const char* debug_extension = VK_EXT_DEBUG_UTILS_EXTENSION_NAME;
constexpr const char* pipeline_extension = VK_KHR_RAY_TRACING_PIPELINE_EXTENSION_NAME;
constexpr const char* query_extension = VK_KHR_RAY_QUERY_EXTENSION_NAME;
/// Those without which there are no rays.
constexpr const char* needed_extensions[] = {VK_KHR_ACCELERATION_STRUCTURE_EXTENSION_NAME,
                                             VK_KHR_DEFERRED_HOST_OPERATIONS_EXTENSION_NAME};
constexpr std::uint32_t least_version = VK_API_VERSION_1_2;

/// All that a function of Vulkan lists: f(&count, nullptr), then f(&count, places).
template <class Listed, class List>
std::vector<Listed> listed(const List& list, const Listed& empty = {}) {
  std::uint32_t count = 0;
  Vulkan::check(list(&count, nullptr), "a list of Vulkan");
  std::vector<Listed> all(count, empty);
  Vulkan::check(list(&count, all.data()), "a list of Vulkan");
  all.resize(count);
  return all;
}

bool has(const std::vector<VkExtensionProperties>& all, std::string_view name) {
  return std::ranges::any_of(all, [&](const VkExtensionProperties& one) { return name == one.extensionName; });
}

VKAPI_ATTR VkBool32 VKAPI_CALL note_message(VkDebugUtilsMessageSeverityFlagBitsEXT, VkDebugUtilsMessageTypeFlagsEXT,
                                            const VkDebugUtilsMessengerCallbackDataEXT* data, void* messages) {
  auto& all = *static_cast<std::string*>(messages);
  if (all.size() < 4000) all += std::string(all.empty() ? "" : "\n") + data->pMessage;
  return VK_FALSE;
}

std::string_view name(VkResult result) {
  switch (result) {
    case VK_ERROR_DEVICE_LOST:
      return "the device is lost";
    case VK_ERROR_OUT_OF_HOST_MEMORY:
      return "out of memory";
    case VK_ERROR_OUT_OF_DEVICE_MEMORY:
      return "out of memory of the device";
    case VK_ERROR_INCOMPATIBLE_DRIVER:
      return "no driver can be used";
    case VK_ERROR_INITIALIZATION_FAILED:
      return "it cannot be made ready";
    case VK_ERROR_FEATURE_NOT_PRESENT:
      return "the driver names rays among its extensions and has them turned off";
    case VK_ERROR_LAYER_NOT_PRESENT:
      return "a layer that is asked for is not there";
    default:
      return "an error";
  }
}

/// Of a device that has all that is asked for.
bool is_failure(VkResult result) {
  return result == VK_ERROR_DEVICE_LOST || result == VK_ERROR_OUT_OF_HOST_MEMORY || result == VK_ERROR_OUT_OF_DEVICE_MEMORY;
}

/// How willingly a device is taken: the higher, the rather.
int rank(const VkPhysicalDeviceProperties& properties) {
  switch (properties.deviceType) {
    case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU:
      return 3;
    case VK_PHYSICAL_DEVICE_TYPE_CPU:
      return 0;
    case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU:
      return 2;
    default:
      return 1;
  }
}

bool is_of(VulkanChoice choice, const VkPhysicalDeviceProperties& properties) {
  const bool is_processor = properties.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU;
  return choice == VulkanChoice::any || is_processor == (choice == VulkanChoice::processor);
}

/// The extensions for rays that a device lacks, joined; empty: it has all that are needed.
std::string missing_of(const std::vector<VkExtensionProperties>& extensions) {
  std::string missing;
  const auto note = [&](const std::string& what) { missing += (missing.empty() ? "" : ", ") + what; };
  for (const char* name : needed_extensions)
    if (!has(extensions, name)) note(name);
  if (!has(extensions, pipeline_extension) && !has(extensions, query_extension))
    note(fmt::format("{} or {}", pipeline_extension, query_extension));
  return missing;
}

}  // namespace

Vulkan::Vulkan(VulkanChoice choice) {
  try {
    open_loader();
    make_instance();
    choose(choice);
    make_device();
  } catch (...) {
    destroy();
    throw;
  }
}

Vulkan::~Vulkan() { destroy(); }

void Vulkan::check(VkResult result, const char* what) {
  if (result >= 0) return;
  constexpr const char* words = "{}: {} (VkResult {})";
  if (is_failure(result)) throw VulkanFailure(words, what, name(result), static_cast<int>(result));
  throw Error(words, what, name(result), static_cast<int>(result));
}

void Vulkan::open_loader() {
  loader_ = dlopen("libvulkan.so.1", RTLD_NOW | RTLD_LOCAL);
  if (!loader_) throw Error("there is no Vulkan loader (Debian: libvulkan1): {}", dlerror());
  const auto find = reinterpret_cast<PFN_vkGetInstanceProcAddr>(dlsym(loader_, "vkGetInstanceProcAddr"));
  if (!find) throw Error("libvulkan.so.1 is no Vulkan loader: it has no vkGetInstanceProcAddr");
  GetInstanceProcAddr = find;
#define GNOMON_VULKAN_LOAD(function) function = reinterpret_cast<PFN_vk##function>(find(nullptr, "vk" #function))
  GNOMON_VULKAN_GLOBALS(GNOMON_VULKAN_LOAD)
#undef GNOMON_VULKAN_LOAD
}

void Vulkan::make_instance() {
  std::uint32_t version = VK_API_VERSION_1_0;
  if (EnumerateInstanceVersion) check(EnumerateInstanceVersion(&version), "the version of the Vulkan loader");
  if (version < least_version) throw Error("the Vulkan loader is older than 1.2");
  const auto extensions = listed<VkExtensionProperties>([&](std::uint32_t* count, VkExtensionProperties* all) {
    return EnumerateInstanceExtensionProperties(nullptr, count, all);
  });
  const bool has_messages = has(extensions, debug_extension);
  const VkApplicationInfo application{.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO,
                                      .pNext = nullptr,
                                      .pApplicationName = "gnomon",
                                      .applicationVersion = 1,
                                      .pEngineName = "gnomon",
                                      .engineVersion = 1,
                                      .apiVersion = least_version};
  auto info = vulkan_info<VkInstanceCreateInfo>(VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO);
  info.pApplicationInfo = &application;
  info.enabledExtensionCount = has_messages ? 1 : 0;
  info.ppEnabledExtensionNames = &debug_extension;
  check_made(CreateInstance(&info, nullptr, &instance_), instance_, "a Vulkan instance");
#define GNOMON_VULKAN_LOAD(function) \
  function = reinterpret_cast<PFN_vk##function>(GetInstanceProcAddr(instance_, "vk" #function))
  GNOMON_VULKAN_OF_INSTANCE(GNOMON_VULKAN_LOAD)
#undef GNOMON_VULKAN_LOAD
  if (!has_messages || !CreateDebugUtilsMessengerEXT) return;
  auto messenger = vulkan_info<VkDebugUtilsMessengerCreateInfoEXT>(VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT);
  messenger.messageSeverity = VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT;
  messenger.messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT;
  messenger.pfnUserCallback = note_message;
  messenger.pUserData = &messages_;
  check_made(CreateDebugUtilsMessengerEXT(instance_, &messenger, nullptr, &messenger_), messenger_, "a messenger of Vulkan");
}

void Vulkan::choose(VulkanChoice choice) {
  const auto devices = listed<VkPhysicalDevice>(
      [&](std::uint32_t* count, VkPhysicalDevice* all) { return EnumeratePhysicalDevices(instance_, count, all); });
  std::string refused;
  for (const VkPhysicalDevice device : devices) {
    auto found = vulkan_info<VkPhysicalDeviceProperties2>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2);
    GetPhysicalDeviceProperties2(device, &found);
    const VkPhysicalDeviceProperties& properties = found.properties;
    if (!is_of(choice, properties)) continue;
    const auto extensions = listed<VkExtensionProperties>([&](std::uint32_t* count, VkExtensionProperties* all) {
      return EnumerateDeviceExtensionProperties(device, nullptr, count, all);
    });
    const std::string missing = properties.apiVersion < least_version ? "Vulkan 1.2" : missing_of(extensions);
    if (!missing.empty()) {
      refused += fmt::format("{}{} has no {}", refused.empty() ? "" : "; ", properties.deviceName, missing);
      continue;
    }
    if (physical_ && rank(properties) <= rank(properties_)) continue;
    physical_ = device;
    properties_ = properties;
    has_pipelines_ = has(extensions, pipeline_extension);
    has_queries_ = has(extensions, query_extension);
  }
  if (physical_) return;
  static constexpr const char* of[] = {"", " that is the processor", " that is a card"};
  throw Error("there is no Vulkan device{} with rays{}", of[static_cast<int>(choice)], refused.empty() ? "" : ": " + refused);
}

void Vulkan::make_device() {
  auto driver = vulkan_info<VkPhysicalDeviceDriverProperties>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES);
  structures_ = vulkan_info<decltype(structures_)>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_ACCELERATION_STRUCTURE_PROPERTIES_KHR);
  pipelines_ = vulkan_info<decltype(pipelines_)>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_RAY_TRACING_PIPELINE_PROPERTIES_KHR);
  structures_.pNext = &driver;
  pipelines_.pNext = &structures_;
  auto all = vulkan_info<VkPhysicalDeviceProperties2>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2);
  all.pNext = has_pipelines_ ? static_cast<void*>(&pipelines_) : &structures_;
  GetPhysicalDeviceProperties2(physical_, &all);
  driver_ = fmt::format("{} {}", driver.driverName, driver.driverInfo);

  std::uint32_t count = 0;
  GetPhysicalDeviceQueueFamilyProperties(physical_, &count, nullptr);
  std::vector<VkQueueFamilyProperties> families(count);
  GetPhysicalDeviceQueueFamilyProperties(physical_, &count, families.data());
  const auto family =
      std::ranges::find_if(families, [](const auto& one) { return (one.queueFlags & VK_QUEUE_COMPUTE_BIT) != 0; });
  if (family == families.end()) throw Error("{} has no queue that computes", properties_.deviceName);
  family_ = static_cast<std::uint32_t>(family - families.begin());
  clock_bits_ = family->timestampValidBits;

  std::vector<const char*> extensions(std::begin(needed_extensions), std::end(needed_extensions));
  if (has_pipelines_) extensions.push_back(pipeline_extension);
  if (has_queries_) extensions.push_back(query_extension);
  auto queries = vulkan_info<VkPhysicalDeviceRayQueryFeaturesKHR>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_RAY_QUERY_FEATURES_KHR);
  queries.rayQuery = VK_TRUE;
  auto pipelines = vulkan_info<VkPhysicalDeviceRayTracingPipelineFeaturesKHR>(
      VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_RAY_TRACING_PIPELINE_FEATURES_KHR);
  pipelines.rayTracingPipeline = VK_TRUE;
  pipelines.pNext = has_queries_ ? &queries : nullptr;
  auto structures = vulkan_info<VkPhysicalDeviceAccelerationStructureFeaturesKHR>(
      VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_ACCELERATION_STRUCTURE_FEATURES_KHR);
  structures.accelerationStructure = VK_TRUE;
  structures.pNext = has_pipelines_ ? static_cast<void*>(&pipelines) : has_queries_ ? &queries : nullptr;
  auto addresses = vulkan_info<VkPhysicalDeviceBufferDeviceAddressFeatures>(
      VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_BUFFER_DEVICE_ADDRESS_FEATURES);
  addresses.bufferDeviceAddress = VK_TRUE;
  addresses.pNext = &structures;
  const float priority = 1;
  auto queue = vulkan_info<VkDeviceQueueCreateInfo>(VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO);
  queue.queueFamilyIndex = family_;
  queue.queueCount = 1;
  queue.pQueuePriorities = &priority;
  auto info = vulkan_info<VkDeviceCreateInfo>(VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO);
  info.pNext = &addresses;
  info.queueCreateInfoCount = 1;
  info.pQueueCreateInfos = &queue;
  info.enabledExtensionCount = static_cast<std::uint32_t>(extensions.size());
  info.ppEnabledExtensionNames = extensions.data();
  check_made(CreateDevice(physical_, &info, nullptr, &device_), device_, properties_.deviceName);
#define GNOMON_VULKAN_LOAD(function) function = reinterpret_cast<PFN_vk##function>(GetDeviceProcAddr(device_, "vk" #function))
  GNOMON_VULKAN_OF_DEVICE(GNOMON_VULKAN_LOAD)
#undef GNOMON_VULKAN_LOAD

  GetDeviceQueue(device_, family_, 0, &queue_);
  auto pool = vulkan_info<VkCommandPoolCreateInfo>(VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO);
  pool.flags = VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT;
  pool.queueFamilyIndex = family_;
  check_made(CreateCommandPool(device_, &pool, nullptr, &pool_), pool_, "a pool of commands");
  commands_ = new_commands();
  auto fence = vulkan_info<VkFenceCreateInfo>(VK_STRUCTURE_TYPE_FENCE_CREATE_INFO);
  check_made(CreateFence(device_, &fence, nullptr, &fence_), fence_, "a fence");
}

void Vulkan::destroy() {
  if (device_) {
    DeviceWaitIdle(device_);
    DestroyFence(device_, fence_, nullptr);
    DestroyCommandPool(device_, pool_, nullptr);
    DestroyDevice(device_, nullptr);
  }
  if (messenger_) DestroyDebugUtilsMessengerEXT(instance_, messenger_, nullptr);
  if (instance_) DestroyInstance(instance_, nullptr);
  if (loader_) dlclose(loader_);
}

double Vulkan::nanoseconds(std::uint64_t from, std::uint64_t to) const {
  const std::uint64_t mask = clock_bits_ < 64 ? (std::uint64_t{1} << clock_bits_) - 1 : ~std::uint64_t{0};
  return static_cast<double>((to - from) & mask) * properties_.limits.timestampPeriod;
}

VkCommandBuffer Vulkan::new_commands() const {
  auto info = vulkan_info<VkCommandBufferAllocateInfo>(VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO);
  info.commandPool = pool_;
  info.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
  info.commandBufferCount = 1;
  VkCommandBuffer commands = VK_NULL_HANDLE;
  check(AllocateCommandBuffers(device_, &info, &commands), "a buffer of commands");
  return commands;
}

void Vulkan::record_into(VkCommandBuffer commands, VkCommandBufferUsageFlags usage,
                         const std::function<void(VkCommandBuffer)>& record) const {
  auto begin = vulkan_info<VkCommandBufferBeginInfo>(VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO);
  begin.flags = usage;
  check(BeginCommandBuffer(commands, &begin), "commands");
  record(commands);
  check(EndCommandBuffer(commands), "commands");
}

VkCommandBuffer Vulkan::recorded(const std::function<void(VkCommandBuffer)>& record) const {
  const VkCommandBuffer commands = new_commands();
  record_into(commands, 0, record);
  return commands;
}

void Vulkan::hand_over(VkCommandBuffer commands) const {
  auto info = vulkan_info<VkSubmitInfo>(VK_STRUCTURE_TYPE_SUBMIT_INFO);
  info.commandBufferCount = 1;
  info.pCommandBuffers = &commands;
  check(QueueSubmit(queue_, 1, &info, VK_NULL_HANDLE), "work that is handed over");
}

void Vulkan::submit(const std::function<void(VkCommandBuffer)>& record) const {
  record_into(commands_, VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT, record);
  auto info = vulkan_info<VkSubmitInfo>(VK_STRUCTURE_TYPE_SUBMIT_INFO);
  info.commandBufferCount = 1;
  info.pCommandBuffers = &commands_;
  check(ResetFences(device_, 1, &fence_), "a fence");
  check(QueueSubmit(queue_, 1, &info, fence_), "work that is handed over");
  check(WaitForFences(device_, 1, &fence_, VK_TRUE, UINT64_MAX), "work that is waited for");
}

void Vulkan::finish() const { check(QueueWaitIdle(queue_), "work that is waited for"); }

std::string Vulkan::take_messages() const { return std::exchange(messages_, {}); }

const Vulkan& vulkan() {
  if (!current_vulkan()) throw Error("there is no Vulkan device: nobody has made one");
  return *current_vulkan();
}

}  // namespace gnomon
#endif
