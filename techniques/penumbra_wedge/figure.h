#pragma once
#include <gnomon/kit/area/light_figure.h>

#include <array>

namespace gnomon::penumbra_wedge {

/// A line of the light's plane in the coordinates of its places; inside is where x + y * s + z * t >= 0.
using PlaceLine = glm::dvec3;

inline double line_at(const PlaceLine& line, const glm::dvec2& place) { return line.x + line.y * place.x + line.z * place.y; }

inline double cross(const glm::dvec2& a, const glm::dvec2& b) { return a.x * b.y - a.y * b.x; }

/// A convex part of the square around a light's figure, by few lines. Allocates nothing.
class Figure {
 public:
  /// What the point's horizon leaves.
  explicit Figure(const LightFigure& face);
  void clip(const PlaceLine& line);
  /// Of what lies on the light, in places: a whole rectangle has 4, a disc pi. Closed form.
  double area() const;

 private:
  static constexpr int most_corners = 12;  // four of the square, one more for each line
  std::array<glm::dvec2, most_corners> corners_;
  int count_ = 0;
  bool is_disc_ = false;
};

}  // namespace gnomon::penumbra_wedge
