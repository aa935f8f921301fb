#include <gnomon/error.h>
#include <gnomon/kit/geometry/box_tree.h>
#include <gnomon/kit/geometry/contour.h>
#include <gnomon/kit/geometry/edges.h>
#include <gnomon/kit/vectorized.h>
#include <tbb/global_control.h>

#include <atomic>
#include <mutex>

#include "kit/rays/ray_filters.h"
#include "kit/rays/ray_frame.h"
#include "kit/rays/shape_rays.h"

namespace gnomon {

static_assert(sizeof(ShadowPacket) == sizeof(RTCRay16) && offsetof(ShadowPacket, tfar) == offsetof(RTCRay16, tfar) &&
              offsetof(ShadowPacket, id) == offsetof(RTCRay16, id));

/// The geometry that Embree traces in place of a mesh with an exact curved shape.
struct ShapeGeometry {
  Shape shape;
  std::uint32_t mesh;
};

namespace {

bool count_memory(void* sum, ssize_t bytes, bool) {
  *static_cast<std::atomic<std::int64_t>*>(sum) += bytes;
  return true;
}

/// A single ray from its origin to `tfar` lengths of its direction.
RTCRay ray_to(const glm::vec3& origin, const glm::vec3& direction, float tfar) {
  return {origin.x, origin.y, origin.z, 0, direction.x, direction.y, direction.z, 0, tfar, 0xffffffffu, 0, 0};
}

void shape_bounds(const RTCBoundsFunctionArguments* args) {
  const Bounds box = shape_bounds(static_cast<const ShapeGeometry*>(args->geometryUserPtr)->shape);
  *args->bounds_o = {box.min.x, box.min.y, box.min.z, 0, box.max.x, box.max.y, box.max.z, 0};
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

void intersect_shape(const RTCIntersectFunctionNArguments* args) {
  const auto& geometry = *static_cast<const ShapeGeometry*>(args->geometryUserPtr);
  RTCRayN* rays = RTCRayHitN_RayN(args->rayhit, args->N);
  RTCHitN* hits = RTCRayHitN_HitN(args->rayhit, args->N);
  for (unsigned lane = 0; lane < args->N; ++lane) {
    if (args->valid[lane] == 0) continue;
    const LaneRay ray = lane_ray(rays, args->N, lane);
    const ShapeHit hit = first_hit(geometry.shape, ray.origin, ray.direction, ray.tnear, ray.tfar);
    if (!hit.found) continue;
    RTCRayN_tfar(rays, args->N, lane) = static_cast<float>(hit.t);
    RTCHitN_Ng_x(hits, args->N, lane) = static_cast<float>(hit.normal.x);
    RTCHitN_Ng_y(hits, args->N, lane) = static_cast<float>(hit.normal.y);
    RTCHitN_Ng_z(hits, args->N, lane) = static_cast<float>(hit.normal.z);
    RTCHitN_geomID(hits, args->N, lane) = args->geomID;
    RTCHitN_primID(hits, args->N, lane) = 0;
    RTCHitN_instID(hits, args->N, lane, 0) = RTC_INVALID_GEOMETRY_ID;
  }
}

/// A point of a convex body is never in that body's own shadow when its outward normal faces the light; when the eye, hence
/// the normal, is inside, the body blocks where the ray leaves it. The ray offset decides: it is some times what rounding the
/// point may move it, so the origin lies inside the receiver's own body exactly when the normal points inward.
void occlude_shape(const RTCOccludedFunctionNArguments* args) {
  const auto& geometry = *static_cast<const ShapeGeometry*>(args->geometryUserPtr);
  const auto& receivers = reinterpret_cast<const FilterContext*>(args->context)->receivers;
  if (!receivers.mesh) return;
  for (unsigned lane = 0; lane < args->N; ++lane) {
    if (args->valid[lane] == 0) continue;
    const LaneRay ray = lane_ray(args->ray, args->N, lane);
    const bool is_own = receivers.mesh[RTCRayN_id(args->ray, args->N, lane)] == geometry.mesh;
    if (is_own && !contains(geometry.shape, ray.origin)) continue;
    if (first_hit(geometry.shape, ray.origin, ray.direction, ray.tnear, ray.tfar).found)
      RTCRayN_tfar(args->ray, args->N, lane) = -INFINITY;
  }
}

Shape scaled(const Shape& shape, double scale) {
  const auto length = static_cast<float>(scale);
  if (const auto* sphere = std::get_if<Sphere>(&shape)) return Sphere{sphere->center * length, sphere->radius * length};
  if (const auto* disc = std::get_if<Disc>(&shape)) return Disc{disc->center * length, disc->normal, disc->radius * length};
  const auto& cone = std::get<Cone>(shape);
  return Cone{cone.base * length, cone.axis, cone.radius * length, cone.height * length};
}

bool has_degenerate(const Mesh& mesh) {
  return std::ranges::any_of(mesh.triangles, [&](const glm::uvec3& t) {
    return is_degenerate(mesh.positions[t.x], mesh.positions[t.y], mesh.positions[t.z]);
  });
}

/// Gives a geometry the triangles of a mesh. One without area gets its first corner three times: Embree's normal of it is then
/// exactly 0, which it takes for no hit. That of three places in a line is what float32 rounds, and may be hit.
void set_sound_triangles(RTCGeometry geometry, const Mesh& mesh) {
  auto* triangles = static_cast<glm::uvec3*>(
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, sizeof(glm::uvec3), mesh.triangles.size()));
  std::ranges::transform(mesh.triangles, triangles, [&](const glm::uvec3& t) {
    return is_degenerate(mesh.positions[t.x], mesh.positions[t.y], mesh.positions[t.z]) ? glm::uvec3(t.x) : t;
  });
}

/// Whether anything blocks the rays, hits that the filter excludes left out; bit k is ray k.
std::uint32_t trace(RTCScene scene, std::uint32_t valid, ShadowPacket& packet, FilterContext& context,
                    RTCFilterFunctionN filter) {
  rtcInitIntersectContext(&context.embree);
  context.embree.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  context.embree.filter = filter;
  alignas(64) int lanes[16];
  lanes_from_bits(valid, lanes);
  empty_lanes(valid, packet.tnear.data(), packet.tfar.data());
  rtcOccluded16(lanes, scene, &context.embree, reinterpret_cast<RTCRay16*>(&packet));
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

struct RayScene::Body {
  const Scene* source = nullptr;
  Truth truth = Truth::shape;
  Which which = Which::seen;
  double scale = 1;                     ///< of the world to the frame that is traced
  bool has_masks = false;               ///< of a mesh that is traced
  bool has_transmission = false;        ///< the same
  std::atomic<std::int64_t> bytes = 0;  ///< Embree counts them per device, so every RayScene has one of its own
  std::optional<std::int64_t> bytes_of_one_thread;
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
  std::vector<std::unique_ptr<ShapeGeometry>> shapes;
  std::once_flag is_joined;
  EdgeAdjacency adjacency;
  FilterContext context(const Receivers& receivers = {}) const {
    return {.receivers = receivers, .masked = has_masks || has_transmission ? source : nullptr, .scale = scale};
  }
  /// Hits that the filter excludes, if there is one, left out.
  Hit closest(const glm::dvec3& origin, const glm::dvec3& direction, RTCFilterFunctionN filter) const;
  ~Body() {
    rtcReleaseScene(scene);
    rtcReleaseDevice(device);
  }
};

RayScene::RayScene(const Scene& scene, Truth truth, Which which) : body_(std::make_shared<Body>()) {
  body_->source = &scene;
  body_->truth = truth;
  body_->which = which;
  body_->device = rtcNewDevice("verbose=0");
  if (!body_->device) throw Error("Embree cannot start: error {}", static_cast<int>(rtcGetDeviceError(nullptr)));
  rtcSetDeviceMemoryMonitorFunction(body_->device, count_memory, &body_->bytes);
  body_->scene = rtcNewScene(body_->device);
  body_->scale = traced_scale(scene);
  rtcSetSceneFlags(body_->scene, static_cast<RTCSceneFlags>(RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION));
  for (std::uint32_t index = 0; index < scene.meshes.size(); ++index) {
    const Mesh& mesh = scene.meshes[index];
    if (!(which == Which::casters ? mesh.casts : mesh.seen)) continue;
    RTCGeometry geometry;
    if (truth == Truth::shape && mesh.has_curved_shape()) {
      body_->shapes.push_back(std::make_unique<ShapeGeometry>(ShapeGeometry{scaled(*mesh.shape, body_->scale), index}));
      geometry = rtcNewGeometry(body_->device, RTC_GEOMETRY_TYPE_USER);
      rtcSetGeometryUserPrimitiveCount(geometry, 1);
      rtcSetGeometryUserData(geometry, body_->shapes.back().get());
      rtcSetGeometryBoundsFunction(geometry, shape_bounds, nullptr);
      rtcSetGeometryIntersectFunction(geometry, intersect_shape);
      rtcSetGeometryOccludedFunction(geometry, occlude_shape);
    } else {
      if (mesh.triangles.empty()) continue;
      body_->has_masks |= mesh.alpha_mask != nullptr;
      body_->has_transmission |= mesh.transmission != nullptr;
      geometry = rtcNewGeometry(body_->device, RTC_GEOMETRY_TYPE_TRIANGLE);
      // Embree reads 16 bytes per vertex, so positions are copied into a buffer that it pads.
      auto* vertices = static_cast<glm::vec3*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                                       sizeof(glm::vec3), mesh.positions.size()));
      std::ranges::transform(mesh.positions, vertices,
                             [&](const glm::vec3& p) { return glm::vec3(body_->scale * glm::dvec3(p)); });
      // Of a scene that stands still such triangles were dropped when it was loaded.
      if ((scene.motion || scene.pose_number != 0) && has_degenerate(mesh))
        set_sound_triangles(geometry, mesh);
      else
        rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, mesh.triangles.data(), 0,
                                   sizeof(glm::uvec3), mesh.triangles.size());
    }
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(body_->scene, geometry, index);
    rtcReleaseGeometry(geometry);
  }
  rtcCommitScene(body_->scene);
  if (const RTCError code = rtcGetDeviceError(body_->device); code != RTC_ERROR_NONE)
    throw Error("Embree cannot build the scene {}: error {}", scene.name, static_cast<int>(code));
}

