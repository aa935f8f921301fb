#pragma once
#include "builder.h"

namespace gnomon::svbsp {

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

  /// Makes the part of a piece that a tile holds; says whether there is one.
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
