#include <gnomon/error.h>
#include <gnomon/kit/area/path_light.h>
#include <gnomon/kit/geometry/across.h>
#include <gnomon/kit/parallel.h>
#include <gnomon/kit/random.h>

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <numbers>

#include "kit/rays/shape_rays.h"

namespace gnomon {

namespace {

constexpr double pi = std::numbers::pi;

/// Where a path is: a point of a surface, its unit normal on the side that light comes to and goes from.
struct Place {
  glm::vec3 point;
  glm::dvec3 normal;
  std::uint32_t mesh, triangle;
};

/// The paths of one pixel.
class PixelPaths {
 public:
  PixelPaths(const LightSurfaces& surfaces, const GBuffer& gbuffer, std::size_t pixel, const Light& light,
             const PathOptions& options)
      : surfaces_(surfaces),
        gbuffer_(gbuffer),
        pixel_(pixel),
        light_(light),
        options_(options),
        random_((options.seed << 33) + pixel, 77),
        albedo_(surfaces.scene.meshes[gbuffer.mesh[pixel]].albedo) {}

  void trace() {
    ask_first(
        surfaces_.casters, gbuffer_, pixel_, light_, options_,
        [&](const LightFigure& figure, const Squares& squares, const FaceHits& hits) { add_direct(figure, squares, hits); });
    if (options_.bounces == 0 || albedo_ == glm::dvec3(0)) return;
    const Scramble ways(path_seed(options_, pixel_, true));
    for (int round = 0; 16 * round < options_.samples; ++round)
      follow(path_lanes(options_, round), ways.of_each(static_cast<std::uint32_t>(round)));
  }

  std::size_t ray_count() const { return ray_count_; }
  float visibility() const { return irradiance_ > 0 ? static_cast<float>(1 - blocked_irradiance_ / irradiance_) : 1.0f; }
  /// Mean and standard error, as of shares of a light: each replica is off by what it differs from its part of the mean.
  void write(float* radiance, float* error) const {
    for (int c = 0; c < 3; ++c) {
      double sum = 0, squares = 0;
      for (const glm::dvec3& replica : sums_) sum += replica[c];
      const double mean = sum / options_.samples, replica_share = static_cast<double>(ray_replicas) / options_.samples;
      for (int k = 0; k < ray_replicas; ++k) {
        const double off = (sums_[k][c] - paths_of(k) * mean) * replica_share;
        squares += off * off;
      }
      radiance[c] = static_cast<float>(mean);
      error[c] = static_cast<float>(std::sqrt(squares / (ray_replicas - 1) / ray_replicas));
    }
  }

 private:
  /// Paths of a replica: it has every eighth.
  int paths_of(int replica) const { return (options_.samples - replica + ray_replicas - 1) / ray_replicas; }

  void add_direct(const LightFigure& figure, const Squares& squares, const FaceHits& hits) {
    ray_count_ += static_cast<std::size_t>(std::popcount(hits.asked));
    const glm::dvec2 size = figure.box().high - figure.box().low;
    for (std::uint32_t left = hits.asked; left; left &= left - 1) {
      const int k = std::countr_zero(left);
      const glm::dvec2 place = figure.box().at({squares.x[k], squares.y[k]});
      const double irradiance = figure.weight(figure.at(place)) * size.x * size.y;
      irradiance_ += irradiance;
      if (hits.blocked >> k & 1)
        blocked_irradiance_ += irradiance;
      else
        sums_[k % ray_replicas] += albedo_ * (light_.intensity / pi * irradiance);
    }
  }

  /// Follows sixteen paths from the pixel's point, side by side, until all have ended.
  void follow(std::uint32_t alive, const Squares& first) {
    std::array<Place, ray_lanes> places;
    std::array<glm::dvec3, ray_lanes> carried;  // what of the light at a place comes to the eye
    places.fill({gbuffer_.position(pixel_), gbuffer_.normal(pixel_), gbuffer_.mesh[pixel_], gbuffer_.triangle[pixel_]});
    carried.fill(albedo_);
    const int most = options_.bounces.value_or(most_bounces);
    for (int bounce = 1; alive && bounce <= most; ++bounce) {
      for (std::uint32_t left = alive; left; left &= left - 1) {
        const int k = std::countr_zero(left);
        const double x = bounce == 1 ? first.x[k] : random_.uniform(0, 1), y = bounce == 1 ? first.y[k] : random_.uniform(0, 1);
        if (!go_on(places[k], cosine_direction(places[k].normal, x, y)))
          alive &= ~(1u << k);
        else
          carried[k] *= glm::dvec3(surfaces_.scene.meshes[places[k].mesh].albedo);
      }
      add_light(alive, places, carried);
      alive = those_that_go_on(alive, bounce, places, carried);
    }
  }

  /// To the first surface that way, turned to where the ray came from; whether there is one.
  bool go_on(Place& place, const glm::dvec3& way) {
    ++ray_count_;
    const glm::dvec3 origin = glm::dvec3(place.point) + ray_offset(place.point) * place.normal;
    const RayScene::Hit hit = surfaces_.all.closest(origin, way);
    if (hit.mesh == no_mesh) return false;
    const Mesh& mesh = surfaces_.scene.meshes[hit.mesh];
    glm::dvec3 point = origin + hit.t * way, normal = hit.normal;
    // Made exact in double, as the points of a G-buffer are, before it is rounded.
    if (gbuffer_.truth == Truth::shape && mesh.has_curved_shape()) {
      if (const ShapeHit exact = first_hit(*mesh.shape, origin, way, 0, INFINITY); exact.found) {
        point = origin + exact.t * way;
        normal = exact.normal;
      }
    } else {
      const Triangle triangle = mesh.corners(hit.triangle);
      normal = glm::normalize(triangle.normal());
      point -= glm::dot(normal, point - glm::dvec3(triangle.points[0])) * normal;
    }
    place = {glm::vec3(point), glm::dot(normal, way) > 0 ? -normal : normal, hit.mesh, hit.triangle};
    return true;
  }

