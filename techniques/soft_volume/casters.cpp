#include "casters.h"

#include <gnomon/kit/geometry/sure_sign.h>
#include <gnomon/kit/parallel.h>

#include <algorithm>
#include <cmath>
#include <tuple>

namespace gnomon::soft_volume {

namespace {

constexpr std::size_t leaf_size = 8;
}  // namespace

/// Splits in half by count along the longest axis of the edges' middles.
struct Casters::Builder {
  Casters& casters;
  std::vector<CasterEdge> edges;

  Bounds bounds(const CasterEdge& edge) const {
    Bounds b;
    b.add(casters.position(edge.low));
    b.add(casters.position(edge.high));
    return b;
  }
  void build(std::size_t first, std::size_t last) {
    const std::size_t index = casters.nodes_.size();
    Bounds box, middles;
    glm::dvec3 sum(0);
    for (std::size_t i = first; i < last; ++i) {
      const Bounds b = bounds(edges[i]);
      box.add(b);
      middles.add(glm::vec3(middle_of(b)));
      sum += glm::dvec3(casters.planes_[edges[i].first]) + glm::dvec3(casters.planes_[edges[i].second]);
    }
    Node node{.low = {box.min.x, box.min.y, box.min.z}, .high = {box.max.x, box.max.y, box.max.z}};
    node.first = static_cast<std::uint32_t>(first);
    const double length = glm::length(sum);
    if (length > 0) {
      const glm::vec3 axis(sum / length);
      double cosine = 1;
      for (std::size_t i = first; i < last; ++i)
        for (const std::uint32_t t : {edges[i].first, edges[i].second}) {
          const glm::dvec3 normal(casters.planes_[t]);
          cosine = std::min(cosine, normal != glm::dvec3(0) ? glm::dot(glm::dvec3(axis), normal) : -1);
        }
      // Wider by 1e-5, for what float32 rounds here and in the query.
      cosine = std::max(cosine - 1e-5, -1.0);
      for (int k = 0; k < 3; ++k) node.axis[k] = axis[k];
      node.cosine = static_cast<float>(cosine);
      node.sine = static_cast<float>(std::sqrt(1 - cosine * cosine));
    }
    if (last - first <= leaf_size) node.count = static_cast<std::uint32_t>(last - first);
    casters.nodes_.push_back(node);
    if (node.count == 0) {
      const glm::vec3 size = middles.max - middles.min;
      const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
      const std::size_t middle = first + (last - first) / 2;
      const auto key = [&](const CasterEdge& edge) {
        const double low = casters.position(edge.low)[axis], high = casters.position(edge.high)[axis];
        return std::tuple(low + high, edge.low, edge.high);
      };
      const auto at = [&](std::size_t i) { return edges.begin() + static_cast<std::ptrdiff_t>(i); };
      std::ranges::nth_element(at(first), at(middle), at(last), {}, key);
      build(first, middle);
      build(middle, last);
    }
    casters.nodes_[index].skip = static_cast<std::uint32_t>(casters.nodes_.size());
  }
};

Casters::Casters(CutMasks cut) : CastingTriangles(cut.scene()), cut_(std::move(cut)) {
  find_planes();
  add_edges();
}

void Casters::find_planes() {
  planes_.resize(adjacency().triangles().size());
  for_blocks(planes_.size(), 8192, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) {
      const Triangle corners = adjacency().corners(cut_.source(static_cast<std::uint32_t>(t)));
      const glm::dvec3 a = corners.points[0], u = glm::dvec3(corners.points[1]) - a, v = glm::dvec3(corners.points[2]) - a;
      const glm::dvec3 normal = glm::cross(u, v);
      const double length = glm::length(normal);
      planes_[t] = glm::dvec4(0);
      // The normal errs by 2^-51 of what its products add up to, at most of |u| |v|; exact signs decide thinner ones.
      if (!(length > 0x1p-20 * glm::length(u) * glm::length(v) && length > 0)) continue;
      planes_[t] = glm::dvec4(normal / length, -glm::dot(normal / length, a));
    }
  });
}

