#include "lamps.h"

#include <gnomon/kit/area/light_shape.h>
#include <gnomon/kit/geometry/across.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace gnomon::radiosity {

namespace {

constexpr int most_parts = 8;

int parts(double length, double size, int least) {
  return static_cast<int>(std::clamp(std::ceil(length / size - 1e-6), double(least), double(most_parts)));
}

/// The cells of a grid over the square -1 .. 1, as polygons: place(p) is the point for a place of the square, and the front is
/// on the side of front(center).
template <class Place, class Front>
void add_grid(const glm::ivec2& count, const Place& place, const Front& front, std::vector<Sender>& senders) {
  for (int j = 0; j < count.y; ++j)
    for (int i = 0; i < count.x; ++i) {
      const auto corner = [&](int x, int y) { return place(2.0 * glm::dvec2(i + x, j + y) / glm::dvec2(count) - 1.0); };
      const std::array corners{corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)};
      senders.push_back(make_sender(corners, front((corners[0] + corners[2]) / 2.0)));
    }
}

/// Moves all away from a center so that together they have this area.
void scale_to(double area, const glm::dvec3& center, std::vector<Sender>& senders) {
  double sum = 0;
  for (const Sender& sender : senders) sum += sender.area;
  const double factor = std::sqrt(area / sum);
  for (Sender& sender : senders) {
    for (glm::dvec3& corner : sender.corners) corner = center + factor * (corner - center);
    sender.area *= factor * factor;
  }
}

/// The square -1 .. 1 onto the unit disc, squares around its middle onto circles.
glm::dvec2 concentric(const glm::dvec2& p) {
  if (p.x == 0 && p.y == 0) return p;
  const bool is_wide = std::abs(p.x) > std::abs(p.y);
  const double radius = is_wide ? p.x : p.y;
  const double angle = is_wide ? std::numbers::pi / 4 * (p.y / p.x) : std::numbers::pi / 2 - std::numbers::pi / 4 * (p.x / p.y);
  return radius * glm::dvec2(std::cos(angle), std::sin(angle));
}

/// The parts that emit on the side of a flat light's front, or all around a sphere.
std::vector<Sender> front_of(const LightShape& light, double size) {
  const glm::dvec3& center = light.center;
  const double radius = light.radius;
  std::vector<Sender> senders;
  if (light.form == LightShape::Form::rectangle) {
    const glm::ivec2 count(parts(2 * glm::length(light.half_u), size, 1), parts(2 * glm::length(light.half_v), size, 1));
    const auto at = [&](const glm::dvec2& p) { return center + p.x * light.half_u + p.y * light.half_v; };
    add_grid(
        count, at, [&](const glm::dvec3&) { return light.across; }, senders);
  } else if (light.form == LightShape::Form::disc) {
    const glm::dvec3 normal = light.front();
    const Across across(normal);
    const auto at = [&](const glm::dvec2& p) {
      const glm::dvec2 q = radius * concentric(p);
      return center + q.x * across.u + q.y * across.v;
    };
    add_grid(
        glm::ivec2(parts(2 * radius, size, 4)), at, [&](const glm::dvec3&) { return normal; }, senders);
    scale_to(std::numbers::pi * radius * radius, center, senders);
  } else {
    const glm::ivec2 count(parts(std::numbers::pi / 2 * radius, size, 2));
    for (int axis = 0; axis < 3; ++axis)
      for (const double side : {-1.0, 1.0}) {
        const auto at = [&](const glm::dvec2& p) {
          // Equal angles along the cube's edges: the parts are of nearly one size.
          const glm::dvec2 q = glm::tan(p * std::numbers::pi / 4.0);
          glm::dvec3 d;
          d[axis] = side;
          d[(axis + 1) % 3] = q.x;
          d[(axis + 2) % 3] = q.y;
          return center + radius * glm::normalize(d);
        };
        add_grid(
            count, at, [&](const glm::dvec3& p) { return p - center; }, senders);
      }
    scale_to(4 * std::numbers::pi * radius * radius, center, senders);
  }
  return senders;
}

Sender turned(Sender sender) {
  sender.normal = -sender.normal;
  return sender;
}

}  // namespace

Sender make_sender(std::span<const glm::dvec3> corners, const glm::dvec3& front) {
  Sender sender{.corners = {}, .corner_count = corners.size(), .normal = front, .area = 0};
  std::ranges::copy(corners, sender.corners.begin());
  // A triangle has its last corner twice.
  if (corners.size() == 3) sender.corners[3] = corners[2];
  const glm::dvec3 across = glm::cross(sender.corners[2] - sender.corners[0], sender.corners[3] - sender.corners[1]);
  const double length = glm::length(across);
  sender.area = length / 2;
  sender.normal = glm::dot(across, front) < 0 ? -across / length : across / length;
  return sender;
}

glm::dvec3 Sender::center() const {
  if (corner_count == 3) return (corners[0] + corners[1] + corners[2]) / 3.0;
  return (corners[0] + corners[1] + corners[2] + corners[3]) / 4.0;
}

Sender::Spot Sender::at(const glm::dvec2& square) const {
  glm::dvec2 p = square;
  if (corner_count == 3) {
    if (p.x + p.y > 1) p = 1.0 - p;
    return {corners[0] + p.x * (corners[1] - corners[0]) + p.y * (corners[2] - corners[0]), 1};
  }
  const glm::dvec3 low = glm::mix(corners[0], corners[1], p.x), high = glm::mix(corners[3], corners[2], p.x);
  const glm::dvec3 along = glm::mix(corners[1] - corners[0], corners[2] - corners[3], p.y);
  return {glm::mix(low, high, p.y), glm::length(glm::cross(along, high - low)) / area};
}

std::vector<Sender> senders_of(const Light& light, double size) {
  if (!has_area(light)) return {};
  const LightShape shape(light);
  std::vector<Sender> senders = front_of(shape, size);
  if (shape.is_flat() && !shape.is_one_sided)
    for (std::size_t i = senders.size(); i-- > 0;) senders.push_back(turned(senders[i]));
  return senders;
}

}  // namespace gnomon::radiosity
