#include <gnomon/kit/bytes.h>
#include <gnomon/kit/geometry/edges.h>
#include <gnomon/kit/geometry/joined_vertices.h>
#include <gnomon/kit/geometry/refit.h>
#include <gnomon/kit/parallel.h>

#include <algorithm>
#include <numeric>

namespace gnomon {

constexpr std::size_t edge_block = std::size_t{1} << 15;

EdgeAdjacency::EdgeAdjacency(const Scene& scene, Joins joins)
    : joins_by_rigs_(joins == Joins::in_every_pose && scene.motion && follows_animation(scene)) {
  std::vector<std::uint8_t> casts;  // of each vertex
  for (const Mesh& mesh : scene.meshes) {
    const auto base = static_cast<std::uint32_t>(positions_.size());
    meshes_.push_back({.first = static_cast<std::uint32_t>(triangles_.size()),
                       .count = static_cast<std::uint32_t>(mesh.triangles.size()),
                       .casts = mesh.casts,
                       .has_holes = mesh.alpha_mask || mesh.transmission,
                       .first_vertex = base,
                       .vertex_count = static_cast<std::uint32_t>(mesh.positions.size())});
    positions_.insert(positions_.end(), mesh.positions.begin(), mesh.positions.end());
    casts.resize(positions_.size(), mesh.casts);
    for (const glm::uvec3& t : mesh.triangles) triangles_.push_back(t + base);
    meshes_.back().bounds.add(mesh.positions);
    extent_ = std::max(extent_, meshes_.back().bounds.extent());
  }
  first_at_position_ = joins_by_rigs_ ? join_vertices(scene, positions_, casts) : weld(positions_, casts);
  if (joins_by_rigs_) {
    for (const Rig& rig : scene.motion->rigs) meshes_[rig.mesh].has_rig = true;
    find_groups();
  }
  join_edges();
  find_parts();
  for (std::vector<float>* const values : {&planes_.x, &planes_.y, &planes_.z, &planes_.offset})
    values->resize(triangles_.size());
  find_planes(0, triangles_.size());
}

bool EdgeAdjacency::is_collapsed(std::uint32_t triangle) const {
  const glm::uvec3& t = triangles_[triangle];
  const std::uint32_t a = first_at_position_[t.x], b = first_at_position_[t.y], c = first_at_position_[t.z];
  return a == b || b == c || c == a;
}

/// Half-edges by their lower ends: those of vertex v are `of(v)`, a few, in the order of their triangles.
struct EdgeAdjacency::HalfEdges {
  struct HalfEdge {
    std::uint32_t high;
    Side side;
    bool operator<(const HalfEdge& other) const { return high != other.high ? high < other.high : side < other.side; }
  };
  std::vector<std::uint32_t> begin;
  std::vector<HalfEdge> all;

  std::span<HalfEdge> of(std::size_t vertex) { return {all.begin() + begin[vertex], all.begin() + begin[vertex + 1]}; }
};

/// What one thread finds at some vertices.
struct EdgeAdjacency::JoinedEdges {
  std::vector<Edge> edges;
  std::vector<IrregularEdge> irregular;
  std::vector<Side> sides;