void Casters::add_edges() {
  Builder builder{*this, {}};
  const auto mesh_of = [&](std::uint32_t triangle) { return numbers().mesh_of(triangle); };
  std::vector<CasterEdge> irregular;
  sides_.assign(adjacency().sides().begin(), adjacency().sides().end());
  for (const EdgeAdjacency::IrregularEdge& edge : adjacency().irregular_edges())
    irregular.push_back({edge.low, edge.high, edge.first_side, edge.side_count});
  for (const EdgeAdjacency::Edge& edge : adjacency().edges()) {
    // Two triangles in one plane that continue each other face alike for every point, and one is left out with the other.
    if (mesh_of(edge.first) == mesh_of(edge.second)) {
      const bool continues = glm::dot(glm::dvec3(planes_[edge.first]), glm::dvec3(planes_[edge.second])) > 0.5;
      const std::uint32_t first = cut_.source(edge.first), second = cut_.source(edge.second);
      if (continues && coplanar(adjacency().corners(first), adjacency().corners(second).points)) continue;
      builder.edges.push_back({edge.low, edge.high, edge.first, edge.second});
      continue;
    }
    irregular.push_back({edge.low, edge.high, static_cast<std::uint32_t>(sides_.size()), 2});
    sides_.push_back(2 * edge.first + 1);
    sides_.push_back(2 * edge.second);
  }
  nodes_.clear();
  if (!builder.edges.empty()) builder.build(0, builder.edges.size());
  edges_ = std::move(builder.edges);
  regular_count_ = static_cast<std::uint32_t>(edges_.size());
  std::vector<Bounds> boxes;
  for (const CasterEdge& edge : irregular) boxes.push_back(builder.bounds(edge));
  irregular_tree_ = BoxTree(boxes);
  for (const std::uint32_t item : irregular_tree_.order()) edges_.push_back(irregular[item]);
  edges_.shrink_to_fit();
}

bool Casters::faces_alike(const Viewers& from, std::uint32_t edge) const {
  int sides = 0;
  for (const std::uint32_t t : {edges_[edge].first, edges_[edge].second}) {
    const glm::dvec4& plane = planes_[t];
    const double height = glm::dot(glm::dvec3(plane), from.middle) + plane.w,
                 wide = glm::dot(glm::abs(glm::dvec3(plane)), from.half) + from.slack + 0x1p-20 * std::abs(plane.w);
    if (!(std::abs(height) > wide)) return false;
    sides += height > 0 ? 1 : -1;
  }
  return sides != 0;
}

bool Casters::meets(const Beam& beam, std::uint32_t edge) const {
  const glm::vec3 &a = position(edges_[edge].low), &b = position(edges_[edge].high);
  const glm::vec3 low = glm::min(a, b), high = glm::max(a, b);
  return beam.meets(&low.x, &high.x);
}

std::size_t Casters::find_edges(const Beam& beam, const Bounds& points, std::vector<std::uint32_t>& found) const {
  found.clear();
  const Viewers from(points);
  const double radius = glm::length(from.half);
  for (std::uint32_t i = 0; i < nodes_.size();) {
    const Node& node = nodes_[i];
    if (!beam.meets(node.low, node.high)) {
      i = node.skip;
      continue;
    }
    // All triangles here face all points alike where the cone of normals, seen from the middle of the box of points, stays on
    // one side by more than both boxes are wide: n . (p - x) for |p - middle| and |x - center| within their radii.
    glm::dvec3 way, size;
    for (int k = 0; k < 3; ++k) {
      way[k] = from.middle[k] - 0.5 * (static_cast<double>(node.low[k]) + node.high[k]);
      size[k] = 0.5 * (static_cast<double>(node.high[k]) - node.low[k]);
    }
    const double along = way.x * node.axis[0] + way.y * node.axis[1] + way.z * node.axis[2], square = glm::dot(way, way),
                 across = std::sqrt(std::max(0.0, square - along * along)), reach = radius + glm::length(size);
    if (std::abs(along) * node.cosine - across * node.sine > reach * 1.0001 + 1e-5 * std::sqrt(square) + from.slack) {
      i = node.skip;
      continue;
    }
    for (std::uint32_t e = node.first; e < node.first + node.count; ++e)
      if (!faces_alike(from, e) && meets(beam, e)) found.push_back(e);
    ++i;
  }
  const std::size_t regular = found.size();
  irregular_tree_.each([&](const float* low, const float* high) { return beam.meets(low, high); },
                       [&](std::uint32_t place) {
                         if (meets(beam, regular_count_ + place)) found.push_back(regular_count_ + place);
                         return false;
                       });
  return regular;
}