RayScene::Hit RayScene::Body::closest(const glm::dvec3& origin, const glm::dvec3& direction, RTCFilterFunctionN filter) const {
  const glm::dvec3 start = scale * origin;
  if (scale != 1 && !(extent(start) < too_far)) return {};
  RayContext ray{context(), start, direction};
  rtcInitIntersectContext(&ray.embree);
  ray.embree.filter = filter;
  RTCRayHit query{ray_to(start, direction, INFINITY), {}};
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(scene, &ray.embree, &query);
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
  rtcInitIntersectContext(&search.embree);
  search.embree.filter = [](const RTCFilterFunctionNArguments* args) {
    const auto* hit = reinterpret_cast<const RTCHit*>(args->hit);  // one ray
    auto& search = *static_cast<Search*>(reinterpret_cast<FilterContext*>(args->context));
    if (!search.masked || !search.masked->meshes[hit->geomID].transmission) search.found.push_back({hit->geomID, hit->primID});
    args->valid[0] = 0;
  };
  const glm::dvec3 start = body_->scale * origin;
  if (!(extent(start) < too_far)) return {};
  const double length = glm::length(way);
  RTCRay ray = ray_to(start, way / length, static_cast<float>(body_->scale * length));
  rtcOccluded1(body_->scene, &search.embree, &ray);
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
  std::call_once(body_->is_joined, [&] {
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
    const RayScene again(*body_->source, body_->truth, body_->which);
    body_->bytes_of_one_thread = again.body_->bytes.load();
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
                  RTC_VERSION_STRING, width);
  if (body_->scale != 1) text += fmt::format("; traced at 2^{} of its size", std::ilogb(body_->scale));
  return text;
}
RTCSceneTy* RayScene::handle() const { return body_->scene; }

double ray_offset(const glm::vec3& p) { return 8 * 0x1p-24 * extent(p); }

}  // namespace gnomon
