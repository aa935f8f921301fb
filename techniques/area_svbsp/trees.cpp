#include "trees.h"

#include <gnomon/kit/area/light_pyramid.h>
#include <gnomon/kit/parallel.h>

#include <algorithm>
#include <cmath>
#include <tuple>

namespace gnomon::area_svbsp {

namespace {

constexpr std::size_t most_candidates = 1 << 15;  ///< volumes that a side may meet; with more it is left whole

/// The sides that are turned to a light.
std::vector<Side> find_sides(const Lighting& lighting, double epsilon, std::vector<std::uint32_t>& first_of) {
  const LightBody& light = *lighting.body;
  Bounds lamp;
  for (const Corner& corner : light.corners) lamp.add(glm::vec3(corner.at));
  std::vector<Side> sides;
  first_of.assign(1, 0);
  std::uint32_t number = 0;
  for (const Mesh& mesh : lighting.casters->scene->meshes) {
    Bounds box;
    box.add(mesh.positions);
    const bool is_apart = glm::any(glm::lessThan(box.max, lamp.min)) || glm::any(glm::lessThan(lamp.max, box.min));
    const bool has_inside = mesh.casts && mesh.is_closed() && is_apart;
    for (std::size_t t = 0; t < mesh.triangles.size();
         ++t, ++number, first_of.push_back(static_cast<std::uint32_t>(sides.size()))) {
      if (!mesh.receives) continue;
      const std::array corners = corners_of(mesh.corners(t));
      const std::optional<ClipPlane> plane = plane_of(corners);
      if (!plane) continue;
      const auto faces = static_cast<unsigned>(lies_of(light, *plane, epsilon));
      for (const int light_side : {1, -1}) {
        if (light_side < 0 && (!light.is_flat || light.is_one_sided)) continue;
        if (light.is_flat && values_of(corners, light.plane_toward(light_side)).high <= epsilon) continue;
        const auto in_plane = static_cast<std::int8_t>(light.is_flat ? light_side : 0);
        if (faces & 2) sides.push_back({number, 1, in_plane});
        if ((faces & 1) && !has_inside) sides.push_back({number, -1, in_plane});
      }
    }
  }
  return sides;
}

/// Finds the volumes that one side meets.
class Finder {
 public:
  Finder(const Lighting& lighting, double epsilon) : lighting_(lighting), epsilon_(epsilon) {}

  void run(const Triangle& triangle, const Side& side, std::span<const Corner> part, std::vector<std::uint32_t>& found) {
    found.clear();
    const LightBody& light = *lighting_.body;
    const ClipPlane own = *plane_of(corners_of(triangle)), plane = side.side > 0 ? own : -own;
    planes_.clear();
    PlaneMaker(light, epsilon_).add_shaft(part, planes_);
    planes_.push_back(plane);
    if (light.is_flat) planes_.push_back(light.plane_toward(side.light_side));
    glm::dvec3 low(INFINITY), high(-INFINITY);
    for (const std::span<const Corner> corners : {part, std::span(light.corners)})
      for (const Corner& corner : corners) {
        low = glm::min(low, corner.at);
        high = glm::max(high, corner.at);
      }
    const auto meets = [&](const float* lower, const float* upper) {
      for (int k = 0; k < 3; ++k)
        if (upper[k] < low[k] - epsilon_ || lower[k] > high[k] + epsilon_) return false;
      return std::ranges::all_of(planes_, [&](const ClipPlane& p) {
        const glm::dvec3& n = p.normal;
        return n.x * (n.x > 0 ? upper : lower)[0] + n.y * (n.y > 0 ? upper : lower)[1] + n.z * (n.z > 0 ? upper : lower)[2] +
                   p.offset >
               -epsilon_;
      });
    };
    const Casters& casters = *lighting_.casters;
    casters.boxes.each(meets, [&](std::uint32_t place) {
      const std::uint32_t number = casters.boxes.order()[place];
      const CasterPolygon& polygon = casters.polygons[number];
      const Bounds box = polygon.bounds();
      if (!meets(&box.min.x, &box.max.x)) return false;
      double highest = -INFINITY;
      for (std::uint32_t k = 0; k < polygon.count; ++k) highest = std::max(highest, plane.at(glm::dvec3(polygon.corners[k])));
      if (highest <= epsilon_) return false;
      if (highest < 1e5 * epsilon_ && casters.is_coplanar(triangle.points, polygon)) return false;
      const auto [begin, end] = lighting_.volumes->of(number);
      for (std::uint32_t v = begin; v < end; ++v) {
        const Volume& volume = lighting_.volumes->all()[v];
        int crossing = 0;
        if (volume.light_side != side.light_side) continue;
        if (relation(lighting_.volumes->penumbra(volume), part, epsilon_, crossing) != Relation::outside) found.push_back(v);
      }
      return found.size() > most_candidates;
    });
  }