std::size_t Casters::narrow_edges(const Beam& beam, const Bounds& points, std::span<const std::uint32_t> wide,
                                  std::vector<std::uint32_t>& found) const {
  found.clear();
  const Viewers from(points);
  std::size_t regular = 0;
  for (const std::uint32_t e : wide) {
    if ((is_regular(e) && faces_alike(from, e)) || !meets(beam, e)) continue;
    found.push_back(e);
    regular += is_regular(e);
  }
  return regular;
}

int Casters::facing(const NumberedReceiver& receiver, std::uint32_t number, CoplanarCache& cache) const {
  const std::uint32_t triangle = cut_.source(number);
  const glm::dvec4& plane = planes_[triangle];
  const double height = glm::dot(glm::dvec3(plane), glm::dvec3(receiver.point)) + plane.w,
               scale = extent(receiver.point) + std::abs(plane.w);
  // Rounding may have put a point so far off its own plane: there the rule of receivers and exact signs decide.
  const bool is_near = !(std::abs(height) > 0x1p-21 * scale);
  if ((is_near || receiver.own_count > 1) && receiver.is_own(triangle)) return 0;
  if (!is_near) return height > 0 ? 1 : -1;
  // A plane that double cannot tell from one through the point is seen edge-on: its edges have no sides.
  const bool has_plane = glm::dvec3(plane) != glm::dvec3(0);
  if (has_plane && std::abs(height) <= 0x1p-48 * scale) return 0;
  const Triangle corners = adjacency().corners(triangle);
  const auto is_coplanar = [&] { return receiver.is_coplanar(scene(), corners.points); };
  if (receiver.has_triangle() && cache.is_coplanar(receiver.first_own, triangle, is_coplanar)) return 0;
  return orient3d_sign(corners.points[0], corners.points[1], corners.points[2], receiver.point);
}

int Casters::multiplicity(const NumberedReceiver& receiver, std::uint32_t number, CoplanarCache& cache) const {
  const CasterEdge& edge = edges_[number];
  if (is_regular(number)) return facing(receiver, edge.first, cache) - facing(receiver, edge.second, cache);
  int sum = 0;
  for (std::uint32_t k = edge.first; k < edge.first + edge.second; ++k) {
    const int one = facing(receiver, sides_[k] / 2, cache);
    sum += sides_[k] & 1 ? one : -one;
  }
  return sum;
}

// As in crosses() of kit/geometry/exact.h, with the point at the origin. Where a sign is not sure, the answer is not.
Way Casters::crosses(const NumberedReceiver& receiver, std::uint32_t triangle, const glm::dvec3& to,
                     CoplanarCache& cache) const {
  const Triangle corners = adjacency().corners(triangle);
  const glm::dvec3 p = receiver.point, u = glm::dvec3(corners.points[0]) - p, v = glm::dvec3(corners.points[1]) - p,
                   w = glm::dvec3(corners.points[2]) - p;
  double uv = 0, vw = 0, wu = 0;
  const int ab = sure_sign(u, v, to, uv), bc = sure_sign(v, w, to, vw);
  if (ab * bc < 0) return Way::clear;
  const int ca = sure_sign(w, u, to, wu);
  if (ab * ca < 0 || bc * ca < 0) return Way::clear;
  // Of a point over the triangle, which it sees counter-clockwise, det(u, v, w) is negative.
  const int side = -facing(receiver, triangle, cache);
  if (side == 0 || side * (ab + bc + ca) < 0) return Way::clear;
  if (ab + bc + ca == 0) return Way::unsure;
  // The way is met at det(u, v, w) / (uv + vw + wu) of it; at its end the light begins.
  double volume;
  sure_sign(u, v, w, volume);
  if (std::abs(volume) >= std::abs(uv + vw + wu) * (1 - 0x1p-40)) return Way::clear;
  return ab * bc * ca == 0 ? Way::unsure : Way::blocked;
}

Way Casters::way(const NumberedReceiver& receiver, const glm::dvec3& to, CoplanarCache& cache, std::uint32_t& hint) const {
  if (hint < planes_.size() && crosses(receiver, hint, to, cache) == Way::blocked) return Way::blocked;
  bool is_unsure = false;
  const bool is_blocked = any_on_way(receiver.point, to, [&](std::uint32_t triangle) {
    const Way one = crosses(receiver, triangle, to, cache);
    is_unsure |= one == Way::unsure;
    if (one == Way::blocked) hint = triangle;
    return one == Way::blocked;
  });
  return is_blocked ? Way::blocked : is_unsure ? Way::unsure : Way::clear;
}

}  // namespace gnomon::soft_volume
