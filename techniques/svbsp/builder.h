#pragma once
#include <gnomon/kit/add_up.h>

#include "pieces.h"

namespace gnomon::svbsp {

/// Edges without a shadow plane: own ones on the plane of a node above, and those made by cuts; the latter alone; or none. In
/// the order of svbsp.drop_edges.
enum class Drop { shared, cut, none };

/// How a tree is made.
struct Rules {
  Epsilons epsilon = {};
  Drop drop = Drop::shared;
  bool is_ordered = false;     ///< pieces come front to back: what reaches an IN cell is in shadow
  std::size_t tile_size = 16;  ///< pieces of a tile on average; those with more are split. 0: no tiles
  /// With more pieces in all tiles together, those behind one that covers the tile are left out before any tree is made.
  std::uint64_t very_many = 1 << 25;
  bool is_followed = false;  ///< the scene moves: tiles are made so that those where nothing moved can stay
  bool operator==(const Rules&) const = default;
};

/// Work of making a tree.
struct TreeWork {
  std::uint64_t planes = 0;                       ///< shadow planes
  std::uint64_t tile_cuts = 0;                    ///< of pieces by the borders of tiles
  std::uint64_t cuts = 0;                         ///< by shadow planes
  std::uint64_t crossings = 0;                    ///< by the plane of another triangle
  std::uint64_t lit = 0, shadowed = 0, thin = 0;  ///< fragments, when they reached their cells
  std::uint64_t hidden = 0;                       ///< pieces left out of tiles that nearer ones hide
  TreeWork& operator+=(const TreeWork& t) {
    using W = TreeWork;
    return add_up(*this, t, &W::planes, &W::tile_cuts, &W::cuts, &W::crossings, &W::lit, &W::shadowed, &W::thin, &W::hidden);
  }
};

/// On which side of another triangle's plane a fragment lies: positive is nearer to the light. Writes the corners' values, zero
/// for those within epsilon of the plane.
inline Lies lies_at(const ClipPlane& plane, const ProjectedSpace& space, std::span<const Corner> fragment, double epsilon,
                    double* values) {
  unsigned lies = 0;
  for (std::size_t i = 0; i < fragment.size(); ++i) {
    const double value = plane.at(fragment[i].at);
    values[i] = std::abs(value) <= epsilon * space.meter(fragment[i].at) ? 0 : value;
    lies |= static_cast<unsigned>(values[i] < 0) | static_cast<unsigned>(values[i] > 0) << 1;
  }
  return static_cast<Lies>(lies);
}

/// Adds polygons to the trees of one face. Every IN cell stores the triangle that is nearest to the light there, whose plane
/// bounds the cell: a later piece that lies before it takes its place there, so that pieces may come in any order.
template <class PlaneOf>
class Builder {
 public:
  /// plane_of(triangle) is a triangle's plane in light space.
  Builder(const ProjectedSpace& space, const Rules& rules, PlaneOf plane_of, std::vector<Node>& nodes, TreeWork& work)
      : space_(space), rules_(rules), plane_of_(plane_of), nodes_(nodes), work_(work) {}

  /// Starts a tree.
  void start() {
    out_count_ = 1;
    farthest_ = INFINITY;
  }
  /// Whether the tree's cells are all IN, and what is no nearer to the light than `nearest` is in shadow everywhere.
  bool hides(double nearest) const { return out_count_ == 0 && nearest <= farthest_; }

  /// `polygon` is the part of a triangle inside the tile of the tree at `root`.
  void add(std::span<const Corner> polygon, std::uint32_t triangle, Link& root) {
    work_.cuts += filter_.run(
        nodes_, root, polygon, rules_.epsilon.across, work_.thin,
        [&](const Place& place, Link cell, std::span<const Corner> fragment) { reach(place, cell, fragment, triangle, root); });
  }

