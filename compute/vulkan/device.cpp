#include "compute/vulkan/device.h"

#include "model/address_space.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>

#include "compute/vulkan/buffer_guard.h"

namespace palpate {
namespace {

/// What the shaders of palpate need of a device, queried and enabled by the same chain.
struct Features {
  VkPhysicalDeviceFeatures2 base{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2, nullptr, {}};
  VkPhysicalDeviceVulkan12Features v12{};
  VkPhysicalDeviceVulkan13Features v13{};
  Features() {
    v12.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES;
    v13.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES;
    base.pNext = &v12;
    v12.pNext = &v13;
  }
  Features(const Features&) = delete;
  Features& operator=(const Features&) = delete;
};

constexpr std::uint32_t kBindings = 16;        ///< storage buffers a shader may use; chosen
constexpr std::uint32_t kPushBytes = 128;      ///< Vulkan guarantees that many
constexpr std::uint32_t kGroupSize = 256;      ///< largest workgroup of any shader
constexpr std::uint32_t kSharedBytes = 32768;  ///< shared memory of any shader

std::string version_text(std::uint32_t v) {
  return std::to_string(VK_API_VERSION_MAJOR(v)) + "." + std::to_string(VK_API_VERSION_MINOR(v)) + "." +
         std::to_string(VK_API_VERSION_PATCH(v));
}

bool has_extension(VkPhysicalDevice device, const char* name) {
  std::uint32_t count = 0;
  vkEnumerateDeviceExtensionProperties(device, nullptr, &count, nullptr);
  std::vector<VkExtensionProperties> extensions(count);
  vkEnumerateDeviceExtensionProperties(device, nullptr, &count, extensions.data());
  return std::any_of(extensions.begin(), extensions.end(),
                     [&](const VkExtensionProperties& e) { return std::strcmp(e.extensionName, name) == 0; });
}

/// The compute queue family: one without graphics if there is one. −1: none.
int compute_family(VkPhysicalDevice device) {
  std::uint32_t count = 0;
  vkGetPhysicalDeviceQueueFamilyProperties(device, &count, nullptr);
  std::vector<VkQueueFamilyProperties> families(count);
  vkGetPhysicalDeviceQueueFamilyProperties(device, &count, families.data());
  int found = -1;
  for (std::uint32_t i = 0; i < count; ++i) {
    const auto& f = families[i];
    if ((f.queueFlags & VK_QUEUE_COMPUTE_BIT) == 0 || f.timestampValidBits == 0) continue;
    if (found < 0 || (f.queueFlags & VK_QUEUE_GRAPHICS_BIT) == 0) found = static_cast<int>(i);
  }
  return found;
}

/// Why a device can't be used, as a clause; empty: it can.
std::string refusal(VkPhysicalDevice device) {
  VkPhysicalDeviceProperties p{};
  vkGetPhysicalDeviceProperties(device, &p);
  if (p.apiVersion < VK_API_VERSION_1_3)
    return "it offers Vulkan " + version_text(p.apiVersion) + ", 1.3 is needed";
  Features f;
  vkGetPhysicalDeviceFeatures2(device, &f.base);
  if (!f.base.features.shaderInt64) return "its shaders have no 64-bit integers";
  if (!f.v12.shaderBufferInt64Atomics) return "it has no 64-bit integer atomics on buffers";
  if (!f.v12.scalarBlockLayout) return "it has no scalar block layout";
  if (!f.v13.synchronization2) return "it has no synchronization2";
  if (!has_extension(device, VK_KHR_PUSH_DESCRIPTOR_EXTENSION_NAME)) return "it has no push descriptors";
  if (p.limits.maxPerStageDescriptorStorageBuffers < kBindings)
    return "a shader may use " + std::to_string(p.limits.maxPerStageDescriptorStorageBuffers) +
           " storage buffers, " + std::to_string(kBindings) + " are needed";
  if (p.limits.maxComputeWorkGroupInvocations < kGroupSize ||
      p.limits.maxComputeWorkGroupSize[0] < kGroupSize)
    return "its workgroups have fewer than " + std::to_string(kGroupSize) + " invocations";
  if (p.limits.maxComputeSharedMemorySize < kSharedBytes)
    return "it has " + std::to_string(p.limits.maxComputeSharedMemorySize) + " bytes of shared memory, " +
           std::to_string(kSharedBytes) + " are needed";
  if (p.limits.maxPushConstantsSize < kPushBytes)
    return "it has " + std::to_string(p.limits.maxPushConstantsSize) + " bytes of push constants, " +
           std::to_string(kPushBytes) + " are needed";
  if (compute_family(device) < 0) return "it has no compute queue with timestamps";
  return "";
}

/// Higher is better: a discrete GPU, then an integrated one, then others, then a CPU.
int rank(VkPhysicalDeviceType type) {
  switch (type) {
    case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU:
      return 4;
    case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU:
      return 3;
    case VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU:
      return 2;
    case VK_PHYSICAL_DEVICE_TYPE_CPU:
      return 0;
    default:
      return 1;
  }
}

std::vector<VkPhysicalDevice> physical_devices(VkInstance instance) {
  std::uint32_t count = 0;
  if (vkEnumeratePhysicalDevices(instance, &count, nullptr) != VK_SUCCESS) return {};
  std::vector<VkPhysicalDevice> devices(count);
  if (vkEnumeratePhysicalDevices(instance, &count, devices.data()) < 0) return {};
  return devices;
}

VulkanDeviceInfo describe(VkPhysicalDevice device) {
  VkPhysicalDeviceDriverProperties driver{};
  driver.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES;
  VkPhysicalDeviceProperties2 p{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, &driver, {}};
  vkGetPhysicalDeviceProperties2(device, &p);
  VulkanDeviceInfo info;
  info.name = p.properties.deviceName;
  info.driver = std::string(driver.driverName) + " " + driver.driverInfo;
  const std::string why = refusal(device);
  info.usable = why.empty();
  info.processor = p.properties.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU;
  info.reason = info.usable ? "usable, Vulkan " + version_text(p.properties.apiVersion) : "refused: " + why;
  return info;
}

/// lavapipe reads LP_NUM_THREADS at an instance's first enumeration. A value set by the user stays; ours is
/// taken back so that neither children nor a second instance inherit it.
class InlineExecution {
 public:
  explicit InlineExecution(bool wanted) : set_(wanted && std::getenv(kName) == nullptr) {
    if (set_) setenv(kName, "0", 0);
  }
  ~InlineExecution() {
    if (set_) unsetenv(kName);
  }
  InlineExecution(const InlineExecution&) = delete;
  InlineExecution& operator=(const InlineExecution&) = delete;

