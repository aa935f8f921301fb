#include "pixel_rays.h"

#include <gnomon/kit/bytes.h>
#include <gnomon/kit/parallel.h>

#include <atomic>
#include <bit>

namespace gnomon::denoised_rays {

std::size_t RayPlanes::bytes() const { return bytes_of(asked, seen, distance, dark, faces); }

std::optional<LightFigure> FrameRays::figure(std::size_t pixel) const {
  if (gbuffer_.is_background(pixel) || !casters_.scene().meshes[gbuffer_.mesh[pixel]].receives) return std::nullopt;
  const LightFigure figure(light_, gbuffer_.position(pixel), gbuffer_.normal(pixel));
  if (!figure.is_seen()) return std::nullopt;
  return figure;
}

Squares FrameRays::squares(const LightFigure& figure, std::size_t pixel) const {
  Squares squares;
  squares.x.fill(0.5f);
  squares.y.fill(0.5f);
  const int x = static_cast<int>(pixel % gbuffer_.width), y = static_cast<int>(pixel / gbuffer_.width);
  for (int ray = 0; ray < places_.ray_count(); ++ray) {
    const glm::vec2 place = places_.place(x, y, frame_, ray);
    squares.x[ray] = place.x;
    squares.y[ray] = place.y;
  }
  return places_on(figure, squares, places_.ray_count());
}

void FrameRays::trace(bool wants_distances, RayPlanes& planes) const {
  const std::size_t size = gbuffer_.size();
  planes.asked.resize(size);
  planes.seen.resize(size);
  planes.faces.resize(size);
  planes.distance.resize(wants_distances ? size : 0);
  planes.dark.resize(wants_distances ? size : 0);
  std::atomic<std::size_t> ray_count = 0;
  for_blocks(size, 256, [&](std::size_t begin, std::size_t end) {
    std::size_t rays = 0;
    for (std::size_t i = begin; i < end; ++i) rays += trace_pixel(i, planes);
    ray_count += rays;
  });
  planes.ray_count = ray_count;
}

std::size_t FrameRays::trace_pixel(std::size_t pixel, RayPlanes& planes) const {
  planes.asked[pixel] = 0;
  planes.seen[pixel] = 0;
  planes.faces[pixel] = 0;
  const bool wants_distances = !planes.dark.empty();
  if (wants_distances) {
    planes.distance[pixel] = 0;
    planes.dark[pixel] = 0;
  }
  const std::optional<LightFigure> figure = this->figure(pixel);
  if (!figure) return 0;
  planes.faces[pixel] = 1;
  const Squares squares = this->squares(*figure, pixel);
  const FaceRays rays(casters_, gbuffer_, pixel, *figure);
  const FaceHits hits = rays.ask(squares, wanted());
  for (std::uint32_t left = hits.asked; left; left &= left - 1) {
    const int k = std::countr_zero(left);
    planes.asked[pixel] += hits.weight[k];
    planes.seen[pixel] += hits.weight[k] * static_cast<float>(hits.seen(k));
  }
  std::size_t traced = static_cast<std::size_t>(std::popcount(hits.asked));
  if (wants_distances) traced += find_distances(rays, squares, hits.blocked | hits.dimmed, pixel, planes);
  return traced;
}

std::size_t FrameRays::find_distances(const FaceRays& rays, const Squares& squares, std::uint32_t dark, std::size_t pixel,
                                      RayPlanes& planes) const {
  if (dark == 0) return 0;
  ShadowPacket packet;
  rays.aim_at(squares, packet);
  std::size_t traced = 0;
  for (std::uint32_t left = dark; left; left &= left - 1) {
    const int k = std::countr_zero(left);
    const glm::dvec3 origin(packet.ox[k], packet.oy[k], packet.oz[k]), way(packet.dx[k], packet.dy[k], packet.dz[k]);
    const RayScene::Hit hit = casters_.closest_caster(origin, way);
    ++traced;
    // A caster at the light's own depth may be missed by one of the two queries, and the receiver itself may be met by
    // rounding: neither is a distance.
    const bool is_own = hit.mesh == gbuffer_.mesh[pixel] && hit.triangle == gbuffer_.triangle[pixel];
    if (hit.mesh == no_mesh || is_own || !(hit.t < 1)) continue;
    planes.distance[pixel] += static_cast<float>(hit.t * glm::length(way));
    planes.dark[pixel] += 1;
  }
  return traced;
}

}  // namespace gnomon::denoised_rays
