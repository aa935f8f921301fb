#include "box_nodes.h"

#include <gnomon/kit/geometry/box_tree.h>
#include <gnomon/kit/parallel.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace gnomon::gl_rays {

namespace {

constexpr int bin_count = 16;
/// Deeper, nodes are split by count: no input makes a recursion deep.
constexpr int most_levels = 48;
/// Items of a subtree that one thread builds, at least.
constexpr std::uint32_t least_task = 4096;

struct Item {
  Bounds box;
  std::uint32_t number;
  /// Twice its center.
  glm::vec3 center() const { return box.min + box.max; }
};

/// Items first .. last, and what is around them.
struct Range {
  std::uint32_t first, last;
  int level;
  std::uint32_t count() const { return last - first; }
};

/// Where to split a node.
struct Split {
  double cost = INFINITY;  ///< sum of the half areas of both boxes, each times 1 plus its items
  int axis = -1;           ///< -1: centers tell nothing apart
  int bin = 0;             ///< the first one of the second part
};

/// Bins of the centers along three axes.
class Bins {
 public:
  Bins(std::span<const Item> items, const Bounds& centers) : low_(centers.min) {
    const glm::vec3 size = centers.max - centers.min;
    for (int axis = 0; axis < 3; ++axis) {
      const float scale = bin_count / size[axis];
      scale_[axis] = size[axis] > 0 && std::isfinite(scale) ? scale : 0;
    }
    for (const Item& item : items)
      for (int axis = 0; axis < 3; ++axis) {
        const int bin = bin_of(item, axis);
        boxes_[axis][bin].add(item.box);
        ++counts_[axis][bin];
      }
  }
  int bin_of(const Item& item, int axis) const {
    return std::min(static_cast<int>((item.center()[axis] - low_[axis]) * scale_[axis]), bin_count - 1);
  }
  Split best(std::uint32_t count) const {
    Split best;
    for (int axis = 0; axis < 3; ++axis)
      if (scale_[axis] > 0) improve(best, axis, count);
    return best;
  }

 private:
  void improve(Split& best, int axis, std::uint32_t count) const {
    // Cost of the bins from `bin` on, for each; then a sweep from the other side.
    std::array<double, bin_count> above{};
    Bounds box;
    std::uint32_t sum = 0;
    for (int bin = bin_count - 1; bin > 0; --bin) {
      box.add(boxes_[axis][bin]);
      sum += counts_[axis][bin];
      above[bin] = half_area(box) * (1 + sum);
    }
    box = {};
    sum = 0;
    for (int bin = 1; bin < bin_count; ++bin) {
      box.add(boxes_[axis][bin - 1]);
      sum += counts_[axis][bin - 1];
      if (sum == 0 || sum == count) continue;
      if (const double cost = half_area(box) * (1 + sum) + above[bin]; cost < best.cost) best = {cost, axis, bin};
    }
  }

  glm::vec3 low_, scale_{0};
  std::array<std::array<Bounds, bin_count>, 3> boxes_;
  std::array<std::array<std::uint32_t, bin_count>, 3> counts_{};
};

class Builder {
 public:
  explicit Builder(std::span<Item> items) : items_(items) {}

  /// Appends the tree over a range; `skip` of each node is how many nodes are below it and itself. A range for which
  /// `is_left(range, index)` says so gets one node, whose subtree others build.
  template <class IsLeft>
  void build(const Range& range, std::vector<Node>& nodes, const IsLeft& is_left) const {
    const std::size_t index = nodes.size();
    nodes.emplace_back();
    if (is_left(range, index)) return;
    const std::span<Item> items = items_.subspan(range.first, range.count());
    Bounds box, centers;
    for (const Item& item : items) {
      box.add(item.box);
      centers.add(item.center());
    }
    nodes[index].low = box.min;
    nodes[index].high = box.max;
    if (const std::uint32_t middle = range.first + parted(items, box, centers, range.level); middle != range.first) {
      build({range.first, middle, range.level + 1}, nodes, is_left);
      build({middle, range.last, range.level + 1}, nodes, is_left);
    } else {
      nodes[index].leaf = static_cast<std::int32_t>(16 * range.first + range.count());
    }
    nodes[index].skip = static_cast<std::int32_t>(nodes.size() - index);
  }

