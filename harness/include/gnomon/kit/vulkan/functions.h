#pragma once
#ifndef VK_NO_PROTOTYPES
#define VK_NO_PROTOTYPES
#endif
#include <vulkan/vulkan.h>

// The functions of Vulkan that Gnomon calls, by where the loader has them.
#define GNOMON_VULKAN_GLOBALS(USE)           \
  USE(CreateInstance);                       \
  USE(EnumerateInstanceExtensionProperties); \
  USE(EnumerateInstanceVersion);
#define GNOMON_VULKAN_OF_INSTANCE(USE)         \
  USE(CreateDevice);                           \
  USE(DestroyInstance);                        \
  USE(EnumerateDeviceExtensionProperties);     \
  USE(EnumeratePhysicalDevices);               \
  USE(GetDeviceProcAddr);                      \
  USE(GetPhysicalDeviceFeatures2);             \
  USE(GetPhysicalDeviceMemoryProperties);      \
  USE(GetPhysicalDeviceProperties2);           \
  USE(GetPhysicalDeviceQueueFamilyProperties); \
  USE(CreateDebugUtilsMessengerEXT);           \
  USE(DestroyDebugUtilsMessengerEXT);
#define GNOMON_VULKAN_OF_DEVICE(USE)                \
  USE(AllocateCommandBuffers);                      \
  USE(AllocateDescriptorSets);                      \
  USE(AllocateMemory);                              \
  USE(BeginCommandBuffer);                          \
  USE(BindBufferMemory);                            \
  USE(CmdBindDescriptorSets);                       \
  USE(CmdBindPipeline);                             \
  USE(CmdBuildAccelerationStructuresKHR);           \
  USE(CmdCopyAccelerationStructureKHR);             \
  USE(CmdCopyBuffer);                               \
  USE(CmdDispatch);                                 \
  USE(CmdFillBuffer);                               \
  USE(CmdPipelineBarrier);                          \
  USE(CmdPushConstants);                            \
  USE(CmdResetQueryPool);                           \
  USE(CmdTraceRaysKHR);                             \
  USE(CmdWriteAccelerationStructuresPropertiesKHR); \
  USE(CmdWriteTimestamp);                           \
  USE(CreateAccelerationStructureKHR);              \
  USE(CreateBuffer);                                \
  USE(CreateCommandPool);                           \
  USE(CreateComputePipelines);                      \
  USE(CreateDescriptorPool);                        \
  USE(CreateDescriptorSetLayout);                   \
  USE(CreateFence);                                 \
  USE(CreatePipelineLayout);                        \
  USE(CreateQueryPool);                             \
  USE(CreateRayTracingPipelinesKHR);                \
  USE(CreateShaderModule);                          \
  USE(DestroyAccelerationStructureKHR);             \
  USE(DestroyBuffer);                               \
  USE(DestroyCommandPool);                          \
  USE(DestroyDescriptorPool);                       \
  USE(DestroyDescriptorSetLayout);                  \
  USE(DestroyDevice);                               \
  USE(DestroyFence);                                \
  USE(DestroyPipeline);                             \
  USE(DestroyPipelineLayout);                       \
  USE(DestroyQueryPool);                            \
  USE(DestroyShaderModule);                         \
  USE(DeviceWaitIdle);                              \
  USE(EndCommandBuffer);                            \
  USE(FreeMemory);                                  \
  USE(GetAccelerationStructureBuildSizesKHR);       \
  USE(GetAccelerationStructureDeviceAddressKHR);    \
  USE(GetBufferDeviceAddress);                      \
  USE(GetBufferMemoryRequirements);                 \
  USE(GetDeviceQueue);                              \
  USE(GetQueryPoolResults);                         \
  USE(GetRayTracingShaderGroupHandlesKHR);          \
  USE(MapMemory);                                   \
  USE(QueueSubmit);                                 \
  USE(QueueWaitIdle);                               \
  USE(ResetFences);                                 \
  USE(UpdateDescriptorSets);                        \
  USE(WaitForFences);

namespace gnomon {

/// Each under its name without "vk"; null where driver or loader have none.
struct VulkanFunctions {
  PFN_vkGetInstanceProcAddr GetInstanceProcAddr = nullptr;
#define GNOMON_VULKAN_MEMBER(name) PFN_vk##name name = nullptr
  GNOMON_VULKAN_GLOBALS(GNOMON_VULKAN_MEMBER)
  GNOMON_VULKAN_OF_INSTANCE(GNOMON_VULKAN_MEMBER)
  GNOMON_VULKAN_OF_DEVICE(GNOMON_VULKAN_MEMBER)
#undef GNOMON_VULKAN_MEMBER
};

/// A struct of Vulkan of this type, the rest of it zero.
template <class Info>
Info vulkan_info(VkStructureType type) {
  Info info{};
  info.sType = type;
  return info;
}

}  // namespace gnomon