  /// What comes of the lamp to each place, by one shadow ray.
  void add_light(std::uint32_t alive, const std::array<Place, ray_lanes>& places,
                 const std::array<glm::dvec3, ray_lanes>& carried) {
    ShadowPacket packet;
    std::array<std::uint32_t, ray_lanes> meshes, triangles;
    std::array<double, ray_lanes> irradiance;
    std::uint32_t asked = 0;
    for (std::uint32_t left = alive; left; left &= left - 1) {
      const int k = std::countr_zero(left);
      const Place& place = places[k];
      const double x = random_.uniform(0, 1), y = random_.uniform(0, 1);
      const LightFigure figure(light_, place.point, place.normal);
      if (!figure.is_seen()) continue;
      const glm::dvec2 size = figure.box().high - figure.box().low, at = figure.box().at({x, y});
      if (!figure.holds(at)) continue;
      const glm::dvec3 to = figure.at(at);
      irradiance[k] = figure.weight(to) * size.x * size.y;
      const glm::vec3 lift = static_cast<float>(area_ray_offset(place.point)) * glm::vec3(place.normal);
      set_ray(packet, k, place.point + lift, glm::vec3(to) - lift, 1);
      meshes[k] = place.mesh;
      triangles[k] = place.triangle;
      asked |= 1u << k;
    }
    if (!asked) return;
    ray_count_ += static_cast<std::size_t>(std::popcount(asked));
    const std::uint32_t blocked = surfaces_.casters.occluded(asked, packet, {meshes.data(), triangles.data()});
    for (std::uint32_t left = asked & ~blocked; left; left &= left - 1) {
      const int k = std::countr_zero(left);
      sums_[k % ray_replicas] += carried[k] * (light_.intensity / pi * irradiance[k]);
    }
  }

  /// The paths that are worth another surface. Without a number of bounces each has a chance, and counts the more by it.
  std::uint32_t those_that_go_on(std::uint32_t alive, int bounce, const std::array<Place, ray_lanes>& places,
                                 std::array<glm::dvec3, ray_lanes>& carried) {
    for (std::uint32_t left = alive; left; left &= left - 1) {
      const int k = std::countr_zero(left);
      const auto& albedo = surfaces_.scene.meshes[places[k].mesh].albedo;
      const double chance = options_.bounces || bounce < 2 ? 1 : std::max({albedo.x, albedo.y, albedo.z});
      if (carried[k] == glm::dvec3(0) || (chance < 1 && random_.uniform(0, 1) >= chance))
        alive &= ~(1u << k);
      else if (chance < 1)
        carried[k] /= chance;
    }
    return alive;
  }

  const LightSurfaces& surfaces_;
  const GBuffer& gbuffer_;
  const std::size_t pixel_;
  const Light& light_;
  const PathOptions& options_;
  Random random_;
  const glm::dvec3 albedo_;
  std::array<glm::dvec3, ray_replicas> sums_{};
  double irradiance_ = 0, blocked_irradiance_ = 0;  // sums over the first shadow rays
  std::size_t ray_count_ = 0;
};

}  // namespace

std::optional<std::string> endless_bounces(const Scene& scene) {
  for (const Mesh& mesh : scene.meshes)
    if (const float most = std::max({mesh.albedo.x, mesh.albedo.y, mesh.albedo.z}); !(most < 1))
      return fmt::format("mesh {} has an albedo of {}, and all bounces would add up without end: below 1 is required",
                         mesh.name, most);
  return std::nullopt;
}

std::optional<std::string> untraceable_light(const Scene& scene) {
  if (scene.has_transmission())
    return "the scene has casters that let a part of the light through (transmission), and light paths do not go through them";
  return endless_bounces(scene);
}

PathPicture trace_paths(const LightSurfaces& surfaces, const GBuffer& gbuffer, const Light& light, const PathOptions& options,
                        std::atomic<std::size_t>* done) {
  assert(has_area(light) && options.samples >= ray_lanes);
  if (surfaces.scene.has_transmission()) throw Error("scene {}: {}", surfaces.scene.name, *untraceable_light(surfaces.scene));
  PathPicture picture{std::vector<float>(3 * gbuffer.size(), 0.0f), std::vector<float>(3 * gbuffer.size(), 0.0f),
                      std::vector<float>(gbuffer.size(), 1.0f), 0};
  std::atomic<std::size_t> ray_count = 0;
  for_blocks(gbuffer.size(), 64, [&](std::size_t begin, std::size_t end) {
    std::size_t rays = 0;
    for (std::size_t i = begin; i < end; ++i) {
      if (gbuffer.is_background(i)) continue;
      PixelPaths paths(surfaces, gbuffer, i, light, options);
      paths.trace();
      paths.write(&picture.radiance[3 * i], &picture.error[3 * i]);
      picture.visibility[i] = paths.visibility();
      rays += paths.ray_count();
    }
    ray_count += rays;
    if (done) *done += end - begin;
  });
  picture.rays = ray_count;
  return picture;
}

}  // namespace gnomon
