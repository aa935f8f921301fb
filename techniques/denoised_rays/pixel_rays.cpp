#include "pixel_rays.h"

#include <gnomon/kit/bytes.h>
#include <gnomon/kit/parallel.h>

#include <atomic>
#include <bit>

namespace gnomon::denoised_rays {

std::size_t RayPlanes::bytes() const { return bytes_of(asked, seen, distance, dark, faces); }

std::optional<LightFigure> FrameRays::figure(std::size_t pixel) const {
  if (gbuffer_.is_background(pixel) || !casters_.scene().meshes[gbuffer_.mesh[pixel]].receives) return std::nullopt;
  const LightFigure figure(shape_, gbuffer_.position(pixel), gbuffer_.normal(pixel));
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
    Packet packet{.rays = GatheredRays(casters_)};
    for (std::size_t i = begin; i < end; ++i) add(i, packet, planes);
    trace_packet(packet, planes);
    ray_count += packet.traced;
  });
  planes.ray_count = ray_count;
}

void FrameRays::add(std::size_t pixel, Packet& packet, RayPlanes& planes) const {
  planes.asked[pixel] = 0;
  planes.seen[pixel] = 0;
  planes.faces[pixel] = 0;
  if (!planes.dark.empty()) {
    planes.distance[pixel] = 0;
    planes.dark[pixel] = 0;
  }
  const std::optional<LightFigure> figure = this->figure(pixel);
  if (!figure) return;
  planes.faces[pixel] = 1;
  const Squares squares = this->squares(*figure, pixel);
  const FaceAim aim(gbuffer_, pixel, *figure);
  for (int ray = 0; ray < places_.ray_count(); ++ray) {
    packet.pixel[packet.rays.count()] = pixel;
    const bool is_added =
        packet.rays.add(aim, {squares.x[ray], squares.y[ray]}, gbuffer_.mesh[pixel], gbuffer_.triangle[pixel]);
    if (is_added && packet.rays.is_full()) trace_packet(packet, planes);
  }
}

void FrameRays::trace_packet(Packet& packet, RayPlanes& planes) const {
  const FaceHits hits = packet.rays.trace();
  for (int k = 0; k < packet.rays.count(); ++k) {
    const std::size_t pixel = packet.pixel[k];
    planes.asked[pixel] += hits.weight[k];
    planes.seen[pixel] += hits.weight[k] * static_cast<float>(hits.seen(k));
  }
  packet.traced += static_cast<std::size_t>(packet.rays.count());
  if (!planes.dark.empty())
    for (std::uint32_t dark = hits.blocked | hits.dimmed; dark; dark &= dark - 1) {
      add_distance(packet, std::countr_zero(dark), planes);
      ++packet.traced;
    }
  packet.rays.clear();
}

void FrameRays::add_distance(const Packet& packet, int ray, RayPlanes& planes) const {
  const std::size_t pixel = packet.pixel[ray];
  const glm::dvec3 way = packet.rays.way(ray);
  const RayScene::Hit hit = casters_.closest_caster(packet.rays.origin(ray), way);
  // A caster at the light's own depth may be missed by one of the two queries, and the receiver itself may be met by rounding:
  // neither is a distance.
  const bool is_own = hit.mesh == gbuffer_.mesh[pixel] && hit.triangle == gbuffer_.triangle[pixel];
  if (hit.mesh == no_mesh || is_own || !(hit.t < 1)) return;
  planes.distance[pixel] += static_cast<float>(hit.t * glm::length(way));
  planes.dark[pixel] += 1;
}

}  // namespace gnomon::denoised_rays
