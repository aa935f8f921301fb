#include "picture.h"

#include <gnomon/kit/parallel.h>

#include <algorithm>
#include <cmath>

namespace gnomon::contact_march {

namespace {

/// x and y are -z .. z in the picture, z is along the axis of the view.
glm::dvec3 turned(const Camera& camera, const glm::dvec3& v) {
  const double tan_x = camera.tan_y * camera.width / camera.height;
  return {glm::dot(v, camera.right) / tan_x, glm::dot(v, camera.up) / camera.tan_y, glm::dot(v, camera.forward)};
}

glm::dvec2 place_of(const Camera& camera, const glm::dvec3& p) {
  return {(1 + p.x / p.z) / 2 * camera.width, (1 - p.y / p.z) / 2 * camera.height};
}

/// What part of the segment from `from` by `way` is in the picture, 0 .. 1, where its start is. A segment toward the eye stays
/// in one pixel up to the eye itself, where it has no place: it ends at a 1024th of its first z.
double part_in_picture(const glm::dvec3& from, const glm::dvec3& way) {
  double part = 1;
  const auto cut = [&](double inside, double change) {
    if (inside + part * change < 0) part = std::max(0.0, -inside / change);
  };
  cut(from.z + from.x, way.z + way.x);
  cut(from.z - from.x, way.z - way.x);
  cut(from.z + from.y, way.z + way.y);
  cut(from.z - from.y, way.z - way.y);
  cut(from.z - from.z / 1024, way.z);
  return part;
}

}  // namespace

Way way_over(const Camera& camera, const glm::dvec3& point, const glm::dvec3& direction, double length, int most_steps) {
  const glm::dvec3 from = turned(camera, point - camera.eye), whole = length * turned(camera, direction);
  Way way;
  if (!(from.z > 0)) return way;
  const double part = part_in_picture(from, whole);
  const glm::dvec3 to = from + part * whole;
  way.start = place_of(camera, from);
  way.inverse = 1 / from.z;
  way.leaves = part < 1;
  const glm::dvec2 across = place_of(camera, to) - way.start;
  const double larger = std::max(std::abs(across.x), std::abs(across.y));
  if (!(larger > 0)) return way;
  way.count = larger < most_steps ? static_cast<int>(std::ceil(larger)) : most_steps;
  way.step = across / static_cast<double>(way.count);
  way.by_step = (1 / to.z - way.inverse) / way.count;
  return way;
}

// The plane N (E + z d) = N A through the pixel's point A has 1 / z = N d / c with c = N (A - E), where d, the way of the view
// ray with 1 along the axis, is linear over the picture. Float32 may move the plane by 16 * 2^-24 of the largest coordinate
// along N, which is that part of c, the distance of the eye from the plane.
Picture::Plane Picture::plane_of(std::size_t i) const {
  const GBuffer& g = *gbuffer_;
  if (g.is_background(i)) return {};
  const Camera& camera = *camera_;
  const glm::dvec3 point = g.position(i), n = g.normal(i);
  const double c = glm::dot(n, point - camera.eye), depth = z(point);
  const double moved = 16 * 0x1p-24 * std::max(extent(point), extent(camera.eye));
  if (!(depth > 0) || !(std::abs(c) > moved)) return {};
  const double tan_x = camera.tan_y * camera.width / camera.height;
  Plane plane;
  plane.inverse = static_cast<float>((1 - moved / std::abs(c)) / depth);
  plane.by_x = static_cast<float>(2 * tan_x / camera.width * glm::dot(n, camera.right) / c);
  plane.by_y = static_cast<float>(-2 * camera.tan_y / camera.height * glm::dot(n, camera.up) / c);
  plane.body = numbers_->numbered(receiver_at(*scene_, g, i)).first_own;
  return plane;
}

void Picture::take(const Scene& scene, const TriangleNumbers& numbers, const GBuffer& gbuffer) {
  scene_ = &scene;
  numbers_ = &numbers;
  gbuffer_ = &gbuffer;
  camera_.emplace(gbuffer.view, gbuffer.width, gbuffer.height);
  planes_.resize(gbuffer.size());
  for_blocks(planes_.size(), 4096, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const bool casts = !gbuffer.is_background(i) && scene.meshes[gbuffer.mesh[i]].casts;
      planes_[i] = casts ? plane_of(i) : Plane{};
    }
  });
}

March Picture::march(std::size_t i, const glm::dvec4& light, const MarchSetting& setting) const {
  const glm::dvec3 point = gbuffer_->position(i), to = to_light(light, point);
  const double distance = glm::length(to);
  const bool arrives = light.w != 0 && distance <= setting.length;
  const Way way = way_over(*camera_, point, to / distance, arrives ? distance : setting.length, setting.most_steps);
  const std::uint32_t own = numbers_->numbered(receiver_at(*scene_, *gbuffer_, i)).first_own;
  const int last_x = camera_->width - 1, last_y = camera_->height - 1;
  for (int k = 1; k <= way.count; ++k) {
    const glm::dvec2 place = way.place(k);
    const int x = std::clamp(static_cast<int>(place.x), 0, last_x), y = std::clamp(static_cast<int>(place.y), 0, last_y);
    const Plane& plane =
        planes_[static_cast<std::size_t>(y) * static_cast<std::size_t>(camera_->width) + static_cast<std::size_t>(x)];
    if (plane.inverse <= 0 || plane.body == own) continue;
    const double inverse = plane.at(place, x, y);
    if (inverse <= 0) continue;  // there the plane is behind the eye
    const double z_pixel = 1 / inverse, behind = way.z(k) - z_pixel;
    // Half a step times the plane's slope: dz is -z^2 times the change of 1 / z.
    const double bias = std::abs(way.step.x * plane.by_x + way.step.y * plane.by_y) / 2 * z_pixel * z_pixel;
    if (behind > bias && behind < setting.thickness) return {k, End::surface};
  }
  return {way.count, way.leaves ? End::picture : arrives ? End::light : End::length};
}

std::optional<std::size_t> Picture::pixel_of(const glm::dvec3& point) const {
  const glm::dvec3 p = turned(*camera_, point - camera_->eye);
  if (!(p.z > 0) || std::abs(p.x) >= p.z || std::abs(p.y) >= p.z) return std::nullopt;
  const glm::dvec2 place = place_of(*camera_, p);
  const int x = std::min(static_cast<int>(place.x), camera_->width - 1);
  const int y = std::min(static_cast<int>(place.y), camera_->height - 1);
  return static_cast<std::size_t>(y) * static_cast<std::size_t>(camera_->width) + static_cast<std::size_t>(x);
}

std::optional<double> Picture::shown_before(const glm::dvec3& point) const {
  const std::optional<std::size_t> i = pixel_of(point);
  if (!i) return std::nullopt;
  const Plane plane = plane_of(*i);  // of what does not cast, too
  const int width = camera_->width;
  const double inverse = plane.at(place_of(*camera_, turned(*camera_, point - camera_->eye)), static_cast<int>(*i) % width,
                                  static_cast<int>(*i) / width);
  return plane.inverse > 0 && inverse > 0 ? 1 / inverse : INFINITY;
}

}  // namespace gnomon::contact_march
