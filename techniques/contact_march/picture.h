#pragma once
#include <gnomon/kit/bytes.h>
#include <gnomon/kit/geometry/camera.h>
#include <gnomon/kit/geometry/receiver.h>

#include <optional>
#include <string_view>
#include <vector>

namespace gnomon::contact_march {

/// A part of a ray over the picture, in equal steps of pixels. Along pixels 1 / z is linear, z is not; z is the distance from
/// the eye along the axis of the view, meters.
struct Way {
  glm::dvec2 start{0}, step{0};     ///< pixels
  double inverse = 0, by_step = 0;  ///< 1 / z at the start, and what a step adds
  int count = 0;                    ///< of steps; 0 where the ray stays in its pixel's center
  bool leaves = false;              ///< the picture, before it ends
  glm::dvec2 place(double k) const { return start + k * step; }
  double z(double k) const { return 1 / (inverse + k * by_step); }
};

/// The ray from `point` along the unit `direction`, `length` meters, as far as the picture shows it: one step for each pixel of
/// its larger side, rounded up, but `most_steps` at most.
Way way_over(const Camera& camera, const glm::dvec3& point, const glm::dvec3& direction, double length, int most_steps);

/// What ended a march.
enum class End {
  surface,  ///< it is behind a surface of the picture: the pixel is dark
  length,   ///< it was followed for its length
  light,    ///< it arrived at the light
  picture,  ///< it left the picture
};
inline constexpr std::string_view end_names[] = {"surface", "length", "light", "picture"};

struct March {
  int steps = 0;
  End end = End::length;
  bool is_dark() const { return end == End::surface; }
};

/// How a march goes.
struct MarchSetting {
  double length = 0;     ///< meters
  double thickness = 0;  ///< meters along the axis of the view
  int most_steps = 1;
};

/// The planes that a G-buffer shows, and marches through them.
class Picture {
 public:
  /// `numbers` of the scene's triangles. Both outlive the marches.
  void take(const Scene& scene, const TriangleNumbers& numbers, const GBuffer& gbuffer);
  /// From pixel i's point toward a homogeneous light.
  March march(std::size_t i, const glm::dvec4& light, const MarchSetting& setting) const;

  /// How far from the eye, along the axis of the view, the pixel at a point's place in the picture shows a surface; infinity
  /// where it shows none. Nothing out of the picture.
  std::optional<double> shown_before(const glm::dvec3& point) const;
  /// The pixel at a point's place in the picture; nothing out of it.
  std::optional<std::size_t> pixel_of(const glm::dvec3& point) const;
  /// z of a point.
  double z(const glm::dvec3& point) const { return glm::dot(point - camera_->eye, camera_->forward); }
  std::size_t bytes() const { return bytes_of(planes_); }

 private:
  /// 1 / z of the plane through a pixel's point, moved back by what rounding to float32 may put it forward.
  struct Plane {
    float inverse = 0;         ///< at the pixel's center; 0: no surface
    float by_x = 0, by_y = 0;  ///< what a pixel to the right, or down, adds
    std::uint32_t body = 0;    ///< number of the triangle; of an exact curved shape that of its first one
    /// At a place of the picture in pixel (x, y).
    double at(const glm::dvec2& place, int x, int y) const {
      return inverse + by_x * (place.x - x - 0.5) + by_y * (place.y - y - 0.5);
    }
  };
  Plane plane_of(std::size_t i) const;

  const GBuffer* gbuffer_ = nullptr;
  const Scene* scene_ = nullptr;
  const TriangleNumbers* numbers_ = nullptr;
  std::optional<Camera> camera_;
  std::vector<Plane> planes_;  // of what casts
};

}  // namespace gnomon::contact_march
