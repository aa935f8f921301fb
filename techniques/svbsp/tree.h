#pragma once
#include <cassert>

#include "projected_space.h"

namespace gnomon::svbsp {

/// A node, from 0 up, or a cell, from -1 down.
using Link = std::int32_t;
constexpr Link out_cell = -1;  ///< nothing is there
constexpr Link in_cell(std::uint32_t triangle) { return -2 - static_cast<Link>(triangle); }
constexpr bool is_in_cell(Link link) { return link < out_cell; }
/// The triangle of an IN cell: the nearest to the light there.
constexpr std::uint32_t triangle_in(Link link) { return static_cast<std::uint32_t>(-2 - link); }

/// A shadow plane, or a border of tiles: a line of light space, scaled so that `at` is the distance from it.
struct Node {
  double x, y, offset;
  Link sides[2];  ///< negative; zero and positive
  double at(double px, double py) const { return x * px + y * py + offset; }
};

/// Of the node that is added next.
inline Link next_link(const std::vector<Node>& nodes) {
  assert(nodes.size() < 0x7fffffff);  // 64 GiB of them
  return static_cast<Link>(nodes.size());
}

/// A point on its way down a tree.
struct Query {
  double x, y;
  const Node* nodes;
  Link link;  ///< the root, then the cell
  std::uint32_t pixel = 0;
};

/// Takes all of them to their cells, one node each in turn: the processor so has another node to wait for meanwhile, which
/// makes it twice as fast as one after the other. Adds the nodes on the way to `visits`.
template <std::size_t most>
void locate(std::span<Query> queries, std::uint64_t& visits) {
  std::uint8_t under_way[most];
  std::size_t count = 0;
  for (std::size_t i = 0; i < queries.size(); ++i) {
    under_way[count] = static_cast<std::uint8_t>(i);
    count += queries[i].link >= 0;
  }
  while (count > 0) {
    visits += count;
    std::size_t left = 0;
    for (std::size_t k = 0; k < count; ++k) {
      const std::uint8_t i = under_way[k];
      Query& query = queries[i];
      const Node& node = query.nodes[query.link];
      query.link = node.sides[node.at(query.x, query.y) >= 0];
      under_way[left] = i;
      left += query.link >= 0;
    }
    count = left;
  }
}

/// Where an edge of a polygon comes from.
enum EdgeMark : std::uint32_t {
  own_edge = 0,    ///< of the triangle itself, or where it meets another triangle's plane
  bsp_cut = 1,     ///< made by the regular BSP tree, as bsp.h marks it: on no shadow plane
  shadow_cut = 2,  ///< made by a node above: a shadow plane there would divide nothing
  shared_edge = 3  ///< found to lie on the plane of a node above: nor would it there
};

/// A link of the tree, by the node that it belongs to; the root has none.
struct Place {
  Link parent = -1;
  std::uint32_t side = 0;
};

/// Filters polygons down a tree.
class Filter {
 public:
  /// Calls visit(place, cell, fragment) for every part of a polygon that a cell holds. It may add to the tree below that cell.
  /// Edges found to lie on the plane of a node become shared ones. Returns how often planes cut the polygon; fragments that are
  /// nowhere farther than epsilon from a node's plane are dropped, and counted in `thin`.
  std::uint64_t run(const std::vector<Node>& nodes, Link root, std::span<const Corner> polygon, double epsilon,
                    std::uint64_t& thin, const auto& visit) {
    std::uint64_t cuts = 0;
    std::size_t first = 0, count = polygon.size();
    reserve(count);
    std::ranges::copy(polygon, corners_.begin());
    Place place;
    Link link = root;
    for (;;) {
      Lies lies = Lies::positive;
      while (link >= 0) {
        const Node& node = nodes[link];
        lies = classify({corners_.data() + first, count}, {{node.x, node.y, 0}, node.offset}, epsilon, values_.data());
        if (lies == Lies::within) break;
        place = {link, lies != Lies::negative};
        if (lies == Lies::across) {
          ++cuts;
          const std::size_t negative = first + count, positive = negative + count + 1;
          reserve(positive + count + 1);
          const CutCounts cut = cut_polygon({corners_.data() + first, count}, values_.data(), epsilon, shadow_cut,
                                            corners_.data() + negative, corners_.data() + positive);
          waiting_.push_back({{link, 0}, negative, cut.negative});
          first = positive;
          count = cut.positive;
        } else {
          mark_shared({corners_.data() + first, count}, epsilon);
        }
        link = node.sides[place.side];
      }
      if (lies == Lies::within)
        ++thin;
      else
        visit(place, link, std::span<const Corner>(corners_.data() + first, count));
      if (waiting_.empty()) return cuts;
      place = waiting_.back().place;
      first = waiting_.back().first;
      count = waiting_.back().count;
      waiting_.pop_back();
      link = nodes[place.parent].sides[place.side];
    }
  }

 private:
  /// A fragment on the other side of a plane; its corners lie above those of the ones that wait longer.
  struct Waiting {
    Place place;
    std::size_t first, count;
  };
  void reserve(std::size_t corners) {
    if (corners_.size() >= corners) return;
    corners_.resize(2 * corners);
    values_.resize(2 * corners);
  }
  void mark_shared(std::span<Corner> fragment, double epsilon) {
    bool is_on = std::abs(values_[0]) <= epsilon;
    const bool is_first_on = is_on;
    for (std::size_t i = 0; i < fragment.size(); ++i) {
      const bool is_next_on = i + 1 < fragment.size() ? std::abs(values_[i + 1]) <= epsilon : is_first_on;
      if (is_on && is_next_on && fragment[i].edge != shadow_cut) fragment[i].edge = shared_edge;
      is_on = is_next_on;
    }
  }

  std::vector<Corner> corners_;
  std::vector<double> values_;
  std::vector<Waiting> waiting_;
};

}  // namespace gnomon::svbsp
