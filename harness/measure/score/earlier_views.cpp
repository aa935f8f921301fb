#include "measure/score/earlier_views.h"

#include <cassert>

namespace gnomon {

void EarlierViews::add(const Evidence& now) {
  assert(now.gbuffer && kept_ > 0);
  const GBuffer& g = *now.gbuffer;
  const Camera camera(g.view, g.width, g.height);
  if (frames_.size() < kept_) frames_.push_back({camera, std::vector<PixelSeen>(g.size())});
  FrameSeen& seen = frames_[added_++ % kept_];
  assert(seen.shown.size() == g.size());
  seen.camera = camera;
  for (std::size_t i = 0; i < g.size(); ++i) {
    const bool is_tested = now.classes[i] == PixelClass::T;
    const double depth = glm::dot(glm::dvec3(g.position(i)) - camera.eye, camera.forward);
    seen.shown[i] = {is_tested ? g.mesh[i] : no_mesh, g.triangle[i], static_cast<float>(depth)};
  }
}

std::optional<std::size_t> EarlierViews::pixel_of(const Evidence& now, std::size_t i, std::size_t lag) const {
  assert(lag < kept_ && lag < added_);
  const GBuffer& g = *now.gbuffer;
  if (now.classes[i] != PixelClass::T || g.is_background(i)) return std::nullopt;
  const FrameSeen& seen = frames_[(added_ - 1 - lag) % kept_];
  const Camera& camera = seen.camera;
  const glm::dvec3 point = g.position(i), normal = g.normal(i), from_eye = point - camera.eye;
  const double depth = glm::dot(from_eye, camera.forward);
  if (depth <= 0 || glm::dot(normal, from_eye) >= 0) return std::nullopt;
  // The inverse of Camera::ray. Pixels are square: half a height of the picture is tan_y at depth 1.
  const double pixels = camera.height / (2 * camera.tan_y * depth);  // of a meter at the point
  const double x = camera.width / 2.0 + pixels * glm::dot(from_eye, camera.right);
  const double y = camera.height / 2.0 - pixels * glm::dot(from_eye, camera.up);
  if (!(x >= 0 && x < camera.width && y >= 0 && y < camera.height)) return std::nullopt;
  const auto column = static_cast<std::size_t>(x), row = static_cast<std::size_t>(y);
  const std::size_t q = row * static_cast<std::size_t>(camera.width) + column;
  const PixelSeen& shown = seen.shown[q];
  if (shown.mesh != g.mesh[i] || shown.triangle != g.triangle[i]) return std::nullopt;
  const glm::dvec3 ray = camera.ray(static_cast<double>(column) + 0.5, static_cast<double>(row) + 0.5);
  const glm::dvec3 there = camera.eye + ray * static_cast<double>(shown.depth);
  if (pixels * std::abs(glm::dot(normal, there - point)) > 1) return std::nullopt;
  return q;
}

}  // namespace gnomon
