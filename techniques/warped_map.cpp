// Warped shadow map: one depth image, seen in perspective, so that its texels are small where the eye is near.
//
// Both warps are one map of the light's window, a perspective along the view as the light sees it, and differ in how far its
// center is: the one of Wimmer et al. balances the error of perspective over the range of depths, that of Martin and Tan gives
// what is in focus 80 % of the image. The window itself is fitted to what the picture shows, as that of shadow_map:fit=view: so
// each resolve fits and draws, and warp=none is what the fit alone buys.
//
// Defaults: of each warp the setting within 1 % of its lowest mean wrong rate in suite map_defaults (results/map_defaults).
//
// Depths are stored over the warp's divisor, which planes keep: rasterizing stays exact, and look-ups multiply it back.
#include <gnomon/kit/maps/compared_map.h>
#include <gnomon/kit/parallel.h>
#include <gnomon/registry.h>

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
        "pixels do, along it as their square: what is far gets long texels. "
        "Holes are those of the mask with alpha=texel alone: mips and mips_kept filter alpha, and hashed is random "
        "where alpha is neither 0 nor 1. A texel holds no product: glass is taken for opaque or left out.",
    .fails =
        "A light that shines along the view, where no direction of the image is that of depth: it is not warped then. "
        "Casters high above what the eye sees close by.",
    .device = Device::opengl,
    .floor = Floor::depth_draw,
    .handles = with_gray_transmission,
    .causes = map_causes};

constexpr int row_count = 256;  // of what the window shows: its hull is exact to a row

/// The points of the view in an image's window.
struct WindowPoints {
  warped_map::Rows rows;
  warped_map::Span depths{};  ///< from the eye, meters
  void add(const WindowPoints& other) {
    rows.add(other.rows);
    depths.add(other.depths);
  }
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

/// Turns a face about its axis until depth of the eye runs along its y, at a point. Whether it does: not where the light shines
/// along the view.
bool turn_along_view(LightSpaceFace& face, const glm::dvec3& point, const glm::dvec3& axis) {
  const glm::dvec3 q = face.seen(point), way = face.turned(axis);
  // The window's change per meter of depth, times q.z where that is a tangent.
  const glm::dvec2 along = face.is_perspective ? glm::dvec2(way) - glm::dvec2(q) / q.z * way.z : glm::dvec2(way);
  const double speed = glm::length(along);
  if (!(speed > 1e-6)) return false;
  const glm::dvec2 y = along / speed;
  const glm::dvec3 right = face.axis(0), down = face.axis(1);
  face.light_from_world = frame_of(y.y * right - y.x * down, y.x * right + y.y * down, face.axis(2));
  face.is_along_world = false;
  return true;
}

class WarpedMap final : public ComparedMap {
  Choice warp = Choice(this, "warp", "light_space_perspective", {"light_space_perspective", "trapezoidal", "none"},
                       Stage::resolve, "Where the center of the image's perspective lies.");
  Number<double> focus =
      Number<double>(this, "focus", 0.5, {.min = 0.01, .max = 0.8}, Stage::resolve,
                     "Share of what is seen, along the view, that gets 80 % of the image; for warp=trapezoidal.");

 public:
  WarpedMap() : ComparedMap({.bias = "receiver_plane", .depth_bias = 2, .slope_bias = 1}) {}
  std::unique_ptr<Technique> for_another_light() const override { return another(*this, &WarpedMap::made_); }

 private:
  std::optional<LightCamera> fitted_to_scene(const Light&, const MeshBoxes&, int) const override { return std::nullopt; }
  LightCamera fitted_to_view(const Light& light, const MeshBoxes& boxes, const GBuffer& gbuffer, int margin) const override {
    const glm::dvec3 eye = gbuffer.view.eye, axis = glm::normalize(glm::dvec3(gbuffer.view.target) - eye);
    const std::vector<glm::dvec3> points = points_facing(light, boxes, gbuffer);
    LightSpaceFace face = light_space_of(light, boxes).main();
    const auto add = [&](LightExtent& found, const glm::dvec3& point) {
      const glm::dvec3 q = face.seen(point);
      found.add(face.place(q), q.z);
    };
    // The view's way through the window is that in the middle of what is seen.
    const LightExtent before = over(points, LightExtent{}, add);
    double sine = 0;
    if (!before.empty()) {
      const double z = (before.near + before.far) / 2;
      const glm::dvec2 window = (before.low + before.high) / 2.0;
      const glm::dvec3 middle = face.to_world(glm::dvec3(face.is_perspective ? window * z : window, z));
      const glm::dvec3 from_light = face.is_perspective ? glm::normalize(middle - face.origin) : face.axis(2);
      if (turn_along_view(face, middle, axis)) sine = glm::length(glm::cross(from_light, axis));
    }
    const LightExtent seen = over(points, LightExtent{}, add);
    LightCamera camera = fit_to_extents(light, LightSpace(face), boxes, {&seen, 1}, image_resolution(), margin);
    LightImage& image = camera.images[0];
    if (image.layer < 0) return camera;
    // Of the points those where something may cast: in the window, which rounding must not take the outermost out of.
    const glm::dvec2 low = image.window_of(glm::dvec2(margin)), high = image.window_of(glm::dvec2(image_resolution() - margin));
    const glm::dvec2 slack = 0.5 / image.scale;
    const WindowPoints points_in = over(
        points, WindowPoints{warped_map::Rows(low.y, high.y, row_count)}, [&](WindowPoints& found, const glm::dvec3& point) {
          const glm::dvec2 window = face.place_of(point), inside = glm::clamp(window, low, high);
          if (glm::any(glm::greaterThan(glm::abs(window - inside), slack))) return;
          found.rows.add(inside);
          found.depths.add(glm::dot(axis, point - eye));
        });
    const double length = high.y - low.y;
    if (const auto corners = points_in.rows.corners(); !corners.empty() && length > 0)
      warped_map::warp(image, corners, distance(image, points_in.depths, sine, length), image_resolution(), margin);
    return camera;
  }
  LightImages images() const override { return LightImages::warped; }
  /// Of the center of the warp, in window coordinates; infinity for none. `sine` is that of the angle between light and view,
  /// `length` that of the window along the view.
  double distance(const LightImage& image, const warped_map::Span& depths, double sine, double length) const {
    const double depth = depths.length() * sine;  // of what is shown, along the window if it were in meters
    if (warp.is("none") || !(depth > 0) || depths.low <= 0) return INFINITY;
    // Where depth is less than the window's length, so is the perspective that it needs.
    if (warp.is("trapezoidal")) {
      const double share = image.is_perspective ? 1 : std::min(1.0, depth / length);
      return warped_map::trapezoidal_distance(length, focus * length) / share;
    }
    const double meters = warped_map::light_space_perspective_distance(depths.low, depths.high, sine);
    return image.is_perspective ? meters * length / depth : meters;
  }
};

}  // namespace

GNOMON_TECHNIQUE(warped_map, WarpedMap, about)
