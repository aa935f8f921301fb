#include "measure/worker/vulkan_device.h"

#include "device/vulkan_context.h"

#ifdef GNOMON_VULKAN
#include "device/card.h"
#include "device/vulkan_bare_pass.h"
#include "device/vulkan_stopwatch.h"
#include "measure/progress.h"
#include "measure/worker/opengl_device.h"
#endif

namespace gnomon {

namespace {

/// Takes the place of a device that is not there: all rows are unsupported.
class NoDevice final : public TechniqueDevice {
 public:
  explicit NoDevice(std::string why) : why_(std::move(why)) {}
  std::string missing() const override { return why_; }
  Support within_limits(const Scene&, int, int) const override { return Support::unsupported(why_); }

 private:
  std::string why_;
};

#ifdef GNOMON_VULKAN
class VulkanDevice final : public TechniqueDevice {
 public:
  std::optional<WorkerGl> description() const override {
    const auto version = vulkan().properties().apiVersion;
    return WorkerGl{.renderer = vulkan().properties().deviceName,
                    .version = fmt::format("Vulkan {}.{}.{}, {}", VK_API_VERSION_MAJOR(version), VK_API_VERSION_MINOR(version),
                                           VK_API_VERSION_PATCH(version), vulkan().driver()),
                    .card = card()};
  }
  std::optional<Json> card() const override {
    return vulkan().is_processor() ? std::nullopt : card_in_json(vulkan().properties().deviceName);
  }
  bool has_own_memory() const override { return !vulkan().is_processor(); }
  Support within_limits(const Scene&, int width, int height) const override {
    const std::uint64_t bytes = sizeof(glm::vec4) * static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height);
    const std::uint64_t most = vulkan().properties().limits.maxStorageBufferRange;
    if (bytes <= most) return Support::full();
    return Support::unsupported(fmt::format(
        "the Vulkan device has maxStorageBufferRange = {}; positions of {} x {} pixels need {}", most, width, height, bytes));
  }
  void finish() override { vulkan().finish(); }
  DeviceStopwatch* stopwatch() override { return &stopwatch_; }
  void prepare(Stage stage, const Scenes& scenes, const GBuffer& gbuffer) override {
    if (stage == Stage::resolve)
      for (const Scene* const scene : scenes) vulkan_gbuffer(gbuffer, *scene);
    vulkan().finish();
  }
  void end_stage() override {
    if (const std::string messages = vulkan().take_messages(); !messages.empty()) throw Error("Vulkan's layers: {}", messages);
  }
  void forget(const Scenes&) override {
    forget_floor();
    forget_vulkan_gbuffers();
  }
  std::optional<GlInputs> inputs(const Scenes& scenes, const GBuffer& gbuffer) const override {
    GlInputs sum{.geometry_bytes = 0, .loose_bytes = 0};  // its triangles are the technique's own
    for (const Scene* const scene : scenes) {
      const VulkanGBuffer& picture = vulkan_gbuffer(gbuffer, *scene);
      sum.input_bytes += picture.bytes();
      sum.upload_ms += picture.upload_ms;
    }
    return sum;
  }
  FloorRequest::Reply draw_floor(Floor floor, const Scene& scene, const GBuffer& gbuffer, int times) override {
    if (!(times >= 1 && times <= most_floor_times)) throw Error("times = {} is outside 1 .. {}", times, most_floor_times);
    if (!bare_pass_) bare_pass_.emplace(floor, scene, gbuffer);
    bare_pass_->draw();  // drivers compile at the first one
    const auto start = std::chrono::steady_clock::now();
    stopwatch_.start();
    bare_pass_->draw(times);
    stopwatch_.stop();
    vulkan().finish();
    const double ms = 1000 * seconds_since(start);
    return {.ms = ms, .device_ms = stopwatch_.milliseconds()};
  }
  void forget_floor() override { bare_pass_.reset(); }
  void upload(const Scene& scene, const GBuffer& gbuffer, VisibilityMask&) override { vulkan_gbuffer(gbuffer, scene); }

 private:
  VulkanStopwatch stopwatch_;
  std::optional<VulkanBarePass> bare_pass_;
};
#endif

}  // namespace

std::unique_ptr<TechniqueDevice> vulkan_device() {
#ifdef GNOMON_VULKAN
  if (missing_vulkan().empty()) return std::make_unique<VulkanDevice>();
#endif
  return std::make_unique<NoDevice>(missing_vulkan());
}

}  // namespace gnomon