 private:
  static constexpr const char* kName = "LP_NUM_THREADS";
  bool set_;
};

}  // namespace

Error vulkan_error(const char* call, VkResult result) {
  std::string what;
  switch (result) {
    case VK_ERROR_OUT_OF_HOST_MEMORY:
      what = "out of host memory";
      break;
    case VK_ERROR_OUT_OF_DEVICE_MEMORY:
      what = "out of device memory";
      break;
    case VK_ERROR_DEVICE_LOST:
      what = "the device was lost";
      break;
    case VK_ERROR_INCOMPATIBLE_DRIVER:
      what = "no Vulkan driver";
      break;
    case VK_ERROR_LAYER_NOT_PRESENT:
      what = "the validation layer is not installed";
      break;
    case VK_ERROR_INITIALIZATION_FAILED:
      what = "initialisation failed";
      break;
    case VK_TIMEOUT:
      what = "the device did not answer in time";
      break;
    default:
      what = "VkResult " + std::to_string(static_cast<int>(result));
      break;
  }
  const bool no_device = result == VK_ERROR_INCOMPATIBLE_DRIVER || result == VK_ERROR_LAYER_NOT_PRESENT;
  return {no_device ? ErrorCode::kNoDevice : ErrorCode::kInternal, std::string(call) + " failed: " + what};
}

VKAPI_ATTR VkBool32 VKAPI_CALL VulkanDevice::on_message(VkDebugUtilsMessageSeverityFlagBitsEXT,
                                                        VkDebugUtilsMessageTypeFlagsEXT,
                                                        const VkDebugUtilsMessengerCallbackDataEXT* data,
                                                        void* user) {
  auto* self = static_cast<VulkanDevice*>(user);
  const std::lock_guard lock(self->message_mutex_);
  if (self->message_.empty())
    self->message_ = data->pMessage != nullptr ? data->pMessage : "a message without text";
  return VK_FALSE;
}

Result<void> VulkanDevice::make_instance(bool validation) {
  if (const auto left = address_space_left(); left && *left < kDriverAddressSpace)
    return Error{ErrorCode::kNoDevice, "this process may take " + std::to_string(*left >> 20) +
                                           " MiB more of address space (ulimit -v), a Vulkan driver needs " +
                                           std::to_string(kDriverAddressSpace >> 20) + " MiB"};
  VkApplicationInfo application{};
  application.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO;
  application.pApplicationName = "palpate";
  application.apiVersion = VK_API_VERSION_1_3;
  VkInstanceCreateInfo create{};
  create.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO;
  create.pApplicationInfo = &application;

  const char* layer = "VK_LAYER_KHRONOS_validation";
  const char* extension = VK_EXT_DEBUG_UTILS_EXTENSION_NAME;
  const VkValidationFeatureEnableEXT enabled = VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT;
  VkValidationFeaturesEXT features{};
  features.sType = VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT;
  features.enabledValidationFeatureCount = 1;
  features.pEnabledValidationFeatures = &enabled;
  VkDebugUtilsMessengerCreateInfoEXT messenger{};
  messenger.sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT;
  messenger.messageSeverity =
      VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT;
  messenger.messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT;
  messenger.pfnUserCallback = &VulkanDevice::on_message;
  messenger.pUserData = this;
  if (validation) {
    create.enabledLayerCount = 1;
    create.ppEnabledLayerNames = &layer;
    create.enabledExtensionCount = 1;
    create.ppEnabledExtensionNames = &extension;
    create.pNext = &features;
  }
  if (const VkResult r = vkCreateInstance(&create, nullptr, &instance_); r != VK_SUCCESS)
    return vulkan_error("vkCreateInstance", r);
  if (validation) {
    const auto make = reinterpret_cast<PFN_vkCreateDebugUtilsMessengerEXT>(
        vkGetInstanceProcAddr(instance_, "vkCreateDebugUtilsMessengerEXT"));
    if (const VkResult r = make(instance_, &messenger, nullptr, &messenger_); r != VK_SUCCESS)
      return vulkan_error("vkCreateDebugUtilsMessengerEXT", r);
  }
  return {};
}

Result<void> VulkanDevice::choose(const std::string& wanted) {
  std::string reasons;
  int best = -1;
  for (VkPhysicalDevice candidate : physical_devices(instance_)) {
    const VulkanDeviceInfo info = describe(candidate);
    const bool named = info.name.find(wanted) != std::string::npos;
    if (!info.usable || !named) {
      reasons += (reasons.empty() ? "" : "; ") + info.name + ": " +
                 (named ? info.reason : "not named \"" + wanted + "\"");
      continue;
    }
    VkPhysicalDeviceProperties p{};
    vkGetPhysicalDeviceProperties(candidate, &p);
    if (rank(p.deviceType) <= best) continue;
    best = rank(p.deviceType);
    physical_ = candidate;
    name_ = info.name;
    driver_ = info.driver;
  }
  if (physical_ == VK_NULL_HANDLE)
    return Error{ErrorCode::kNoDevice, reasons.empty() ? std::string("no driver shows any") : reasons};
  return {};
}

Result<void> VulkanDevice::make_device(bool own_memory) {
  VkPhysicalDeviceMaintenance3Properties maintenance{};
  maintenance.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MAINTENANCE_3_PROPERTIES;
  VkPhysicalDeviceProperties2 p{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, &maintenance, {}};
  vkGetPhysicalDeviceProperties2(physical_, &p);
  vkGetPhysicalDeviceMemoryProperties(physical_, &memory_);
  limits_.storage_range = p.properties.limits.maxStorageBufferRange;
  limits_.allocation = maintenance.maxMemoryAllocationSize;
  limits_.groups = p.properties.limits.maxComputeWorkGroupCount[0];
  limits_.timestamp_ns = static_cast<double>(p.properties.limits.timestampPeriod);
  for (std::uint32_t i = 0; i < memory_.memoryHeapCount; ++i)
    if ((memory_.memoryHeaps[i].flags & VK_MEMORY_HEAP_DEVICE_LOCAL_BIT) != 0)
      limits_.heap = std::max<std::uint64_t>(limits_.heap, memory_.memoryHeaps[i].size);
  // Buffers leave the driver what it needs itself.
  if (const auto left = address_space_left())
    limits_.heap = std::min(limits_.heap, *left - std::min(*left, kDriverAddressSpace / 2));
  processor_ = p.properties.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU && !own_memory;
  texels_ = processor_ && p.properties.limits.maxTexelBufferElements >= limits_.storage_range / 4;
  unified_ = processor_ || (p.properties.deviceType == VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU && !own_memory);
  const bool shares = processor_ && has_extension(physical_, VK_EXT_EXTERNAL_MEMORY_HOST_EXTENSION_NAME);
  if (shares) {
    VkPhysicalDeviceExternalMemoryHostPropertiesEXT host{};
    host.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_EXTERNAL_MEMORY_HOST_PROPERTIES_EXT;
    VkPhysicalDeviceProperties2 of_host{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, &host, {}};
    vkGetPhysicalDeviceProperties2(physical_, &of_host);
    page_ = host.minImportedHostPointerAlignment;
  }

  Features features;
  features.base.features.shaderInt64 = VK_TRUE;
  features.v12.shaderBufferInt64Atomics = VK_TRUE;
  features.v12.scalarBlockLayout = VK_TRUE;
  features.v13.synchronization2 = VK_TRUE;
  features.v13.maintenance4 = VK_TRUE;  // workgroup size by specialisation constant
  queue_family_ = static_cast<std::uint32_t>(compute_family(physical_));
  const float priority = 1;
  VkDeviceQueueCreateInfo queue{};
  queue.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO;
  queue.queueFamilyIndex = queue_family_;
  queue.queueCount = 1;
  queue.pQueuePriorities = &priority;
  const char* extensions[] = {VK_KHR_PUSH_DESCRIPTOR_EXTENSION_NAME,
                              VK_EXT_EXTERNAL_MEMORY_HOST_EXTENSION_NAME};
  VkDeviceCreateInfo create{};
  create.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO;
  create.pNext = &features.base;
  create.queueCreateInfoCount = 1;
  create.pQueueCreateInfos = &queue;
  create.enabledExtensionCount = shares ? 2 : 1;
  create.ppEnabledExtensionNames = extensions;
  if (const VkResult r = vkCreateDevice(physical_, &create, nullptr, &device_); r != VK_SUCCESS)
    return vulkan_error("vkCreateDevice", r);
  vkGetDeviceQueue(device_, queue_family_, 0, &queue_);
  push_descriptors = reinterpret_cast<PFN_vkCmdPushDescriptorSetKHR>(
      vkGetDeviceProcAddr(device_, "vkCmdPushDescriptorSetKHR"));
  return {};
}

Result<std::unique_ptr<VulkanDevice>> VulkanDevice::create(const DeviceOptions& options) {
  const InlineExecution inline_execution(options.inline_execution);
  std::unique_ptr<VulkanDevice> device(new VulkanDevice);
  Result<void> made = device->make_instance(options.validation);
  if (made) made = device->choose(options.device);
  if (made) made = device->make_device(options.own_memory);
  if (!made) return Error{made.error().code, "no usable Vulkan device: " + made.error().sentence};
  device->fault_ = options.fault;
  device->guarded = options.guard_buffers;
  return device;
}

std::vector<VulkanDeviceInfo> VulkanDevice::list() {
  const InlineExecution inline_execution(true);
  VulkanDevice probe;
  std::vector<VulkanDeviceInfo> out;
  if (!probe.make_instance(false)) return out;
  for (VkPhysicalDevice device : physical_devices(probe.instance_)) out.push_back(describe(device));
  return out;
}

VulkanDevice::~VulkanDevice() {
  if (device_ != VK_NULL_HANDLE) {
    wait_idle();
    compilers.reset();
    pipelines.clear();
    vkDestroyDevice(device_, nullptr);
  }
  if (messenger_ != VK_NULL_HANDLE) {
    const auto destroy = reinterpret_cast<PFN_vkDestroyDebugUtilsMessengerEXT>(
        vkGetInstanceProcAddr(instance_, "vkDestroyDebugUtilsMessengerEXT"));
    destroy(instance_, messenger_, nullptr);
  }
  if (instance_ != VK_NULL_HANDLE) vkDestroyInstance(instance_, nullptr);
}

int VulkanDevice::memory_type(std::uint32_t allowed, VkMemoryPropertyFlags wanted,
                              VkMemoryPropertyFlags preferred) const {
  int found = -1;
  for (std::uint32_t i = 0; i < memory_.memoryTypeCount; ++i) {
    const VkMemoryPropertyFlags flags = memory_.memoryTypes[i].propertyFlags;
    if ((allowed >> i & 1u) == 0 || (flags & wanted) != wanted) continue;
    if ((flags & preferred) == preferred) return static_cast<int>(i);
    if (found < 0) found = static_cast<int>(i);
  }
  return found;
}

VkResult VulkanDevice::submit(const VkSubmitInfo2& info, VkFence fence) {
  const std::lock_guard lock(queue_mutex_);
  return vkQueueSubmit2(queue_, 1, &info, fence);
}

void VulkanDevice::wait_idle() {
  const std::lock_guard lock(queue_mutex_);
  vkDeviceWaitIdle(device_);
}

Result<void> VulkanDevice::check_guards() {
  for (BufferGuard* guard : std::set<BufferGuard*>(guards)) {  // a copy: reading one may make another buffer
    if (!guard_error.empty()) break;
    guard_error = guard->broken().value_or("");
  }
  if (guard_error.empty()) return {};
  return Error{ErrorCode::kInternal, "a buffer's guard is broken: " + guard_error};
}

VkResult VulkanDevice::injected(GpuFault::Call call) {
  if (!fault_ || call != fault_->call || fault_->after-- > 0) return VK_SUCCESS;
  return call == GpuFault::Call::kAllocate ? VK_ERROR_OUT_OF_DEVICE_MEMORY : VK_ERROR_DEVICE_LOST;
}

Result<void> VulkanDevice::take_validation_error() {
  const std::lock_guard lock(message_mutex_);
  if (message_.empty()) return {};
  Error error{ErrorCode::kInternal, "Vulkan validation: " + message_};
  message_.clear();
  return error;
}

}  // namespace palpate
