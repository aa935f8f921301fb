#pragma once
#include <gnomon/scene.h>

#include <cmath>

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
    glm::dvec3 side = glm::cross(forward, glm::dvec3(view.up));
    // Looking along `up`: any side will do, and the same one every time.
    if (glm::dot(side, side) < 1e-12 * glm::dot(glm::dvec3(view.up), glm::dvec3(view.up)))
      side = glm::cross(forward, std::abs(forward.x) < 0.9 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 0, 1));
    right = glm::normalize(side);
    up = glm::cross(right, forward);
  }

  /// Direction, not normalized (unit along `forward`), through image point (x, y) in pixels; centers are at +0.5.
  glm::dvec3 ray(double x, double y) const {
    const double aspect = static_cast<double>(width) / height;
    return forward + right * (tan_y * aspect * (2 * x / width - 1)) + up * (tan_y * (1 - 2 * y / height));
  }
};

}  // namespace gnomon