 private:
  void reach(const Place& place, Link cell, std::span<const Corner> fragment, std::uint32_t triangle, Link& root) {
    if (!is_in_cell(cell)) return attach(place, cell, fragment, triangle, root);
    if (rules_.is_ordered) return void(++work_.shadowed);
    if (values_.size() < fragment.size()) {
      values_.resize(2 * fragment.size());
      parts_.resize(4 * fragment.size() + 2);
    }
    const Lies lies = lies_at(plane_of_(triangle_in(cell)), space_, fragment, rules_.epsilon.meters, values_.data());
    if (lies == Lies::positive) return attach(place, cell, fragment, triangle, root);
    ++work_.shadowed;
    if (lies != Lies::across) return;
    ++work_.crossings;
    Corner* const nearer = parts_.data() + fragment.size() + 1;
    const CutCounts cut = cut_polygon(fragment, values_.data(), 0, own_edge, parts_.data(), nearer);
    // A tip with no width: most of its edges would get no plane, and the rest bound far more than the tip.
    if (is_thin({nearer, cut.positive}, rules_.epsilon.across)) return void(++work_.thin);
    attach(place, cell, {nearer, cut.positive}, triangle, root);
  }

  /// One shadow plane for each edge: beyond it all stays as it was, inside the last one the triangle is nearest.
  void attach(Place place, Link cell, std::span<const Corner> fragment, std::uint32_t triangle, Link& root) {
    ++work_.lit;
    std::int64_t made_count = 0;
    const auto put = [&](Link link) { (place.parent < 0 ? root : nodes_[place.parent].sides[place.side]) = link; };
    for (std::size_t i = 0; i < fragment.size(); ++i) {
      const std::uint32_t mark = fragment[i].edge;
      if (rules_.drop != Drop::none && mark == shadow_cut) continue;
      if (rules_.drop == Drop::shared && mark == shared_edge) continue;
      const glm::dvec3 &a = fragment[i].at, &b = fragment[i + 1 < fragment.size() ? i + 1 : 0].at;
      const double x = a.y - b.y, y = b.x - a.x, length = std::sqrt(x * x + y * y);
      if (!(length > rules_.epsilon.across)) continue;
      const Link made = next_link(nodes_);
      // Beyond a cut lies the rest of the same triangle, beyond a plane above another cell: no way that rounding could leave
      // between the two stays open.
      const double beyond = mark == own_edge ? 0 : rules_.epsilon.across;
      nodes_.push_back({x / length, y / length, beyond - (x * a.x + y * a.y) / length, {cell, cell}});
      put(made);
      place = {made, 1};
      ++made_count;
    }
    put(in_cell(triangle));
    work_.planes += static_cast<std::uint64_t>(made_count);
    if (cell == out_cell) out_count_ += made_count - 1;
    for (const Corner& corner : fragment) farthest_ = std::min(farthest_, corner.at.z);
  }

  const ProjectedSpace& space_;
  const Rules& rules_;
  PlaneOf plane_of_;
  std::vector<Node>& nodes_;
  TreeWork& work_;
  Filter filter_;
  std::vector<double> values_;
  std::vector<Corner> parts_;
  std::int64_t out_count_ = 1;  // OUT cells of the tree
  double farthest_ = INFINITY;  // least z of a fragment of the tree
};

/// Splits a tile by lines in x or y through the middle of its pieces' centers, as long as that leaves fewer pieces in each
/// part, and makes a tree of each part. Where many pieces meet in one point no line helps, and the tile stays as it is.
template <class PlaneOf>
class Tiler {
 public:
  Tiler(const ProjectedSpace& space, const Rules& rules, PlaneOf plane_of, std::vector<Node>& nodes, TreeWork& work)
      : rules_(rules), nodes_(nodes), work_(work), builder_(space, rules, plane_of, nodes, work) {}

  /// The tree of a tile, from low to high, with the pieces whose indices are given.
  Link grow(std::span<const Piece> pieces, std::span<const std::uint32_t> indices, const glm::dvec2& low,
            const glm::dvec2& high) {
    pieces_ = pieces;
    items_.clear();
    for (const std::uint32_t i : indices) add({.piece = i, .low = pieces[i].low, .high = pieces[i].high}, low, high);
    return grow(0, items_.size(), low, high, 0);
  }

 private:
  /// A piece, the part of its bounds that lies in the tile, and how near to the light it comes there at most.
  struct Item {
    std::uint32_t piece = 0;
    glm::dvec2 low{0}, high{0};
    double nearest = 0;
  };
  static constexpr int deepest = 24;    ///< splits, each within the one before
  static constexpr double worth = 1.2;  ///< most items on both sides together, as a multiple of those before

  void add(Item item, const glm::dvec2& low, const glm::dvec2& high) {
    item.low = glm::max(item.low, low);
    item.high = glm::min(item.high, high);
    item.nearest = pieces_[item.piece].nearest(item.low, item.high);
    items_.push_back(item);
  }