 private:
  /// Reorders items so that the first ones, as many as it says, are the first child's; 0: they are a leaf.
  static std::uint32_t parted(std::span<Item> items, const Bounds& box, const Bounds& centers, int level) {
    const auto count = static_cast<std::uint32_t>(items.size());
    if (count == 1) return 0;
    const Bins bins(items, centers);
    const Split split = level < most_levels ? bins.best(count) : Split();
    if (count <= leaf_size && half_area(box) * count <= split.cost) return 0;
    if (split.axis < 0) return count / 2;
    const auto second =
        std::partition(items.begin(), items.end(), [&](const Item& item) { return bins.bin_of(item, split.axis) < split.bin; });
    return static_cast<std::uint32_t>(second - items.begin());
  }

  std::span<Item> items_;
};

/// A subtree that one thread builds.
struct Task {
  Range range;
  std::size_t node;  ///< its place among the nodes of the top
  std::vector<Node> nodes = {};
};

/// All nodes in order: those of the top, and in place of each one that stands for a task those of the task.
std::vector<Node> joined(std::vector<Node> top, std::span<Task> tasks) {
  constexpr std::size_t none = std::numeric_limits<std::size_t>::max();
  std::vector<std::size_t> task_of(top.size(), none);
  for (std::size_t k = 0; k < tasks.size(); ++k) task_of[tasks[k].node] = k;
  // From behind, so that what is below a node is known before it.
  std::vector<std::int32_t> sizes(top.size());
  for (std::size_t i = top.size(); i-- > 0;)
    sizes[i] = task_of[i] != none ? static_cast<std::int32_t>(tasks[task_of[i]].nodes.size())
                                  : 1 + sizes[i + 1] + sizes[i + 1 + static_cast<std::size_t>(top[i + 1].skip)];
  std::vector<Node> nodes;
  nodes.reserve(static_cast<std::size_t>(sizes[0]));
  for (std::size_t i = 0; i < top.size(); ++i) {
    if (task_of[i] == none) {
      top[i].skip = sizes[i];
      nodes.push_back(top[i]);
    } else {
      const std::vector<Node> built = std::move(tasks[task_of[i]].nodes);
      nodes.insert(nodes.end(), built.begin(), built.end());
    }
  }
  for (std::size_t i = 0; i < nodes.size(); ++i) nodes[i].skip += static_cast<std::int32_t>(i);
  return nodes;
}

}  // namespace

BoxNodes build_nodes(std::span<const Bounds> boxes) {
  if (boxes.empty()) return {};
  std::vector<Item> items(boxes.size());
  for (std::uint32_t i = 0; i < items.size(); ++i) items[i] = {boxes[i], i};
  const Builder builder(items);
  const auto count = static_cast<std::uint32_t>(items.size()), most = std::max(count / 16, least_task);
  std::vector<Node> top;
  std::vector<Task> tasks;
  builder.build({0, count, 0}, top, [&](const Range& range, std::size_t index) {
    if (range.count() > most) return false;
    tasks.push_back({range, index});
    top[index].skip = 1;
    return true;
  });
  for_blocks(tasks.size(), 1, [&](std::size_t k, std::size_t) {
    tasks[k].nodes.reserve(2 * tasks[k].range.count());
    builder.build(tasks[k].range, tasks[k].nodes, [](const Range&, std::size_t) { return false; });
  });
  BoxNodes tree{joined(std::move(top), tasks), {}};
  tree.order.reserve(items.size());
  for (const Item& item : items) tree.order.push_back(item.number);
  return tree;
}

double cost(std::span<const Node> nodes) {
  if (nodes.empty()) return 0;
  const double whole = half_area(nodes[0].box());
  double sum = 0;
  for (const Node& node : nodes) sum += half_area(node.box()) * (1 + (node.is_leaf() ? node.count() : 0));
  return whole > 0 ? sum / whole : 0;
}

}  // namespace gnomon::gl_rays
