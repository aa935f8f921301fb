#pragma once
#include <gnomon/kit/geometry/holes.h>
#include <gnomon/kit/rays/rays.h>

#include "kit/rays/embree.h"

// Which hits count: Embree calls this for every triangle that a ray meets.
namespace gnomon {

/// What the filter and the shape callbacks see beside Embree's own context; ray ids are lane numbers.
struct FilterContext {
  embree::Context embree = {};
  Receivers receivers = {};       ///< none: exact curved shapes let all through
  const Scene* masked = nullptr;  ///< whose alpha masks and transmission count; null: all triangles are solid and opaque
  double scale = 1;               ///< of the world to the frame that is traced
};

inline void exclude_receiver(const RTCFilterFunctionNArguments* args) {
  const auto& receivers = reinterpret_cast<const FilterContext*>(args->context)->receivers;
  for (unsigned lane = 0; lane < args->N; ++lane) {
    if (args->valid[lane] == 0) continue;
    const unsigned id = RTCRayN_id(args->ray, args->N, lane);
    if (RTCHitN_geomID(args->hit, args->N, lane) == receivers.mesh[id] &&
        RTCHitN_primID(args->hit, args->N, lane) == receivers.triangle[id])
      args->valid[lane] = 0;
  }
}

struct LaneRay {
  glm::dvec3 origin, direction;
  double tnear, tfar;
};

inline LaneRay lane_ray(RTCRayN* rays, unsigned count, unsigned lane) {
  return {{RTCRayN_org_x(rays, count, lane), RTCRayN_org_y(rays, count, lane), RTCRayN_org_z(rays, count, lane)},
          {RTCRayN_dir_x(rays, count, lane), RTCRayN_dir_y(rays, count, lane), RTCRayN_dir_z(rays, count, lane)},
          RTCRayN_tnear(rays, count, lane),
          RTCRayN_tfar(rays, count, lane)};
}

/// Lets rays through the holes of alpha masks and through transmission; `crossed(lane, mesh, triangle)` is told of the latter.
template <class Crossed>
void exclude_holes(const RTCFilterFunctionNArguments* args, const Crossed& crossed) {
  const auto& context = *reinterpret_cast<const FilterContext*>(args->context);
  for (unsigned lane = 0; lane < args->N; ++lane) {
    if (args->valid[lane] == 0) continue;
    const std::uint32_t index = RTCHitN_geomID(args->hit, args->N, lane), triangle = RTCHitN_primID(args->hit, args->N, lane);
    const Mesh& mesh = context.masked->meshes[index];
    if (mesh.alpha_mask) {
      const LaneRay ray = lane_ray(args->ray, args->N, lane);
      if (!is_solid_along(mesh, triangle, ray.origin, ray.direction, context.scale)) args->valid[lane] = 0;
    }
    if (!mesh.transmission || args->valid[lane] == 0) continue;
    crossed(RTCRayN_id(args->ray, args->N, lane), index, triangle);
    args->valid[lane] = 0;
  }
}

inline void exclude_holes(const RTCFilterFunctionNArguments* args) {
  exclude_holes(args, [](unsigned, std::uint32_t, std::uint32_t) {});
}

/// Lets rays through transmission alone.
inline void exclude_receiver_and_glass(const RTCFilterFunctionNArguments* args) {
  exclude_receiver(args);
  const auto& context = *reinterpret_cast<const FilterContext*>(args->context);
  for (unsigned lane = 0; lane < args->N; ++lane)
    if (args->valid[lane] != 0 && context.masked->meshes[RTCHitN_geomID(args->hit, args->N, lane)].transmission)
      args->valid[lane] = 0;
}

inline void exclude_receiver_and_holes(const RTCFilterFunctionNArguments* args) {
  exclude_receiver(args);
  exclude_holes(args);
}

/// What `collect_crossings` fills, by ray.
struct CrossingsContext : FilterContext {
  Crossings* crossings;
};
inline void collect_crossings(const RTCFilterFunctionNArguments* args) {
  exclude_receiver(args);
  const auto& context = static_cast<const CrossingsContext&>(*reinterpret_cast<const FilterContext*>(args->context));
  exclude_holes(args,
                [&](unsigned ray, std::uint32_t mesh, std::uint32_t triangle) { context.crossings[ray].add(mesh, triangle); });
}

/// A single ray, as it was before it was rounded for Embree.
struct RayContext : FilterContext {
  glm::dvec3 origin, direction;
};
inline void exclude_holes_of_one(const RTCFilterFunctionNArguments* args) {
  const auto& context = static_cast<const RayContext&>(*reinterpret_cast<const FilterContext*>(args->context));
  const auto* hit = reinterpret_cast<const RTCHit*>(args->hit);
  if (!is_solid_along(context.masked->meshes[hit->geomID], hit->primID, context.origin, context.direction, context.scale))
    args->valid[0] = 0;
}

/// The same, and lets it through texels that let all light through.
inline void exclude_clear_of_one(const RTCFilterFunctionNArguments* args) {
  exclude_holes_of_one(args);
  if (args->valid[0] == 0) return;
  const auto& context = static_cast<const RayContext&>(*reinterpret_cast<const FilterContext*>(args->context));
  const auto* hit = reinterpret_cast<const RTCHit*>(args->hit);
  const Mesh& mesh = context.masked->meshes[hit->geomID];
  if (transmission_along(mesh, hit->primID, context.origin, context.direction, context.scale) == glm::vec3(1))
    args->valid[0] = 0;
}

/// What `exclude_doubtful` sees: the rays, as they are traced, and where in the scene they go. It notes the rays in `doubtful`.
struct DoubtContext : FilterContext {
  const Scene& scene;
  double clearance;
  std::array<float, 16> tnear, tfar;
  std::uint32_t doubtful = 0;
};

/// Whether a ray goes through a triangle, scaled to the frame that is traced, with so much room on all sides that its float32
/// numbers leave no doubt.
inline bool is_clear(const LaneRay& ray, const Triangle& triangle, double scale, double clearance) {
  glm::dvec3 v[3];
  double turn[3];
  for (int k = 0; k < 3; ++k) v[k] = scale * glm::dvec3(triangle.points[k]) - ray.origin;
  for (int k = 0; k < 3; ++k) {
    const glm::dvec3 &from = v[k], &to = v[(k + 1) % 3];
    turn[k] = glm::dot(glm::cross(from, to), ray.direction);
    // Over the length on the right this is the distance of two lines.
    if (!(std::abs(turn[k]) > clearance * glm::length(glm::cross(to - from, ray.direction)))) return false;
  }
  if ((turn[0] > 0) != (turn[1] > 0) || (turn[0] > 0) != (turn[2] > 0)) return false;
  const glm::dvec3 normal = glm::cross(v[1] - v[0], v[2] - v[0]);
  const double t = glm::dot(normal, v[0]) / glm::dot(normal, ray.direction), room = clearance / glm::length(ray.direction);
  return t > std::max(ray.tnear + room, 4 * room) && t < ray.tfar - room;
}

inline void exclude_doubtful(const RTCFilterFunctionNArguments* args) {
  exclude_receiver(args);
  if (reinterpret_cast<const FilterContext*>(args->context)->masked) exclude_holes(args);
  auto& context = static_cast<DoubtContext&>(*reinterpret_cast<FilterContext*>(args->context));
  for (unsigned lane = 0; lane < args->N; ++lane) {
    if (args->valid[lane] == 0) continue;
    const unsigned id = RTCRayN_id(args->ray, args->N, lane);
    const Mesh& mesh = context.scene.meshes[RTCHitN_geomID(args->hit, args->N, lane)];
    const Triangle triangle = mesh.corners(RTCHitN_primID(args->hit, args->N, lane));
    LaneRay ray = lane_ray(args->ray, args->N, lane);
    ray.tnear = context.tnear[id];
    ray.tfar = context.tfar[id];
    if (is_clear(ray, triangle, context.scale, context.clearance)) continue;
    context.doubtful |= 1u << id;
    args->valid[lane] = 0;
  }
}

}  // namespace gnomon