  /// Joins the half-edges of one vertex, sorted by the higher end and then by triangle, so that the outcome has one order.
  void add(std::uint32_t low, std::span<HalfEdges::HalfEdge> halves) {
    std::sort(halves.begin(), halves.end());
    for (std::size_t i = 0, j; i < halves.size(); i = j) {
      const std::uint32_t high = halves[i].high;
      for (j = i + 1; j < halves.size() && halves[j].high == high;) ++j;
      if (j == i + 2 && (halves[i].side & 1) != (halves[i + 1].side & 1)) {
        const bool in_order = halves[i].side & 1;
        edges.push_back({low, high, halves[in_order ? i : i + 1].side / 2, halves[in_order ? i + 1 : i].side / 2});
      } else {
        irregular.push_back({low, high, static_cast<std::uint32_t>(sides.size()), static_cast<std::uint32_t>(j - i)});
        for (std::size_t k = i; k < j; ++k) sides.push_back(halves[k].side);
      }
    }
  }
};

EdgeAdjacency::HalfEdges EdgeAdjacency::find_half_edges() const {
  const auto for_half_edges = [&](auto&& visit) {
    for (const MeshTriangles& mesh : meshes_) {
      if (!mesh.casts) continue;
      for (std::uint32_t t = mesh.first; t < mesh.first + mesh.count; ++t) {
        if (is_collapsed(t)) continue;
        for (int k = 0; k < 3; ++k) {
          const std::uint32_t from = first_at_position_[triangles_[t][k]], to = first_at_position_[triangles_[t][(k + 1) % 3]];
          visit(std::min(from, to), std::max(from, to), 2 * t + (from < to));
        }
      }
    }
  };
  HalfEdges halves;
  halves.begin.assign(positions_.size() + 1, 0);
  for_half_edges([&](std::uint32_t low, std::uint32_t, Side) { ++halves.begin[low + 1]; });
  std::partial_sum(halves.begin.begin(), halves.begin.end(), halves.begin.begin());
  halves.all.resize(halves.begin.back());
  std::vector<std::uint32_t> next(halves.begin.begin(), halves.begin.end() - 1);
  for_half_edges([&](std::uint32_t low, std::uint32_t high, Side side) { halves.all[next[low]++] = {high, side}; });
  return halves;
}

void EdgeAdjacency::join_edges() {
  HalfEdges halves = find_half_edges();
  std::vector<JoinedEdges> blocks((positions_.size() + edge_block - 1) / edge_block);
  for_blocks(positions_.size(), edge_block, [&](std::size_t first, std::size_t last) {
    JoinedEdges& block = blocks[first / edge_block];
    block.edges.reserve((halves.begin[last] - halves.begin[first]) / 2);
    for (std::size_t low = first; low < last; ++low) block.add(static_cast<std::uint32_t>(low), halves.of(low));
  });
  std::size_t edge_count = 0;
  for (const JoinedEdges& block : blocks) edge_count += block.edges.size();
  edges_.reserve(edge_count);
  for (const JoinedEdges& block : blocks) {
    edges_.insert(edges_.end(), block.edges.begin(), block.edges.end());
    for (IrregularEdge edge : block.irregular) {
      edge.first_side += static_cast<std::uint32_t>(sides_.size());
      irregular_.push_back(edge);
    }
    sides_.insert(sides_.end(), block.sides.begin(), block.sides.end());
  }
}

void EdgeAdjacency::find_parts() {
  std::vector<std::uint32_t> leader(triangles_.size());
  std::iota(leader.begin(), leader.end(), 0u);
  const auto find = [&](std::uint32_t t) {
    while (leader[t] != t) t = leader[t] = leader[leader[t]];
    return t;
  };
  // The smaller number leads, so parts are numbered in the order of their first triangles.
  const auto join = [&](std::uint32_t a, std::uint32_t b) {
    a = find(a);
    b = find(b);
    leader[std::max(a, b)] = std::min(a, b);
  };
  for (const Edge& edge : edges_) join(edge.first, edge.second);
  for (const IrregularEdge& edge : irregular_)
    for (std::uint32_t k = 1; k < edge.side_count; ++k) join(sides_[edge.first_side] / 2, sides_[edge.first_side + k] / 2);

  part_of_.assign(triangles_.size(), no_part);
  for (const MeshTriangles& mesh : meshes_) {
    if (!mesh.casts) continue;
    for (std::uint32_t t = mesh.first; t < mesh.first + mesh.count; ++t) {
      if (is_collapsed(t)) continue;
      const std::uint32_t first = find(t);
      if (first == t) {
        part_of_[t] = static_cast<std::uint32_t>(parts_.size());
        parts_.emplace_back();
      }
      Part& part = parts_[part_of_[t] = part_of_[first]];
      part.closed &= !mesh.has_holes;
    }
  }
  for (const MeshTriangles& mesh : meshes_) add_bounds(mesh);
  for (const MeshTriangles& mesh : meshes_) add_volumes(mesh);
  for (const IrregularEdge& edge : irregular_) parts_[part_at(edge)].closed = false;
}

void EdgeAdjacency::add_bounds(const MeshTriangles& mesh) {
  for (std::uint32_t t = mesh.first; t < mesh.first + mesh.count; ++t)
    if (part_of_[t] != no_part) parts_[part_of_[t]].bounds.add(corners(t).points);
}

/// From the bounds of the parts.
void EdgeAdjacency::add_volumes(const MeshTriangles& mesh) {
  for (std::uint32_t t = mesh.first; t < mesh.first + mesh.count; ++t) {
    if (part_of_[t] == no_part) continue;
    Part& part = parts_[part_of_[t]];
    const glm::dvec3 origin = part.bounds.min;
    const auto corner = [&](int k) { return glm::dvec3(positions_[triangles_[t][k]]) - origin; };
    part.volume += glm::dot(corner(0), glm::cross(corner(1), corner(2))) / 6;
  }
}

std::size_t EdgeAdjacency::bytes() const {
  return bytes_of(positions_, triangles_, first_at_position_, part_of_, parts_, edges_, irregular_, sides_, planes_.x,
                  planes_.y, planes_.z, planes_.offset);
}

std::vector<Bounds> solid_parts(const Mesh& mesh) {
  if (!mesh.casts || !mesh.is_closed()) return {};
  Scene alone;
  alone.meshes = {mesh};
  const EdgeAdjacency adjacency(alone);
  std::vector<Bounds> parts;
  for (const EdgeAdjacency::Part& part : adjacency.parts()) {
    if (!part.closed || !(part.volume > 0)) return {};
    parts.push_back(part.bounds);
  }
  return parts;
}

SolidParts solid_parts(const Scene& scene) {
  SolidParts all;
  for (const Mesh& mesh : scene.meshes) all.push_back(solid_parts(mesh));
  return all;
}

}  // namespace gnomon
