#include <fmt/format.h>
#include <gnomon/kit/geometry/box_tree.h>
#include <gnomon/kit/vectorized.h>
#include <tbb/global_control.h>

#include "kit/rays/ray_body.h"
#include "kit/rays/ray_frame.h"

namespace gnomon {

static_assert(sizeof(ShadowPacket) == sizeof(RTCRay16) && offsetof(ShadowPacket, tfar) == offsetof(RTCRay16, tfar) &&
              offsetof(ShadowPacket, id) == offsetof(RTCRay16, id));

namespace {

/// A single ray from its origin to `tfar` lengths of its direction.
RTCRay ray_to(const glm::vec3& origin, const glm::vec3& direction, float tfar) {
  return {origin.x, origin.y, origin.z, 0, direction.x, direction.y, direction.z, 0, tfar, 0xffffffffu, 0, 0};
}

/// Lanes as Embree takes them: -1 is on.
GNOMON_VECTORIZED void lanes_from_bits(std::uint32_t valid, int* lanes) {
  for (int lane = 0; lane < 16; ++lane) lanes[lane] = valid & 1u << lane ? -1 : 0;
}

/// Makes the rays of lanes that are off empty. A processor that cannot trace 16 rays at once gets them as a stream, of which
/// Embree traces every ray that has a length, whatever `lanes` says: numbers that nobody wrote would be a ray.
GNOMON_VECTORIZED void empty_lanes(std::uint32_t valid, float* __restrict tnear, float* __restrict tfar) {
  for (int lane = 0; lane < 16; ++lane) {
    tnear[lane] = valid & 1u << lane ? tnear[lane] : 0;
    tfar[lane] = valid & 1u << lane ? tfar[lane] : -1;
  }
}

/// Embree sets tfar to minus infinity where something blocks.
GNOMON_VECTORIZED std::uint32_t blocked_bits(const float* tfar) {
  std::uint32_t blocked = 0;
  for (int lane = 0; lane < 16; ++lane) blocked |= tfar[lane] < 0 ? 1u << lane : 0;
  return blocked;
}

/// Whether anything blocks the rays, hits that the filter excludes left out; bit k is ray k.
std::uint32_t trace(RTCScene scene, std::uint32_t valid, ShadowPacket& packet, FilterContext& context,
                    RTCFilterFunctionN filter) {
  alignas(64) int lanes[16];
  lanes_from_bits(valid, lanes);
  empty_lanes(valid, packet.tnear.data(), packet.tfar.data());
  embree::occlude(lanes, scene, reinterpret_cast<RTCRay16*>(&packet), context.embree, filter);
  return blocked_bits(packet.tfar.data()) & valid;
}

/// Takes out of what a ray was reported to cross the triangles whose box it does not come near. Embree reports now and then a
/// triangle in whose plane the ray lies, at any distance: its tests divide rounding by rounding there. `scale` of the world to
/// the frame of the ray.
void leave_out_far(Crossings& crossings, const ShadowPacket& packet, int k, const Scene& scene, double scale) {
  const glm::vec3 origin(packet.ox[k], packet.oy[k], packet.oz[k]), direction(packet.dx[k], packet.dy[k], packet.dz[k]);
  const bool has_end = std::isfinite(packet.tfar[k]);
  const glm::dvec3 end = has_end ? glm::dvec3(origin) + double(packet.tfar[k]) * glm::dvec3(direction) : glm::dvec3(direction);
  const SegmentSlabs way({origin, {end, has_end ? 1 : 0}});
  const double size = std::max(extent(glm::dvec3(origin)), has_end ? extent(end) : 0);
  crossings.erase_if([&](const Crossings::Crossed& crossed) {
    Bounds box;
    for (const glm::vec3& corner : scene.meshes[crossed.mesh].corners(crossed.triangle).points)
      box.add(glm::vec3(scale * glm::dvec3(corner)));
    // Float32 rounds the corners, the ray and their products.
    const double reach = 16 * 0x1p-24 * std::max(size, box.extent());
    return !way.meets({{box.min.x, box.min.y, box.min.z}, {box.max.x, box.max.y, box.max.z}}, reach);
  });
}

}  // namespace

RayScene::Hit RayScene::Body::closest(const glm::dvec3& origin, const glm::dvec3& direction, RTCFilterFunctionN filter) const {
  const glm::dvec3 start = scale * origin;
  if (scale != 1 && !(extent(start) < too_far)) return {};
  RayContext ray{context(), start, direction};
  RTCRayHit query{ray_to(start, direction, INFINITY), {}};
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  embree::intersect(scene, query, ray.embree, filter);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return {};
  return {query.hit.geomID, query.hit.primID, glm::normalize(glm::dvec3(query.hit.Ng_x, query.hit.Ng_y, query.hit.Ng_z)),
          query.ray.tfar / scale};
}

RayScene::Hit RayScene::closest(const glm::dvec3& origin, const glm::dvec3& direction) const {
  return body_->closest(origin, direction, body_->has_masks ? exclude_holes_of_one : nullptr);
}

RayScene::Hit RayScene::closest_caster(const glm::dvec3& origin, const glm::dvec3& direction) const {
  return has_transmission() ? body_->closest(origin, direction, exclude_clear_of_one) : closest(origin, direction);
}

std::vector<RayScene::Met> RayScene::met(const glm::dvec3& origin, const glm::dvec3& way) const {
  struct Search : FilterContext {
    std::vector<Met> found;
  } search;
  search.masked = body_->context().masked;
  const RTCFilterFunctionN filter = [](const RTCFilterFunctionNArguments* args) {
    const auto* hit = reinterpret_cast<const RTCHit*>(args->hit);  // one ray
    auto& search = *static_cast<Search*>(reinterpret_cast<FilterContext*>(args->context));
    if (!search.masked || !search.masked->meshes[hit->geomID].transmission) search.found.push_back({hit->geomID, hit->primID});
    args->valid[0] = 0;
  };
  const glm::dvec3 start = body_->scale * origin;
  if (!(extent(start) < too_far)) return {};
  const double length = glm::length(way);
  RTCRay ray = ray_to(start, way / length, static_cast<float>(body_->scale * length));
  embree::occlude(body_->scene, ray, search.embree, filter);
  return search.found;
}

std::uint32_t RayScene::occluded(std::uint32_t valid, ShadowPacket& packet, const Receivers& receivers) const {
  if (body_->scale != 1 || is_short(valid, packet)) valid &= into_frame(packet, body_->scale);
  FilterContext context = body_->context(receivers);
  return trace(body_->scene, valid, packet, context, context.masked ? exclude_receiver_and_holes : exclude_receiver);
}

std::uint32_t RayScene::met(std::uint32_t valid, ShadowPacket& packet, const Receivers& receivers) const {
  if (body_->scale != 1 || is_short(valid, packet)) valid &= into_frame(packet, body_->scale);
  FilterContext context = body_->context(receivers);
  return trace(body_->scene, valid, packet, context, context.masked ? exclude_receiver_and_glass : exclude_receiver);
}

std::uint32_t RayScene::crossed(std::uint32_t valid, ShadowPacket& packet, const Receivers& receivers,
                                std::span<Crossings, ray_lanes> crossings) const {
  if (body_->scale != 1 || is_short(valid, packet)) valid &= into_frame(packet, body_->scale);
  for (Crossings& of_lane : crossings) of_lane.clear();
  CrossingsContext context{body_->context(receivers), crossings.data()};
  const std::uint32_t blocked =
      trace(body_->scene, valid, packet, context, context.masked ? collect_crossings : exclude_receiver);
  for (std::uint32_t left = valid & ~blocked; left; left &= left - 1)
    if (const int k = std::countr_zero(left); !crossings[k].empty())
      leave_out_far(crossings[k], packet, k, *body_->source, body_->scale);
  return blocked;
}

RayScene::Blocked RayScene::blocked(std::uint32_t valid, ShadowPacket& packet, const Receivers& receivers,
                                    double clearance) const {
  if (body_->scale != 1 || is_short(valid, packet)) valid &= into_frame(packet, body_->scale);
  DoubtContext context{body_->context(receivers), *body_->source, body_->scale * clearance, packet.tnear, packet.tfar};
  const std::uint32_t clearly = trace(body_->scene, valid, packet, context, exclude_doubtful);
  return {clearly | (context.doubtful & valid), clearly};
}

const EdgeAdjacency& RayScene::adjacency() const {
  std::call_once(*body_->is_joined, [&] {
    Scene traced;
    traced.meshes = body_->source->meshes;
    for (Mesh& mesh : traced.meshes)
      mesh.casts &= !mesh.transmission && (body_->truth == Truth::mesh || !mesh.has_curved_shape());
    body_->adjacency = EdgeAdjacency(traced);
  });
  return body_->adjacency;
}

// Embree's allocator gives blocks to the threads that take part in a build, and how many of them do is open.
std::size_t RayScene::bytes() const {
  if (!body_->bytes_of_one_thread) {
    const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
    const RayScene again(*body_->source, body_->truth, body_->which, body_->trees);
    body_->bytes_of_one_thread = again.body_->bytes_held();
  }
  return static_cast<std::size_t>(*body_->bytes_of_one_thread);
}

const Scene& RayScene::scene() const { return *body_->source; }
bool RayScene::has_alpha_masks() const { return body_->has_masks; }
bool RayScene::has_transmission() const { return body_->has_transmission; }

std::string RayScene::description() const {
  // The widest packet that Embree traces at once tells the instruction set it chose: 16 AVX-512, 8 AVX or AVX2, 4 SSE.
  const auto has = [&](RTCDeviceProperty property) { return rtcGetDeviceProperty(body_->device, property) != 0; };
  int width = has(RTC_DEVICE_PROPERTY_NATIVE_RAY8_SUPPORTED) ? 8 : 4;
  if (has(RTC_DEVICE_PROPERTY_NATIVE_RAY16_SUPPORTED)) width = 16;
  std::string text =
      fmt::format("Embree {}, {} rays at once, robust; receiver's triangle excluded, origin lifted by 8 * 2^-24 * max|P|",
                  embree_version(), width);
  if (body_->scale != 1) text += fmt::format("; traced at 2^{} of its size", std::ilogb(body_->scale));
  return text;
}
RTCSceneTy* RayScene::handle() const { return body_->scene; }

const char* embree_version() { return RTC_VERSION_STRING; }

double ray_offset(const glm::vec3& p) { return 8 * 0x1p-24 * extent(p); }

}  // namespace gnomon
