#include "tracer.h"

#include <gnomon/error.h>

#ifdef GNOMON_VULKAN
#include <cstring>
#include <utility>

#include "programs.h"
#include "trees.h"

namespace gnomon::vulkan_rays {

struct Tracer::Body {
  Programs programs;
  Trees trees;
  std::uint64_t number;  ///< no other tracer of this process has it
};

struct Answers::Body {
  VulkanBindings bindings;
  std::uint64_t bound_to = 0;  // a tracer's number
  VulkanBuffer mask, ray_counts, places;
  VulkanBuffer read;  // of the mask, in host memory
  std::size_t pixels = 0, place_count = 0;
};

namespace {
std::uint64_t last_number = 0;
}

Tracer::Tracer(Trace trace) : body_(std::make_unique<Body>(Body{Programs(trace), {}, ++last_number})) {}
Tracer::~Tracer() = default;
void Tracer::build(const Scene& scene, float scale, const BuildChoices& choices) { body_->trees.build(scene, scale, choices); }
void Tracer::update(const Changes& changes) { body_->trees.update(changes); }
Sizes Tracer::sizes() const {
  Sizes sizes = body_->trees.sizes();
  sizes.bytes += body_->programs.bytes();
  return sizes;
}
float Tracer::scale() const { return body_->trees.scale(); }
const Scene& Tracer::scene() const { return body_->trees.scene(); }

Answers::Answers() : body_(std::make_unique<Body>()) {}
Answers::~Answers() = default;

void Answers::resolve(const Tracer& tracer, FrameConstants constants, std::span<const glm::vec2> places, const GBuffer& gbuffer,
                      std::span<float> mask) {
  const Vulkan& v = vulkan();
  const Programs& programs = tracer.body_->programs;
  constexpr VkBufferUsageFlags storage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT;
  const std::size_t bytes = gbuffer.size() * sizeof(float);
  if (!body_->mask || body_->pixels != gbuffer.size()) {
    for (VulkanBuffer* const old : {&body_->mask, &body_->ray_counts, &body_->read}) *old = {};  // before the new ones come
    body_->mask = VulkanBuffer(bytes, storage | VK_BUFFER_USAGE_TRANSFER_SRC_BIT);
    body_->ray_counts = VulkanBuffer(bytes, storage | VK_BUFFER_USAGE_TRANSFER_SRC_BIT);
    body_->read = VulkanBuffer(bytes, VK_BUFFER_USAGE_TRANSFER_DST_BIT, VulkanBuffer::Lies::in_host_memory);
    body_->pixels = gbuffer.size();
  }
  if (!body_->places || body_->place_count != places.size()) {
    body_->places = VulkanBuffer(places.size_bytes(), storage | VK_BUFFER_USAGE_TRANSFER_DST_BIT);
    body_->place_count = places.size();
  }
  body_->places.write(std::as_bytes(places));
  const VulkanGBuffer& picture = vulkan_gbuffer(gbuffer, tracer.scene());
  if (std::exchange(body_->bound_to, tracer.body_->number) != tracer.body_->number)
    body_->bindings = VulkanBindings(programs.layout());
  const std::array<VkBuffer, buffer_count> seen{
      picture.position.name(), picture.normal.name(),    picture.ids.name(),  tracer.body_->trees.meshes().name(),
      body_->mask.name(),      body_->ray_counts.name(), body_->places.name()};
  body_->bindings.see(tracer.body_->trees.top(), seen);
  constants.scale = tracer.scale();
  constants.width = static_cast<std::uint32_t>(gbuffer.width);
  constants.height = static_cast<std::uint32_t>(gbuffer.height);
  v.submit([&](VkCommandBuffer commands) {
    programs.trace(commands, body_->bindings, constants);
    auto barrier = vulkan_info<VkMemoryBarrier>(VK_STRUCTURE_TYPE_MEMORY_BARRIER);
    barrier.srcAccessMask = VK_ACCESS_SHADER_WRITE_BIT;
    barrier.dstAccessMask = VK_ACCESS_TRANSFER_READ_BIT;
    v.CmdPipelineBarrier(commands, programs.stage(), VK_PIPELINE_STAGE_TRANSFER_BIT, 0, 1, &barrier, 0, nullptr, 0, nullptr);
    const VkBufferCopy region{0, 0, bytes};
    v.CmdCopyBuffer(commands, body_->mask.name(), body_->read.name(), 1, &region);
    barrier.srcAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT;
    barrier.dstAccessMask = VK_ACCESS_HOST_READ_BIT;
    v.CmdPipelineBarrier(commands, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_PIPELINE_STAGE_HOST_BIT, 0, 1, &barrier, 0, nullptr, 0,
                         nullptr);
  });
  std::memcpy(mask.data(), body_->read.data(), bytes);
}

std::size_t Answers::bytes() const {
  return body_->mask.bytes() + body_->ray_counts.bytes() + body_->places.bytes() + body_->read.bytes();
}

std::vector<std::uint32_t> Answers::ray_counts() const {
  std::vector<std::uint32_t> counts(body_->pixels);
  if (!counts.empty()) body_->ray_counts.read(std::as_writable_bytes(std::span(counts)));
  return counts;
}

std::string refusal(Trace trace, std::size_t triangles) {
  const Vulkan* const device = current_vulkan();
  if (!device) return {};
  const std::string name = device->properties().deviceName;
  if (trace == Trace::pipeline && !device->has_pipelines())
    return fmt::format("{} has no VK_KHR_ray_tracing_pipeline; trace = query works there", name);
  if (trace == Trace::query && !device->has_queries())
    return fmt::format("{} has no VK_KHR_ray_query; trace = pipeline works there", name);
  const std::uint64_t most = device->structure_limits().maxPrimitiveCount;
  if (triangles > most) return fmt::format("{} triangles cast; {} takes {} into a tree", triangles, name, most);
  return {};
}

}  // namespace gnomon::vulkan_rays
#else
namespace gnomon::vulkan_rays {

// Never called: no device is made ready then, and every row is refused before its stages.
struct Tracer::Body {};
struct Answers::Body {};
[[noreturn]] static void refuse() { throw Error("this program was built without Vulkan"); }
Tracer::Tracer(Trace) { refuse(); }
Tracer::~Tracer() = default;
void Tracer::build(const Scene&, float, const BuildChoices&) { refuse(); }
void Tracer::update(const Changes&) { refuse(); }
Sizes Tracer::sizes() const { return {}; }
float Tracer::scale() const { return 1; }
const Scene& Tracer::scene() const { refuse(); }
Answers::Answers() = default;
Answers::~Answers() = default;
void Answers::resolve(const Tracer&, FrameConstants, std::span<const glm::vec2>, const GBuffer&, std::span<float>) { refuse(); }
std::size_t Answers::bytes() const { return 0; }
std::vector<std::uint32_t> Answers::ray_counts() const { return {}; }
std::string refusal(Trace, std::size_t) { return {}; }

}  // namespace gnomon::vulkan_rays
#endif
