#pragma once
#include <gnomon/error.h>
#include <gnomon/kit/geometry/camera.h>
#include <gnomon/scene.h>

#include <optional>

#include "measure/scene/load.h"

namespace gnomon::viewer {

// How camera and light move. Pure: a view or light in, a new one out. Pixels are of the picture, x to the right, y down.
//
// What comes out is as valid as what went in, whatever the numbers: a move that cannot be made is made as far as it can be, or
// not at all. Everything is computed in double and rounded once. A view that is moved by many small steps is rounded many
// times, each time by half a unit in the last place of a coordinate; so a drag had better move the view that it found by all
// its pixels so far (Gesture::moved) than the last view by the last pixels, which may be too few to reach the next float at
// all.

/// Whether `check` accepts the view or light.
template <class Item>
bool is_valid(const Item& item) {
  try {
    check(item, "");
    return true;
  } catch (const Error&) {
    return false;
  }
}

/// Turns the eye about the target, at the same distance: a drag over the whole height of the picture is half a turn. The scene
/// follows the mouse: dragged to the right, the eye goes left; down, up. Ends half a degree short of the poles of `up`.
View orbit(const View& view, glm::dvec2 pixels, int height);
/// The same in radians that the eye goes to the right and up.
View orbit_by(const View& view, glm::dvec2 angles);
/// Moves eye and target in the image plane: what lies at the target's distance follows the mouse. The offset from
/// eye to target stays to the bit as far as float32 holds it at both places.
View pan(const View& view, glm::dvec2 pixels, int height);
/// Moves the eye toward the target (steps > 0) by a tenth of the way each, never through it; steps back undo it. Ends where
/// float32 would no longer hold the line of sight.
View zoom(const View& view, double steps);
/// Turns the target about the eye, at the same distance: what is seen in the middle of the picture follows the mouse. Ends half
/// a degree short of the poles of `up`.
View look(const View& view, glm::dvec2 pixels, int height);
/// Moves eye and target by `steps` of `step` meters: to the right, along the view's `up`, forward.
View fly(const View& view, glm::dvec3 steps, double step);

/// The position or center of a light; null of a directional one.
glm::vec3* position_of(Light& light);
/// Where the handle of the light is: its position, or center. That of a directional light is on an ellipsoid just around the
/// scene's bounds, on the side that the light comes from.
glm::dvec3 light_place(const Scene& scene, const Light& light);
/// The light with its handle moved to `place`. A spot keeps its direction; a directional light travels from there to the middle
/// of the scene's bounds. The very same light where that is none (at the middle, not finite).
Light light_moved_to(const Scene& scene, const Light& light, const glm::dvec3& place);
/// The place on the pixel's ray that a handle at `place` is dragged to: in the plane through it across the camera's axis; with
/// `is_vertical`, where the vertical line through it comes nearest to the ray. Nothing where they do not meet before the eye.
std::optional<glm::dvec3> drag_place(const Camera& camera, const glm::dvec3& place, glm::dvec2 pixel, bool is_vertical);
/// The light with its handle dragged to the pixel: `drag_place`; but the handle of a directional light keeps to its ellipsoid,
/// and to that side of it, near or far, on which it is, so that it stays under the mouse, or as near to it as it can be.
Light drag_light(const Scene& scene, const Light& light, const Camera& camera, glm::dvec2 pixel, bool is_vertical);

/// Where the camera shows a point, in pixels: `Camera::ray` backwards. Nothing for points that are not before the eye.
std::optional<glm::dvec2> project(const Camera& camera, const glm::dvec3& point);

/// The handle of a light at `place`, in pixels. Lights are often beside the picture: then it is shown at the border, `margin`
/// inside, on the way from the middle to where it is. A drag that moves it by some pixels takes the light from `at` to as many
/// pixels from there, so that it can be fetched. Nothing for places that are not before the eye.
struct Handle {
  glm::dvec2 at, shown;
};
std::optional<Handle> light_handle(const Camera& camera, const glm::dvec3& place, double margin);

/// One step of the keys, in meters: a fiftieth of the diagonal of the scene's bounds.
double key_step(const Scene& scene);

}  // namespace gnomon::viewer
