// Warped shadow map: one depth image, seen in perspective, so that its texels are small where the eye is near.
//
// Both warps are one map of the light's window, a perspective along the view as the light sees it, and differ in how far its
// center is: the one of Wimmer et al. balances the error of perspective over the range of depths, that of Martin and Tan gives
// what is in focus 80 % of the image. The window itself is fitted to what the picture shows, as that of shadow_map:fit=view: so
// each resolve fits and draws, and warp=none is what the fit alone buys.
//
// Defaults: the setting with the lowest mean wrong rate in suite map_defaults (results/map_defaults).
//
// Depths are stored over the warp's divisor, which planes keep: rasterizing stays exact, and look-ups multiply it back.
#include <gnomon/kit/compared_map.h>
#include <gnomon/kit/parallel.h>
#include <gnomon/registry.h>

#include <cmath>
#include <mutex>

#include "warped_map/warp.h"

namespace {
using namespace gnomon;

constexpr About about{
    .title = "Warped shadow map",
    .summary = "One depth image in perspective, with small texels where the eye is near.",
    .source = "Wimmer, Scherzer and Purgathofer 2004 (light_space_perspective); Martin and Tan 2004 (trapezoidal)",
    .error =
        "As a shadow map's, with texels that grow with the distance from the eye. Across the view they grow as the picture's "
        "pixels do, along it as their square: what is far gets long texels.",
    .fails =
        "A light that shines along the view, where no direction of the image is that of depth: it is not warped then. "
        "Casters high above what the eye sees close by.",
    .needs_gl = true};

constexpr int row_count = 256;  // of what the window shows: its hull is known to a row

/// What of the light's window a picture shows, and how deep it is.
struct Seen {
  LightExtent extent{};
  double near = INFINITY, far = -INFINITY;  // depth from the eye, meters
  void add(const Seen& other) {
    extent.add(other.extent);
    near = std::min(near, other.near);
    far = std::max(far, other.far);
  }
};

class WarpedMap final : public ComparedMap {
  Choice warp{this,
              "warp",
              "light_space_perspective",
              {"light_space_perspective", "trapezoidal", "none"},
              Stage::resolve,
              "Where the center of the image's perspective lies."};
  Number<double> focus{this,
                       "focus",
                       0.5,
                       {.unit = "", .min = 0.01, .max = 0.8},
                       Stage::resolve,
                       "Share of what is seen, along the view, that gets 80 % of the image; for warp=trapezoidal."};

 public:
  WarpedMap() : ComparedMap({.bias = "receiver_plane", .depth_bias = 2, .slope_bias = 1}) {}
  std::unique_ptr<Technique> for_another_light() const override { return another(*this, &WarpedMap::made_); }

 private:
  std::optional<LightCamera> fitted_to_scene(const Light&, const MeshBoxes&, int) const override { return std::nullopt; }
  LightCamera fitted_to_view(const Light& light, const MeshBoxes& boxes, const GBuffer& gbuffer, int margin) const override;
  LightImages images() const override { return LightImages::warped; }
  double distance(const LightImage& image, const Seen& seen, double sine, double length) const;
};

/// Calls add(found, point) for all points, with a `found` of its own on each thread, and joins them.
template <class Found, class Add>
Found over(std::span<const glm::dvec3> points, const Found& none, Add add) {
  Found all = none;
  std::mutex mutex;
  for_blocks(points.size(), 8192, [&](std::size_t begin, std::size_t end) {
    Found found = none;
    for (const glm::dvec3& point : points.subspan(begin, end - begin)) add(found, point);
    const std::scoped_lock lock(mutex);
    all.add(found);
  });
  return all;
}

/// The face turned about its axis until depth of the eye runs along its y, as far as it shows; how fast it does there, per
/// meter of depth, is that of window coordinates.
double turn_along_view(LightSpaceFace& face, const glm::dvec3& seen_from, const glm::dvec3& axis) {
  const glm::dvec3 q = face.seen(seen_from), way = face.turned(axis);
  const glm::dvec2 along = face.is_perspective ? (glm::dvec2(way) - glm::dvec2(q) / q.z * way.z) / q.z : glm::dvec2(way);
  const double speed = glm::length(along);
  if (speed < 1e-6) return 0;
  const glm::dvec2 y = along / speed;
  const glm::dvec3 right = face.axis(0), down = face.axis(1);
  face.light_from_world = frame_of(y.y * right - y.x * down, y.x * right + y.y * down, face.axis(2));
  face.is_along_world = false;
  return speed;
}

double WarpedMap::distance(const LightImage& image, const Seen& seen, double sine, double length) const {
  if (warp.is("none") || sine == 0 || !(seen.near < seen.far) || seen.near <= 0) return INFINITY;
  if (warp.is("trapezoidal")) return warped_map::trapezoidal_distance(length, focus * length);
  const double meters = warped_map::light_space_perspective_distance(seen.near, seen.far, sine);
  // Tangents are no meters: the distance is to the window's length as it would be among parallel rays.
  return image.is_perspective ? meters * length / ((seen.far - seen.near) * sine) : meters;
}

LightCamera WarpedMap::fitted_to_view(const Light& light, const MeshBoxes& boxes, const GBuffer& gbuffer, int margin) const {
  const glm::dvec3 eye = gbuffer.view.eye, axis = glm::normalize(glm::dvec3(gbuffer.view.target) - eye);
  const std::vector<glm::dvec3> points = points_facing(light, boxes, gbuffer);
  LightSpaceFace face = light_space_of(light, boxes).main();
  const auto add = [&](Seen& found, const glm::dvec3& point) {
    const glm::dvec3 q = face.seen(point);
    const double depth = glm::dot(axis, point - eye);
    found.add({{face.place(q), face.place(q), q.z, q.z}, depth, depth});
  };
  // The view's way through the window is that in the middle of what is seen.
  const Seen before = over(points, Seen{}, add);
  const glm::dvec2 middle = (before.extent.low + before.extent.high) / 2.0;
  const double z = (before.extent.near + before.extent.far) / 2;
  double sine = 0;
  if (!before.extent.empty()) {
    turn_along_view(face, face.to_world(glm::dvec3(face.is_perspective ? middle * z : middle, z)), axis);
    const glm::dvec3 to_light = face.is_perspective ? glm::normalize(face.to_world({0, 0, z}) - face.origin) : face.axis(2);
    sine = glm::length(glm::cross(to_light, axis));
  }
  const Seen seen = over(points, Seen{}, add);
  LightCamera camera = fit_to_extents(light, LightSpace(face), boxes, {&seen.extent, 1}, image_resolution(), margin);
  LightImage& image = camera.images[0];
  if (image.layer < 0) return camera;
  const glm::dvec2 low = image.window_of(glm::dvec2(margin)), high = image.window_of(glm::dvec2(image_resolution() - margin));
  const auto rows =
      over(points, warped_map::Rows(low.y, high.y, row_count), [&](warped_map::Rows& found, const glm::dvec3& point) {
        const glm::dvec2 window = face.place_of(point);
        const glm::dvec2 inside = glm::clamp(window, low, high);
        if (window == inside) found.add(window);
      });
  if (const auto corners = rows.corners(); !corners.empty() && (high.y > low.y))
    warped_map::warp(image, corners, distance(image, seen, sine, high.y - low.y), image_resolution(), margin);
  return camera;
}

}  // namespace

GNOMON_TECHNIQUE(warped_map, WarpedMap, about)
