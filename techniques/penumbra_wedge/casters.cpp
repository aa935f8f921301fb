#include "casters.h"

#include <gnomon/kit/geometry/sure_sign.h>

#include <algorithm>
#include <cmath>

namespace gnomon::penumbra_wedge {

Casters::Casters(const Scene& scene) : scene_(&scene), extent_(scene.bounds().extent()), numbers_(scene), adjacency_(scene) {
  std::vector<Bounds> boxes;
  std::vector<std::uint32_t> casting;
  constexpr std::uint32_t unknown = no_mesh - 1;
  part_mesh_.assign(adjacency_.parts().size(), unknown);
  std::uint32_t mesh = 0;
  for (std::uint32_t t = 0; t < adjacency_.triangles().size(); ++t) {
    while (t >= numbers_.end_of(mesh)) ++mesh;
    const std::uint32_t part = adjacency_.part_of()[t];
    if (part == EdgeAdjacency::no_part) continue;
    part_mesh_[part] = part_mesh_[part] == unknown || part_mesh_[part] == mesh ? mesh : no_mesh;
    casting.push_back(t);
    boxes.emplace_back().add(adjacency_.corners(t).points);
  }
  tree_ = BoxTree(boxes);
  for (const std::uint32_t item : tree_.order()) triangles_.push_back(casting[item]);
}

bool Casters::has_triangles(const Silhouette& silhouette, const Beam& beam) const {
  bool any = false;
  tree_.each([&](const float* low, const float* high) { return beam.meets(low, high); },
             [&](std::uint32_t place) {
               if (silhouette.facing[triangles_[place]] == 0) return false;
               Bounds box;
               box.add(adjacency_.corners(triangles_[place]).points);
               any = beam.meets(&box.min.x, &box.max.x);
               return any;
             });
  return any;
}

void Casters::find_triangles(const Silhouette& silhouette, const Bounds& box, std::vector<std::uint32_t>& found) const {
  found.clear();
  const auto meets = [&](const float* low, const float* high) {
    for (int k = 0; k < 3; ++k)
      if (low[k] > box.max[k] || high[k] < box.min[k]) return false;
    return true;
  };
  tree_.each(meets, [&](std::uint32_t place) {
    Bounds own;
    own.add(adjacency_.corners(triangles_[place]).points);
    if (silhouette.facing[triangles_[place]] != 0 && meets(&own.min.x, &own.max.x)) found.push_back(triangles_[place]);
    return false;
  });
  std::ranges::sort(found);
}

bool Casters::is_beside(const NumberedReceiver& receiver, std::uint32_t triangle, double volume) const {
  if (!receiver.has_triangle()) return false;
  bool is_neighbor = false;
  for (int k = 0; k < 3; ++k)
    for (int j = 0; j < 3; ++j) is_neighbor |= vertex(triangle, k) == vertex(receiver.first_own, j);
  if (!is_neighbor) return false;
  const double height = std::abs(volume) / glm::length(adjacency_.corners(triangle).normal());
  return height <= 0x1p-21 * (gnomon::extent(receiver.point) + gnomon::extent(position(vertex(triangle, 0))));
}

// As in crosses() of kit/geometry/exact.h, with the point at the origin.
Casters::Crossed Casters::crosses(const NumberedReceiver& receiver, std::uint32_t triangle, const glm::dvec3& to,
                                  int& side) const {
  const Triangle corners = adjacency_.corners(triangle);
  const glm::dvec3 p = receiver.point, u = glm::dvec3(corners.points[0]) - p, v = glm::dvec3(corners.points[1]) - p,
                   w = glm::dvec3(corners.points[2]) - p;
  double uv = 0, vw = 0, wu = 0, volume = 0;
  const int ab = sure_sign(u, v, to, uv), bc = sure_sign(v, w, to, vw);
  if (ab * bc < 0) return Crossed::no;
  const int ca = sure_sign(w, u, to, wu);
  if (ab * ca < 0 || bc * ca < 0) return Crossed::no;
  side = sure_sign(u, v, w, volume);
  // The way is met at volume / (uv + vw + wu) of it; at its end the light begins.
  const double sum = uv + vw + wu;
  if (side != 0 && ab + bc + ca != 0 && (side * (ab + bc + ca) < 0 || std::abs(volume) >= std::abs(sum) * (1 - 0x1p-40)))
    return Crossed::no;
  if (receiver.leaves_out(*scene_, triangle, corners.points) || is_beside(receiver, triangle, volume)) return Crossed::no;
  // A plane through the point is seen edge-on.
  if (side == 0 && orient3d_sign(corners.points[0], corners.points[1], corners.points[2], receiver.point) == 0)
    return Crossed::no;
  return side == 0 || ab * bc * ca == 0 ? Crossed::unsure : Crossed::yes;
}

std::optional<int> Casters::layers(const Silhouette& silhouette, const NumberedReceiver& receiver, const glm::dvec3& to,
                                   bool any, std::uint32_t& hint) const {
  int sum = 0;
  int side = 0;
  if (any && hint < silhouette.facing.size() && silhouette.facing[hint] != 0 &&
      crosses(receiver, hint, to, side) == Crossed::yes)
    return 1;
  bool is_unsure = false;
  const SegmentSlabs slabs({receiver.point, glm::dvec4(glm::dvec3(receiver.point) + to, 1)});
  tree_.any(slabs, 0.0, [&](std::uint32_t place) {
    const std::uint32_t triangle = triangles_[place];
    const int facing = silhouette.facing[triangle];
    if (facing == 0) return false;
    const Crossed one = crosses(receiver, triangle, to, side);
    is_unsure |= one == Crossed::unsure;
    if (one != Crossed::yes) return false;
    hint = triangle;
    sum += facing * side;
    return any;
  });
  if (is_unsure && !(any && sum != 0)) return std::nullopt;
  return any && sum != 0 ? 1 : sum;
}

std::size_t Casters::bytes() const {
  return numbers_.bytes() + adjacency_.bytes() + tree_.bytes() + bytes_of(part_mesh_, triangles_);
}

}  // namespace gnomon::penumbra_wedge
