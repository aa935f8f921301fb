#include <gnomon/error.h>
#include <gnomon/kit/geometry/contour.h>
#include <gnomon/kit/parallel.h>

#include <algorithm>

#include "kit/rays/ray_body.h"
#include "kit/rays/ray_frame.h"
#include "kit/rays/shape_rays.h"

namespace gnomon {

namespace {

bool count_memory(void* sum, ssize_t bytes, bool) {
  *static_cast<std::atomic<std::int64_t>*>(sum) += bytes;
  return true;
}

void shape_bounds(const RTCBoundsFunctionArguments* args) {
  const Bounds box = shape_bounds(static_cast<const ShapeGeometry*>(args->geometryUserPtr)->shape);
  *args->bounds_o = {box.min.x, box.min.y, box.min.z, 0, box.max.x, box.max.y, box.max.z, 0};
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
    embree::set_no_instance(hits, args->N, lane);
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

}  // namespace

std::vector<std::uint32_t> degenerate_triangles(const Mesh& mesh) {
  constexpr std::size_t block = 4096;
  std::vector<std::vector<std::uint32_t>> found((mesh.triangles.size() + block - 1) / block);
  for_blocks(mesh.triangles.size(), block, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) {
      const glm::uvec3& v = mesh.triangles[t];
      if (is_degenerate(mesh.positions[v.x], mesh.positions[v.y], mesh.positions[v.z]))
        found[begin / block].push_back(static_cast<std::uint32_t>(t));
    }
  });
  std::vector<std::uint32_t> all;
  for (const std::vector<std::uint32_t>& some : found) all.insert(all.end(), some.begin(), some.end());
  return all;
}

void set_triangles(RTCGeometry geometry, const Mesh& mesh, std::span<const std::uint32_t> degenerate) {
  if (degenerate.empty())
    return rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, mesh.triangles.data(), 0,
                                      sizeof(glm::uvec3), mesh.triangles.size());
  auto* triangles = static_cast<glm::uvec3*>(
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, sizeof(glm::uvec3), mesh.triangles.size()));
  std::ranges::copy(mesh.triangles, triangles);
  for (const std::uint32_t t : degenerate) triangles[t] = glm::uvec3(mesh.triangles[t].x);
}

std::shared_ptr<RayScene::Body> RayScene::Body::built(const Scene& scene, Truth truth, Which which, Trees trees) {
  auto body = std::make_shared<Body>();
  body->source = &scene;
  body->truth = truth;
  body->which = which;
  body->trees = trees;
  body->still_extent = extent_of_still(scene);
  body->scale = traced_scale(scene, body->still_extent);
  body->build();
  return body;
}

void RayScene::Body::build() {
  device = rtcNewDevice("verbose=0");
  if (!device) throw Error("Embree cannot start: error {}", static_cast<int>(rtcGetDeviceError(nullptr)));
  // The same names take their arguments in another order in another major version.
  if (const auto linked = rtcGetDeviceProperty(device, RTC_DEVICE_PROPERTY_VERSION_MAJOR); linked != RTC_VERSION_MAJOR)
    throw Error("Embree {} is linked, and the program was compiled for {}", linked, RTC_VERSION_MAJOR);
  rtcSetDeviceMemoryMonitorFunction(device, count_memory, &bytes);
  scene = rtcNewScene(device);
  int flags = RTC_SCENE_FLAG_ROBUST | embree::filter_flag;
  if (trees == Trees::moving) {
    // A tree over the trees of the meshes, which Embree keeps from one commit to the next in dynamic scenes alone.
    flags |= RTC_SCENE_FLAG_DYNAMIC;
    rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_LOW);
  }
  rtcSetSceneFlags(scene, static_cast<RTCSceneFlags>(flags));
  for (std::uint32_t index = 0; index < source->meshes.size(); ++index) {
    const Mesh& mesh = source->meshes[index];
    if (!(which == Which::casters ? mesh.casts : mesh.seen)) continue;
    if (truth == Truth::shape && mesh.has_curved_shape())
      add_shape(index);
    else if (!mesh.triangles.empty())
      add_triangles(index);
  }
  commit();
}

void RayScene::Body::add_shape(std::uint32_t index) {
  shapes.push_back(std::make_unique<ShapeGeometry>(ShapeGeometry{scaled(*source->meshes[index].shape, scale), index}));
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER);
  rtcSetGeometryUserPrimitiveCount(geometry, 1);
  rtcSetGeometryUserData(geometry, shapes.back().get());
  rtcSetGeometryBoundsFunction(geometry, shape_bounds, nullptr);
  rtcSetGeometryIntersectFunction(geometry, intersect_shape);
  rtcSetGeometryOccludedFunction(geometry, occlude_shape);
  attach(geometry, index);
}

void RayScene::Body::add_triangles(std::uint32_t index) {
  const Mesh& mesh = source->meshes[index];
  has_masks |= mesh.alpha_mask != nullptr;
  has_transmission |= mesh.transmission != nullptr;
  TracedMesh traced{.mesh = index, .moves = trees == Trees::moving && !mesh.reach.empty()};
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  // Embree reads 16 bytes per vertex, so positions are copied into a buffer that it pads.
  write(mesh, 0, mesh.positions.size(),
        static_cast<glm::vec3*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                        sizeof(glm::vec3), mesh.positions.size())));
  // Of a scene that stands still such triangles were dropped when it was loaded.
  if (source->motion || source->pose_number != 0) traced.degenerate = degenerate_triangles(mesh);
  set_triangles(geometry, mesh, traced.degenerate);
  if (traced.moves) {
    rtcSetGeometryBuildQuality(geometry, RTC_BUILD_QUALITY_REFIT);
    traced.sample = TreeSample(mesh);
    traced.built_cost = traced.sample.cost();
  }
  attach(geometry, index);
  meshes.push_back(std::move(traced));
}

void RayScene::Body::attach(RTCGeometry geometry, std::uint32_t index) {
  rtcCommitGeometry(geometry);
  rtcAttachGeometryByID(scene, geometry, index);
  rtcReleaseGeometry(geometry);
}

void RayScene::Body::write(const Mesh& mesh, std::size_t first, std::size_t count, glm::vec3* vertices) const {
  for (std::size_t v = first; v < first + count; ++v) vertices[v] = glm::vec3(scale * glm::dvec3(mesh.positions[v]));
}

void RayScene::Body::commit() {
  rtcCommitScene(scene);
  if (const RTCError code = rtcGetDeviceError(device); code != RTC_ERROR_NONE)
    throw Error("Embree cannot build the scene {}: error {}", source->name, static_cast<int>(code));
}

std::int64_t RayScene::Body::bytes_held() const {
  std::int64_t sum = bytes;
  for (const TracedMesh& traced : meshes) sum += static_cast<std::int64_t>(traced.sample.bytes());
  return sum;
}

RayScene::RayScene(const Scene& scene, Truth truth, Which which, Trees trees)
    : body_(Body::built(scene, truth, which, trees)) {}

}  // namespace gnomon
