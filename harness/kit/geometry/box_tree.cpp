#include <gnomon/kit/geometry/box_tree.h>

#include <algorithm>
#include <array>
#include <numeric>

namespace gnomon {

namespace {

constexpr std::uint32_t leaf_size = 4;
constexpr int bin_count = 16;

/// Twice the center; in double, since the sum of two floats may overflow.
glm::dvec3 twice_center(const Bounds& b) { return glm::dvec3(b.min) + glm::dvec3(b.max); }

}  // namespace

double half_area(const Bounds& b) {
  if (b.empty()) return 0;
  const glm::dvec3 size = glm::dvec3(b.max) - glm::dvec3(b.min);
  return size.x * size.y + size.y * size.z + size.z * size.x;
}

/// Splits by the surface area heuristic (Goldsmith and Salmon 1987), evaluated between 16 bins of the centers per axis; in half
/// by count where the centers tell nothing apart.
struct BoxTree::Builder {
  std::span<const Bounds> items;
  BoxTree& tree;

  void build(std::uint32_t first, std::uint32_t last) {
    const std::size_t index = tree.nodes_.size();
    Bounds bounds;
    for (std::uint32_t i = first; i < last; ++i) bounds.add(items[tree.order_[i]]);
    Node node{{}, 0, first, 0};
    node.set(bounds);
    if (last - first <= leaf_size) node.count = last - first;
    tree.nodes_.push_back(node);
    if (node.count == 0) {
      const std::uint32_t middle = split(first, last);
      build(first, middle);
      build(middle, last);
    }
    tree.nodes_[index].skip = static_cast<std::uint32_t>(tree.nodes_.size());
  }

  /// Reorders first .. last and returns the start of the second part; neither part is empty.
  std::uint32_t split(std::uint32_t first, std::uint32_t last) {
    glm::dvec3 low(INFINITY), high(-INFINITY);
    for (std::uint32_t i = first; i < last; ++i) {
      const glm::dvec3 center = twice_center(items[tree.order_[i]]);
      low = glm::min(low, center);
      high = glm::max(high, center);
    }
    const auto bin_of = [&](std::uint32_t item, int axis) {
      const double place = (twice_center(items[item])[axis] - low[axis]) / (high[axis] - low[axis]);
      return std::min(static_cast<int>(place * bin_count), bin_count - 1);
    };
    double best_cost = INFINITY;
    int best_axis = -1, best_bin = 0;
    for (int axis = 0; axis < 3; ++axis) {
      if (!(high[axis] > low[axis])) continue;
      std::array<Bounds, bin_count> bounds;
      std::array<std::uint32_t, bin_count> count{};
      for (std::uint32_t i = first; i < last; ++i) {
        const int bin = bin_of(tree.order_[i], axis);
        bounds[bin].add(items[tree.order_[i]]);
        ++count[bin];
      }
      // Cost of the bins from `bin` on, for every bin; then sweep from the other side.
      std::array<double, bin_count> above{};
      Bounds sum;
      std::uint32_t total = 0;
      for (int bin = bin_count - 1; bin > 0; --bin) {
        sum.add(bounds[bin]);
        total += count[bin];
        above[bin] = half_area(sum) * total;
      }
      sum = {};
      total = 0;
      for (int bin = 1; bin < bin_count; ++bin) {
        sum.add(bounds[bin - 1]);
        total += count[bin - 1];
        if (total == 0 || total == last - first) continue;
        if (const double cost = half_area(sum) * total + above[bin]; cost < best_cost) {
          best_cost = cost;
          best_axis = axis;
          best_bin = bin;
        }
      }
    }
    if (best_axis < 0) return first + (last - first) / 2;
    const auto begin = tree.order_.begin();
    const auto middle =
        std::partition(begin + first, begin + last, [&](std::uint32_t item) { return bin_of(item, best_axis) < best_bin; });
    return static_cast<std::uint32_t>(middle - begin);
  }
};

BoxTree::BoxTree(std::span<const Bounds> items) : order_(items.size()) {
  std::iota(order_.begin(), order_.end(), 0u);
  nodes_.reserve(items.size());
  if (!items.empty()) Builder{items, *this}.build(0, static_cast<std::uint32_t>(items.size()));
}

double BoxTree::weighted_area() const {
  double sum = 0;
  for (const Node& node : nodes_) sum += half_area(node.bounds()) * (1 + node.count);
  return sum;
}

double BoxTree::cost() const {
  const double whole = half_area(bounds());
  return whole > 0 ? weighted_area() / whole : 0;
}

}  // namespace gnomon
