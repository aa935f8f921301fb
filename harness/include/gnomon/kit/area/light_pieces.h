#pragma once
#include <gnomon/kit/add_up.h>
#include <gnomon/kit/area/light_figure.h>
#include <gnomon/scene.h>

#include <cstdint>
#include <vector>

namespace gnomon {

/// A share of a light, and two bounds: they are equal but for rounding where the light has corners, and apart by what lies
/// between an inscribed and a circumscribed polygon where it is round.
struct LightShare {
  double low = 1, best = 1, high = 1;
};

/// How much of a light with area one point sees: of the area above its horizon, and of the irradiance that this would give.
struct LightShares {
  LightShare area, irradiance;
};

/// What casters leave of a light with area, seen from one point: convex pieces of its figure. No samples, no epsilon but that
/// pieces below 1e-13 of the figure are let go. Keeps its memory from one point to the next.
///
/// From the point, a caster's triangle covers a cone with three planes through the point, and where it reaches across the
/// light's plane only what is beyond its own plane. Each plane meets the figure's plane in a line, and what of a piece lies
/// inside all lines goes. Area is then that of polygons, and irradiance Lambert's sum over their edges, angle times the
/// normal's part across the edge (Lambert 1760; Baum, Rushmeier and Winget 1989).
class LightPieces {
 public:
  /// Corners of the polygons that a round light lies between. They differ by 0.24 % of its area, and two thirds of what is
  /// between them belong to the light: `best` errs by some 1e-6.
  static constexpr int round_corners = 64;

  /// All of the figure above the horizon. It must be seen.
  void start(const LightFigure& figure);
  /// Takes away what a triangle covers; corners in meters from the point. One whose plane holds the point covers nothing.
  void subtract(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c);
  /// Whether nothing is left.
  bool is_gone() const { return pieces_.empty(); }
  LightShares shares() const;
  std::size_t piece_count() const { return pieces_.size(); }

 private:
  struct Piece {
    std::uint32_t first, count;  ///< of corners_
    LightFigure::Box box;
  };
  struct Measure {
    double area = 0, irradiance = 0;
    Measure& operator+=(const Measure& other) { return add_up(*this, other, &Measure::area, &Measure::irradiance); }
  };
  /// What lies in the polygon inscribed in a round light, and between that and the circumscribed one.
  struct Measures {
    Measure core, rim;
  };
  void add(std::span<const glm::dvec2> polygon);
  /// Takes away what lies inside all lines.
  void subtract_region(std::span<const glm::dvec3> lines);
  /// What of a piece is outside a convex region joins the pieces. Says whether anything was inside.
  bool cut(const Piece& piece, std::span<const glm::dvec3> lines);
  void pack();
  Measure measure(std::span<const glm::dvec2> polygon) const;
  void add_measures(std::span<const glm::dvec2> polygon, Measures& sums) const;
  std::span<const glm::dvec2> corners(const Piece& piece) const { return {corners_.data() + piece.first, piece.count}; }

  const LightFigure* figure_ = nullptr;
  std::vector<Piece> pieces_;
  std::vector<glm::dvec2> corners_;  ///< of the pieces, and of some that are gone
  std::size_t live_corners_ = 0;
  std::vector<glm::dvec2> inside_, outside_, rest_;
  std::vector<glm::dvec2> whole_;  ///< the figure above the horizon, of a round light its circumscribed polygon
  bool is_whole_ = true;
};

}  // namespace gnomon