  /// A line across an axis.
  struct Line {
    int axis = 0;
    double at = 0;
    std::size_t crossing = 0;
    bool divides = false;  ///< leaves items on either side
  };
  /// Through the middle of the items' boxes, across the axis where it crosses fewer.
  Line find_line(std::size_t begin, std::size_t end) const {
    glm::dvec2 sum(0);
    for (std::size_t i = begin; i < end; ++i) sum += items_[i].low + items_[i].high;
    Line lines[2];
    for (int axis = 0; axis < 2; ++axis) {
      Line& line = lines[axis];
      line.axis = axis;
      line.at = 0.5 * sum[axis] / static_cast<double>(end - begin);
      std::size_t below = 0, above = 0;
      for (std::size_t i = begin; i < end; ++i) {
        below += items_[i].high[axis] <= line.at;
        above += items_[i].low[axis] >= line.at;
      }
      line.crossing = end - begin - below - above;
      line.divides = below > 0 && above > 0;
    }
    if (lines[0].divides != lines[1].divides) return lines[lines[1].divides];
    return lines[lines[1].crossing < lines[0].crossing];
  }

  /// The tree of items begin .. end; these are the last ones.
  Link grow(std::size_t begin, std::size_t end, const glm::dvec2& low, const glm::dvec2& high, int depth) {
    const std::size_t count = end - begin;
    if (count <= rules_.tile_size || depth == deepest) return fill(begin, end, low, high);
    const Line line = find_line(begin, end);
    if (!line.divides || static_cast<double>(count + line.crossing) > worth * static_cast<double>(count))
      return fill(begin, end, low, high);
    const Link made = next_link(nodes_);
    nodes_.push_back({line.axis == 0 ? 1.0 : 0.0, line.axis == 1 ? 1.0 : 0.0, -line.at, {out_cell, out_cell}});
    for (unsigned side = 0; side < 2; ++side) {
      glm::dvec2 from = low, to = high;
      (side == 0 ? to : from)[line.axis] = line.at;
      for (std::size_t i = begin; i < end; ++i)
        if (side == 0 ? items_[i].low[line.axis] < line.at : items_[i].high[line.axis] > line.at)
          add(Item(items_[i]), from, to);
      const Link tree = grow(end, items_.size(), from, to, depth + 1);
      nodes_[made].sides[side] = tree;
      items_.resize(end);
    }
    return made;
  }

  /// Adds first what may be nearest to the light: little of what comes later is nearer then, and once the tile is hidden
  /// nothing.
  Link fill(std::size_t begin, std::size_t end, const glm::dvec2& low, const glm::dvec2& high) {
    std::sort(items_.begin() + static_cast<std::ptrdiff_t>(begin), items_.begin() + static_cast<std::ptrdiff_t>(end),
              [](const Item& a, const Item& b) { return a.nearest != b.nearest ? a.nearest > b.nearest : a.piece < b.piece; });
    Link root = out_cell;
    builder_.start();
    for (std::size_t i = begin; i < end; ++i) {
      if (builder_.hides(items_[i].nearest)) {
        work_.hidden += end - i;
        break;
      }
      if (clip(pieces_[items_[i].piece], low, high)) builder_.add(part_.corners(), pieces_[items_[i].piece].triangle, root);
    }
    return root;
  }

  /// Makes the part of a piece inside a tile. Returns whether there is one.
  bool clip(const Piece& piece, const glm::dvec2& low, const glm::dvec2& high) {
    part_.start(piece.polygon());
    return (!(piece.low.x < low.x) || cut_off({{1, 0, 0}, -low.x})) &&
           (!(piece.high.x > high.x) || cut_off({{-1, 0, 0}, high.x})) &&
           (!(piece.low.y < low.y) || cut_off({{0, 1, 0}, -low.y})) &&
           (!(piece.high.y > high.y) || cut_off({{0, -1, 0}, high.y}));
  }
  bool cut_off(const ClipPlane& line) {
    const Lies lies = part_.keep_positive(line, rules_.epsilon.across, shadow_cut);
    work_.tile_cuts += lies == Lies::across;
    return has_inside(lies);
  }

  const Rules& rules_;
  std::vector<Node>& nodes_;
  TreeWork& work_;
  Builder<PlaneOf> builder_;
  std::span<const Piece> pieces_;
  std::vector<Item> items_;
  Clipper part_;
};

}  // namespace gnomon::svbsp
