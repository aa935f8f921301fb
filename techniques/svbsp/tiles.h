#pragma once
#include "builder.h"

namespace gnomon::svbsp {

/// Splits a tile as long as that deals its pieces out, by lines in x or y through the middle of their centers, and makes a tree
/// of each part. Where many pieces meet in one point no line does, and the tile stays as it is.
template <class PlaneOf>
class Tiler {
 public:
  Tiler(const LightSpace& space, const Rules& rules, PlaneOf plane_of, std::vector<Node>& nodes, Tally& tally)
      : rules_(rules), nodes_(nodes), tally_(tally), builder_(space, rules, plane_of, nodes, tally) {}

  void clear() { corners_.clear(), items_.clear(); }
  /// Adds what a rectangle holds of a piece.
  void add(const Piece& piece, std::uint32_t index, const glm::dvec2& low, const glm::dvec2& high) {
    const std::size_t top = corners_.size();
    Item item{static_cast<std::uint32_t>(top), piece.count, index};
    corners_.insert(corners_.end(), piece.corners, piece.corners + piece.count);
    for (int axis = 0; axis < 2 && item.count > 0; ++axis) {
      if ((axis == 0 ? piece.x0 : piece.y0) < low[axis]) item = cut(item, axis, low[axis]).second;
      if (item.count > 0 && (axis == 0 ? piece.x1 : piece.y1) > high[axis]) item = cut(item, axis, high[axis]).first;
    }
    if (item.count > 0)
      items_.push_back(item);
    else
      corners_.resize(top);
  }
  /// The tree of all that was added.
  Link grow() { return grow(0, items_.size(), 0); }

  std::size_t bytes() const {
    return corners_.capacity() * sizeof(Corner) + items_.capacity() * sizeof(Item) + values_.capacity() * sizeof(double);
  }

 private:
  struct Item {
    std::uint32_t first, count, piece;
    double nearest = 0;
  };
  static constexpr int deepest = 24;    ///< splits; a tile is then 2^-12 of its cell, on either axis
  static constexpr double worth = 1.2;  ///< most items on both sides together, as a multiple of those before

  std::pair<Item, Item> cut(const Item& item, int axis, double at) {
    if (values_.size() < item.count) values_.resize(2 * item.count);
    glm::dvec3 normal(0);
    normal[axis] = 1;
    const std::span<const Corner> polygon{corners_.data() + item.first, item.count};
    const Lies lies = classify(polygon, {normal, -at}, rules_.epsilon.across, values_.data());
    Item low{0, 0, item.piece}, high = low;
    if (lies == Lies::negative) low = item;
    if (lies == Lies::positive) high = item;
    if (lies != Lies::across) return {low, high};
    ++tally_.tile_cuts;
    const std::size_t top = corners_.size();
    corners_.resize(top + 2 * (item.count + 1));
    const CutCounts counts = cut_polygon({corners_.data() + item.first, item.count}, values_.data(), rules_.epsilon.across,
                                         shadow_cut, corners_.data() + top, corners_.data() + top + item.count + 1);
    low.first = static_cast<std::uint32_t>(top), low.count = static_cast<std::uint32_t>(counts.negative);
    high.first = static_cast<std::uint32_t>(top + item.count + 1), high.count = static_cast<std::uint32_t>(counts.positive);
    return {low, high};
  }

  /// Of items begin .. end, the last ones.
  Link grow(std::size_t begin, std::size_t end, int depth) {
    const std::size_t count = end - begin;
    if (count <= rules_.tile_size || depth == deepest) return fill(begin, end);
    glm::dvec2 sum(0), low(INFINITY), high(-INFINITY);
    for (std::size_t i = begin; i < end; ++i) {
      glm::dvec2 center(0);
      for (std::uint32_t k = 0; k < items_[i].count; ++k) center += glm::dvec2(corners_[items_[i].first + k].at);
      center /= items_[i].count;
      sum += center, low = glm::min(low, center), high = glm::max(high, center);
    }
    const int axis = high.x - low.x >= high.y - low.y ? 0 : 1;
    const double at = sum[axis] / static_cast<double>(count);

    // Below side by side, then above.
    const std::size_t top = corners_.size();
    std::vector<Item> above;
    for (std::size_t i = begin; i < end; ++i) {
      const auto [below_it, above_it] = cut(Item(items_[i]), axis, at);
      if (below_it.count > 0) items_.push_back(below_it);
      if (above_it.count > 0) above.push_back(above_it);
    }
    const std::size_t below_count = items_.size() - end;
    Link made;
    if (static_cast<double>(below_count + above.size()) > worth * static_cast<double>(count)) {
      items_.resize(end);
      made = fill(begin, end);
    } else {
      made = static_cast<Link>(nodes_.size());
      nodes_.push_back({axis == 0 ? 1.0 : 0.0, axis == 1 ? 1.0 : 0.0, -at, {out_cell, out_cell}});
      const Link below_tree = grow(end, end + below_count, depth + 1);
      nodes_[made].sides[0] = below_tree;
      items_.resize(end);
      items_.insert(items_.end(), above.begin(), above.end());
      const Link above_tree = grow(end, items_.size(), depth + 1);
      nodes_[made].sides[1] = above_tree;
      items_.resize(end);
    }
    corners_.resize(top);
    return made;
  }

  /// The nearest ones first, so that little of what comes later is nearer.
  Link fill(std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      double nearest = -INFINITY;
      for (std::uint32_t k = 0; k < items_[i].count; ++k) nearest = std::max(nearest, corners_[items_[i].first + k].at.z);
      items_[i].nearest = nearest;
    }
    std::sort(items_.begin() + static_cast<std::ptrdiff_t>(begin), items_.begin() + static_cast<std::ptrdiff_t>(end),
              [](const Item& a, const Item& b) { return a.nearest != b.nearest ? a.nearest > b.nearest : a.piece < b.piece; });
    Link root = out_cell;
    builder_.start();
    for (std::size_t i = begin; i < end; ++i) {
      if (builder_.hides(items_[i].nearest)) {
        tally_.shadowed += end - i;
        break;
      }
      builder_.add({corners_.data() + items_[i].first, items_[i].count}, items_[i].piece, root);
    }
    return root;
  }

  const Rules& rules_;
  std::vector<Node>& nodes_;
  Tally& tally_;
  Builder<PlaneOf> builder_;
  std::vector<Corner> corners_;
  std::vector<Item> items_;
  std::vector<double> values_;
};

}  // namespace gnomon::svbsp