 private:
  const Lighting& lighting_;
  double epsilon_;
  std::vector<ClipPlane> planes_;
};

}  // namespace

std::vector<Corner> part_of(const Triangle& triangle, const LightBody& light, int light_side, double epsilon) {
  Clipper clipper;
  clipper.start(corners_of(triangle));
  if (light.is_flat) clipper.keep_positive(light.plane_toward(light_side), epsilon);
  return {clipper.corners().begin(), clipper.corners().end()};
}

void find_between(const Casters& casters, const Receiver& receiver, const LightFigure& figure,
                  std::vector<std::uint32_t>& found) {
  found.clear();
  const LightPyramid pyramid(glm::dvec3(receiver.point), figure);
  const auto meets = [&](const float* lower, const float* upper) { return pyramid.meets(lower, upper); };
  casters.boxes.each(meets, [&](std::uint32_t place) {
    const std::uint32_t number = casters.boxes.order()[place];
    const CasterPolygon& polygon = casters.polygons[number];
    const Bounds bounds = polygon.bounds();
    if (!pyramid.meets(&bounds.min.x, &bounds.max.x)) return false;
    if (!casters.leaves_out(receiver, polygon)) found.push_back(number);
    return false;
  });
}

double casters_before(const Scene& scene, const Light& light) {
  constexpr std::size_t wanted = 64;
  double area = 0;
  const auto each_receiver = [&](const auto& use) {
    for (const Mesh& mesh : scene.meshes)
      for (std::size_t t = 0; mesh.receives && t < mesh.triangles.size(); ++t)
        if (const Triangle triangle = mesh.corners(t); use(triangle, glm::length(triangle.normal()))) return;
  };
  each_receiver([&](const Triangle&, double twice) {
    area += twice;
    return false;
  });
  // Place k of the triangles, laid out one after the other by area, is inside the next one that reaches as far.
  std::vector<LightPyramid> pyramids;
  std::size_t asked = 0;
  double before = 0;
  each_receiver([&](const Triangle& triangle, double twice) {
    before += twice;
    for (; asked < wanted && (static_cast<double>(asked) + 0.5) * area < before * wanted; ++asked) {
      // Spread over the triangle, where one of them holds many places (Roberts 2018, folded).
      double u = std::fmod(0.5 + static_cast<double>(asked) * 0.7548776662466927, 1.0),
             v = std::fmod(0.5 + static_cast<double>(asked) * 0.5698402909980532, 1.0);
      if (u + v > 1) std::tie(u, v) = std::pair(1 - u, 1 - v);
      const glm::dvec3 a = triangle.points[0],
                       place = a + u * (glm::dvec3(triangle.points[1]) - a) + v * (glm::dvec3(triangle.points[2]) - a);
      const glm::dvec3 normal = glm::normalize(triangle.normal());
      for (const double side : {1.0, -1.0})
        if (const LightFigure figure(light, place, side * normal); figure.is_seen()) {
          pyramids.emplace_back(place, figure);
          break;
        }
    }
    return asked == wanted;
  });
  std::size_t met = 0;
  for (const Mesh& mesh : scene.meshes)
    for (std::size_t t = 0; mesh.casts && t < mesh.triangles.size(); ++t) {
      Bounds box;
      box.add(mesh.corners(t).points);
      for (const LightPyramid& pyramid : pyramids) met += pyramid.meets(&box.min.x, &box.max.x);
    }
  return pyramids.empty() ? 0 : static_cast<double>(met) / static_cast<double>(pyramids.size());
}

void Trees::grow(const Lighting& lighting, const Rules& rules, std::uint64_t most_tests) {
  sides_ = find_sides(lighting, rules.epsilon, first_of_);
  trees_.clear();
  trees_.resize(sides_.size());
  const auto triangle_of = [&](const Side& side) {
    const TriangleNumbers& numbers = lighting.casters->numbers;
    const std::uint32_t mesh = numbers.mesh_of(side.triangle);
    return lighting.casters->scene->meshes[mesh].corners(side.triangle - numbers.first_of(mesh));
  };
  std::vector<std::vector<std::uint32_t>> found(sides_.size());
  for_blocks(sides_.size(), 16, [&](std::size_t begin, std::size_t end) {
    Finder finder(lighting, rules.epsilon);
    std::vector<std::uint32_t> some;
    for (std::size_t i = begin; i < end; ++i) {
      const Triangle triangle = triangle_of(sides_[i]);
      finder.run(triangle, sides_[i], part_of(triangle, *lighting.body, sides_[i].light_side, rules.epsilon), some);
      found[i].assign(some.begin(), some.end());
    }
  });
  std::uint64_t all = 1;
  for (const auto& some : found) all += some.size();
  std::vector<Work> works(sides_.size());
  for_blocks(sides_.size(), 1, [&](std::size_t i, std::size_t) {
    Tree& tree = trees_[i];
    Work& work = works[i];
    if (found[i].empty()) {
      ++work.lit;
      return;
    }
    if (found[i].size() > most_candidates) {
      ++work.stopped;
      ++work.penumbra;
      tree.penumbras.push_back({.first = 0, .count = Penumbra::open, .corner = 0, .corner_count = 0});
      tree.root = penumbra_cell(0);
      return;
    }
    const Triangle triangle = triangle_of(sides_[i]);
    const glm::dvec3 normal = glm::normalize(triangle.normal()) * static_cast<double>(sides_[i].side);
    Divider divider(lighting, rules);
    divider.run(part_of(triangle, *lighting.body, sides_[i].light_side, rules.epsilon), normal, found[i],
                64 + most_tests / all * found[i].size(), tree, work);
    tree.nodes.shrink_to_fit();
    tree.penumbras.shrink_to_fit();
    tree.polygons.shrink_to_fit();
    tree.corners.shrink_to_fit();
  });
  work_ = {};
  for (const Work& work : works) work_ += work;
}

const Tree* Trees::find(const Side& side) const {
  for (std::uint32_t i = first_of_[side.triangle]; i < first_of_[side.triangle + 1]; ++i)
    if (sides_[i].side == side.side && sides_[i].light_side == side.light_side) return &trees_[i];
  return nullptr;
}

std::size_t Trees::node_count() const {
  std::size_t sum = 0;
  for (const Tree& tree : trees_) sum += tree.nodes.size();
  return sum;
}

std::size_t Trees::bytes() const {
  std::size_t sum = bytes_of(sides_, trees_, first_of_);
  for (const Tree& tree : trees_) sum += tree.bytes();
  return sum;
}

}  // namespace gnomon::area_svbsp
