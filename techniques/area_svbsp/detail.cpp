#include "detail.h"

#include <algorithm>
#include <cmath>

namespace gnomon::area_svbsp {

namespace {

/// Collects the polygons of one triangle.
class Collector {
 public:
  Collector(std::uint32_t mesh, std::uint32_t triangle, SurfaceDetail& detail)
      : mesh_(mesh),
        triangle_(triangle),
        detail_(detail),
        first_corner_(detail.corners.size()),
        first_(detail.polygons.size()) {}

  void add(std::span<const Corner> polygon, Link kind) {
    if (polygon.size() < 3) return;
    DetailPolygon part{.mesh = mesh_,
                       .triangle = triangle_,
                       .is_lit = kind == lit_cell,
                       .first = static_cast<std::uint32_t>(detail_.corners.size()),
                       .count = static_cast<std::uint32_t>(polygon.size()),
                       .is_penumbra = is_penumbra(kind)};
    for (const Corner& corner : polygon) detail_.corners.push_back(corner.at);
    detail_.polygons.push_back(part);
  }
  /// Makes one polygon of many that are alike.
  void merge(std::span<const Corner> whole) {
    const auto made = std::span(detail_.polygons).subspan(first_);
    if (made.size() < 2) return;
    const DetailPolygon one = made[0];
    const auto differs = [&](const DetailPolygon& p) { return p.is_lit != one.is_lit || p.is_penumbra != one.is_penumbra; };
    if (std::ranges::any_of(made, differs)) return;
    detail_.corners.resize(first_corner_);
    detail_.polygons.resize(first_);
    add(whole, one.is_lit ? lit_cell : one.is_penumbra ? penumbra_cell(0) : umbra_cell);
  }

 private:
  std::uint32_t mesh_, triangle_;
  SurfaceDetail& detail_;
  std::size_t first_corner_, first_;
};

/// Takes a polygon to the cells of a tree.
void filter(const Tree& tree, Link link, std::vector<Corner> polygon, double epsilon, Collector& collector) {
  std::vector<double> values;
  while (link >= 0) {
    const Node& node = tree.nodes[link];
    values.resize(polygon.size());
    const Lies lies = classify(polygon, node.plane, epsilon, values.data());
    if (lies == Lies::within) return;
    if (lies == Lies::across) {
      std::vector<Corner> negative(polygon.size() + 1), positive(polygon.size() + 1);
      const CutCounts counts = cut_polygon(polygon, values.data(), epsilon, 0, negative.data(), positive.data());
      negative.resize(counts.negative);
      positive.resize(counts.positive);
      filter(tree, node.sides[0], std::move(negative), epsilon, collector);
      polygon = std::move(positive);
    }
    link = node.sides[lies != Lies::negative];
  }
  collector.add(polygon, link);
}

/// The tree of a part of a triangle that counts.
const Tree* tree_of(const Trees& trees, std::uint32_t triangle, std::int8_t light_side) {
  const Tree* const front = trees.find({triangle, 1, light_side});
  return front ? front : trees.find({triangle, -1, light_side});
}

void divide(const Trees& trees, const LightBody& light, std::uint32_t number, const Triangle& triangle, double epsilon,
            Collector& collector) {
  const std::array whole = corners_of(triangle);
  const std::optional<ClipPlane> plane = plane_of(whole);
  if (!plane || lies_of(light, *plane, epsilon) == Lies::within) return;  // edge-on
  for (const int light_side : {1, -1}) {
    if (!light.is_flat && light_side < 0) continue;
    if (light.is_flat && values_of(whole, light.plane_toward(light_side)).high <= epsilon) continue;
    std::vector<Corner> part = part_of(triangle, light, light_side, epsilon);
    if (const Tree* const tree = tree_of(trees, number, static_cast<std::int8_t>(light.is_flat ? light_side : 0)))
      filter(*tree, tree->root, std::move(part), epsilon, collector);
    else
      collector.add(part, light.is_one_sided && light_side < 0 ? lit_cell : penumbra_cell(0));
  }
  collector.merge(whole);
}

}  // namespace

double interpolated(std::span<const ShadedCorner> corners, const glm::dvec3& point) {
  double best = 0, least_outside = INFINITY;
  for (std::size_t k = 2; k < corners.size(); ++k) {
    const glm::dvec3 u = corners[k - 1].at - corners[0].at, v = corners[k].at - corners[0].at, p = point - corners[0].at;
    const double uu = glm::dot(u, u), uv = glm::dot(u, v), vv = glm::dot(v, v), pu = glm::dot(p, u), pv = glm::dot(p, v);
    const double determinant = uu * vv - uv * uv;
    if (!(determinant > 0)) continue;
    double s = (vv * pu - uv * pv) / determinant, t = (uu * pv - uv * pu) / determinant;
    const double outside = std::max({-s, -t, s + t - 1, 0.0});
    if (outside >= least_outside) continue;
    least_outside = outside;
    s = std::clamp(s, 0.0, 1.0);
    t = std::clamp(t, 0.0, 1 - s);
    best = corners[0].share + s * (corners[k - 1].share - corners[0].share) + t * (corners[k].share - corners[0].share);
    if (outside == 0) break;
  }
  return std::clamp(best, 0.0, 1.0);
}

SurfaceDetail divide_triangles(const Casters& casters, const Trees& trees, const LightBody& light, double epsilon) {
  const Scene& scene = *casters.scene;
  SurfaceDetail all;
  for (std::uint32_t m = 0; m < scene.meshes.size(); ++m) {
    if (!scene.meshes[m].receives) continue;
    for (std::uint32_t t = 0; t < scene.meshes[m].triangles.size(); ++t) {
      Collector collector(m, t, all);
      divide(trees, light, casters.numbers.first_of(m) + t, scene.meshes[m].corners(t), epsilon, collector);
    }
  }
  return all;
}

}  // namespace gnomon::area_svbsp
