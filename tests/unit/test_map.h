#pragma once
// A small shadow map by rays, for tests of what is said about shadow maps: depths at texel centers, nothing shared with the
// technique.
#include <gnomon/kit/rays/rays.h>
#include <gnomon/technique.h>

#include <cmath>
#include <map>

namespace gnomon {

class TestMap {
 public:
  struct Settings {
    double texel = 0.1;        ///< world width of a texel, meters; around a point light at the distance of the origin
    double bias = 0;           ///< meters along the axis
    double slope_bias = 0;     ///< times half the texel's diagonal times the tangent of the slope
    int radius = 0;            ///< of a square filter
    double normal_offset = 0;  ///< texels
    bool receiver_plane = false;
    bool second = false;    ///< stores the second surface, none where there is no second
    bool midpoint = false;  ///< stores what lies half way between both
  };

  TestMap(const Scene& scene, const RayScene& casters, const Light& light, const Settings& settings)
      : casters_(casters), light_(homogeneous(light)), settings_(settings) {
    const Bounds box = scene.bounds();
    const double reach = 4 * (glm::length(glm::dvec3(box.min)) + glm::length(glm::dvec3(box.max)));
    const glm::dvec3 to = glm::normalize(glm::dvec3(light_));
    axis_ = -to;
    origin_ = light_.w != 0 ? glm::dvec3(light_) : reach * to;
    right_ = glm::normalize(glm::cross(axis_, std::abs(axis_.x) < 0.7 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0)));
    down_ = glm::cross(axis_, right_);
    step_ = light_.w != 0 ? settings.texel / glm::length(origin_) : settings.texel;
  }

  Explanation explain(const GBuffer& gbuffer, std::uint32_t i) const { return look_up(gbuffer, i).why; }
  float visibility(const GBuffer& gbuffer, std::uint32_t i) const { return look_up(gbuffer, i).visibility; }

 private:
  struct Answer {
    Explanation why;
    float visibility = 0;
  };

  Answer look_up(const GBuffer& gbuffer, std::uint32_t i) const {
    const glm::dvec3 p = gbuffer.position(i), n = gbuffer.normal(i);
    const auto in_light_space = [&](const glm::dvec3& world) {
      const glm::dvec3 v = world - origin_;
      return glm::dvec3(glm::dot(v, right_), glm::dot(v, down_), glm::dot(v, axis_));
    };
    glm::dvec3 q = in_light_space(p);
    const bool is_point = light_.w != 0;
    const double width = is_point ? step_ * q.z : step_, before = q.z;
    const glm::dvec3 ray = is_point ? (p - origin_) / q.z : axis_;
    const double sine = glm::length(glm::cross(n, ray)), facing = -glm::dot(n, ray);
    double bias = settings_.bias + settings_.slope_bias * width * std::sqrt(0.5) * sine / (facing * glm::length(ray));
    Answer answer;
    if (settings_.normal_offset > 0) {
      const glm::dvec3 moved = p + settings_.normal_offset * width * n;
      q = in_light_space(moved);
      answer.why.shifted = moved;
    }
    answer.why.texel_width = width;
    // The moved point is nearer to the light; along the ray, its plane is by more.
    const double nearer = settings_.receiver_plane ? settings_.normal_offset * width / facing : before - q.z;
    answer.why.bias = (bias + nearer) * glm::length(ray);
    const glm::dvec2 window = glm::dvec2(q) / (is_point ? q.z : 1) / step_;
    const int r = settings_.radius;
    for (int y = -r; y <= r; ++y)
      for (int x = -r; x <= r; ++x) {
        const glm::dvec2 center = (glm::floor(window) + glm::dvec2(x, y) + 0.5) * step_;
        Tap tap{.origin = origin_, .direction = axis_, .weight = 1.0 / ((2 * r + 1) * (2 * r + 1))};
        if (is_point)
          tap.direction = glm::normalize(axis_ + right_ * center.x + down_ * center.y);
        else
          tap.origin += right_ * center.x + down_ * center.y;
        tap.stored = stored(tap);
        const double along = glm::dot(tap.direction, axis_);
        double expected = q.z;
        // Where the tap's ray meets the receiver's plane, through the look-up point.
        if (settings_.receiver_plane) {
          const glm::dvec3 through = answer.why.shifted.value_or(p);
          const double sinks = glm::dot(n, tap.direction);
          expected = sinks < 0 ? glm::dot(n, through - tap.origin) / sinks * along : INFINITY;
        }
        if (!(tap.stored * along < expected - bias)) answer.visibility += static_cast<float>(tap.weight);
        answer.why.taps.push_back(tap);
      }
    return answer;
  }

  double stored(const Tap& tap) const {
    const RayScene::Hit first = casters_.closest(tap.origin, tap.direction);
    if ((!settings_.second && !settings_.midpoint) || first.mesh == no_mesh) return first.t;
    const double step = first.t + 1e-3, second = step + casters_.closest(tap.origin + step * tap.direction, tap.direction).t;
    return settings_.midpoint ? (first.t + second) / 2 : second;
  }

  const RayScene& casters_;
  glm::dvec4 light_;
  Settings settings_;
  glm::dvec3 origin_, axis_, right_, down_;
  double step_;
};

}  // namespace gnomon
