#pragma once
#include <gnomon/kit/geometry/across.h>
#include <gnomon/scene.h>

namespace gnomon {

/// The pinhole camera of a view in double: orthonormal frame and the ray through any image point.
struct Camera {
  glm::dvec3 eye, forward, right, up;
  double tan_y;  ///< tangent of half the vertical field of view
  int width, height;

  Camera(const View& view, int image_width, int image_height)
      : eye(view.eye),
        tan_y(std::tan(glm::radians(static_cast<double>(view.fov_y_degrees)) / 2)),
        width(image_width),
        height(image_height) {
    forward = glm::normalize(glm::dvec3(view.target) - eye);
    right = glm::normalize(sideways(forward, view.up));
    up = glm::cross(right, forward);
  }

  /// Direction, not normalized (unit along `forward`), through image point (x, y) in pixels; centers are at +0.5.
  glm::dvec3 ray(double x, double y) const {
    const double aspect = static_cast<double>(width) / height;
    return forward + right * (tan_y * aspect * (2 * x / width - 1)) + up * (tan_y * (1 - 2 * y / height));
  }
};

}  // namespace gnomon
