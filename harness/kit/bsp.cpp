#include <gnomon/error.h>
#include <gnomon/kit/bsp.h>
#include <gnomon/kit/exact.h>
#include <gnomon/kit/parallel.h>
#include <tbb/parallel_for_each.h>

#include <deque>
#include <tuple>

#include "bsp_pieces.h"

namespace gnomon {

using namespace bsp;

/// A list of pieces becomes a node and two lists, and each list a tree. Large lists are tasks of their own, which threads take
/// as they come; the tree of a small one is made in one go. What is made depends on the lists alone.
struct Bsp::Builder {
  static constexpr std::size_t large = 8192;
  static constexpr std::size_t fewest_for_free_cuts = 48;

  struct Task {
    List<Piece> pieces;
    std::size_t depth = 1;
    bool with_free_cuts = false;
    Task* children[2] = {};
    // What it has made: its root first; nodes count from 0, and so do the polygons that they name.
    std::vector<Node> nodes;
    std::vector<Piece> sets;
    std::size_t splits = 0, deepest = 0, corners = 0;
    std::size_t first_node = 0, first_polygon = 0, first_corner = 0;  ///< in the whole tree
  };
  class Worker;

  const Scene& scene;
  const BspOptions& options;
  double epsilon;
  std::vector<std::uint32_t> first_triangle;  ///< of each mesh
  Arena arena;
  std::mutex mutex;
  std::deque<Task> tasks;

  Triangle triangle(const Piece& piece) const {
    if (!piece.corners) return {{glm::vec3(piece.corner(0)), glm::vec3(piece.corner(1)), glm::vec3(piece.corner(2))}};
    const auto after = std::ranges::upper_bound(first_triangle, piece.triangle);
    const Mesh& mesh = scene.meshes[static_cast<std::size_t>(after - first_triangle.begin()) - 1];
    const glm::uvec3& t = mesh.triangles[piece.triangle - after[-1]];
    return {{mesh.positions[t.x], mesh.positions[t.y], mesh.positions[t.z]}};
  }

  Task* add_task() {
    const std::scoped_lock lock(mutex);
    return &tasks.emplace_back();
  }

  List<Piece> all_triangles() const;
  void grow();
  void collect(Bsp& bsp);
};

/// Divides lists of pieces, one after the other.
class Bsp::Builder::Worker {
 public:
  Worker(Builder& builder, Task& task) : builder_(builder), task_(task), lot_(builder.arena) {}

  /// Chooses what divides a list of two pieces or more, and does it. The negative pieces are in the front of the list then, in
  /// order, and the positive ones in positive(). The rest is the node's set.
  std::size_t divide(std::span<Piece> list, bool with_free_cuts, Node& node) {
    node = {.plane = {}, .children = {none, none}, .first = static_cast<std::uint32_t>(task_.sets.size()), .count = 0};
    choose(list, with_free_cuts);
    const std::size_t negative = best_.axis < 0 ? part<false>(list) : part<true>(list);
    node.plane = best_.plane;
    node.count = static_cast<std::uint32_t>(task_.sets.size()) - node.first;
    return negative;
  }
  std::span<const Piece> positive() const { return {positive_.data(), positive_count_}; }
  List<Piece> take_positive() {
    positive_.resize(positive_count_);
    return std::move(positive_);
  }
  /// A free cut takes no piece away. One that hardly divides a list is followed by a plane that does, so that there is an end.
  bool may_cut_freely(std::size_t size, std::size_t of) const {
    return builder_.options.free_cuts && (best_.axis < 0 || 10 * size <= 9 * of);
  }

  /// Makes the tree of the task's list.
  void grow();

 private:
  /// Of a piece that lies across the divider values_ are those of its corners, unless it is only estimated; then a part may be
  /// said to lie across where its box does.
  template <bool is_free, bool is_estimate>
  [[gnu::always_inline]] Lies lies(const Piece& piece, const Divider& divider) {
    const double epsilon = builder_.epsilon;
    if constexpr (is_free) {
      const float low = piece.low(divider.axis), high = piece.high(divider.axis);
      if (high <= divider.place) return low == divider.place ? Lies::within : Lies::negative;
      if (low >= divider.place) return Lies::positive;
      if (is_estimate) return Lies::across;
    }
    if (!piece.corners) {
      const double a = divider.plane.at(piece.corner(0)), b = divider.plane.at(piece.corner(1)),
                   c = divider.plane.at(piece.corner(2));
      if (!is_estimate) values_[0] = a, values_[1] = b, values_[2] = c;
      const unsigned is_negative = (a < -epsilon) | (b < -epsilon) | (c < -epsilon),
                     is_positive = (a > epsilon) | (b > epsilon) | (c > epsilon);
      return static_cast<Lies>(is_negative | is_positive << 1);
    }
    if constexpr (!is_free) {
      const glm::dvec3& n = divider.plane.normal;
      double low = divider.plane.offset, high = low;
      for (int k = 0; k < 3; ++k) {
        low += n[k] * piece.at[n[k] > 0 ? k : 3 + k];
        high += n[k] * piece.at[n[k] > 0 ? 3 + k : k];
      }
      if (low > epsilon) return Lies::positive;
      if (high < -epsilon) return Lies::negative;
      if (is_estimate) return Lies::across;
    }
    if (values_.size() < piece.count) values_.resize(piece.count);
    return classify({piece.corners, piece.count}, divider.plane, epsilon, values_.data());
  }

  /// For pieces within epsilon: exactly in the plane, or on the side of their triangle. One that goes through another's plane
  /// there belongs to its set; it need not lie in a free cut that it goes through.
  Lies lies_exactly(const Piece& piece, const Divider& divider) const {
    const Triangle own = builder_.triangle(piece);
    int low = 1, high = -1;
    for (const glm::vec3& p : own.points) {
      const glm::vec3* const t = divider.triangle.points;
      const int sign = divider.axis < 0 ? orient3d_sign(t[0], t[1], t[2], p)
                                        : (p[divider.axis] > divider.place) - (p[divider.axis] < divider.place);
      low = std::min(low, sign), high = std::max(high, sign);
    }
    if (low >= 0 && high > 0) return Lies::positive;
    if (high <= 0 && low < 0) return Lies::negative;
    return low == 0 || divider.axis < 0 ? Lies::within : Lies::negative;
  }

  void choose(std::span<const Piece> list, bool with_free_cuts);
  /// Tries candidate_ on the sample; whether it is good enough to try no other one: no cuts, and fairly even sides.
  template <bool is_free>
  bool consider();
  /// Divides a list by best_.
  template <bool is_free>
  std::size_t part(std::span<Piece> list);
  void cut(const Piece& piece, Piece& negative, Piece& positive);

  Builder& builder_;
  Task& task_;
  Arena::Lot lot_;
  Divider best_, candidate_;
  std::tuple<std::size_t, std::size_t> least_;
  std::vector<const Piece*> sample_;
  std::vector<float> places_;
  List<Piece> positive_;
  std::size_t positive_count_ = 0;
  std::vector<double> values_ = std::vector<double>(8);
  std::vector<Corner> part_;
};

void Bsp::Builder::Worker::choose(std::span<const Piece> list, bool with_free_cuts) {
  const BspOptions& options = builder_.options;
  const std::size_t n = list.size();
  if (options.choice == BspOptions::Choice::first) {
    best_.owner = 0;
    set_plane(best_, builder_.triangle(list[0]));
    return;
  }
  // The middles of `count` equal shares of the list.
  const auto place = [&](std::size_t k, std::size_t count) { return (2 * k + 1) * n / (2 * count); };
  sample_.resize(std::min<std::size_t>(n, options.sample));
  for (std::size_t k = 0; k < sample_.size(); ++k) sample_[k] = &list[n > options.sample ? place(k, sample_.size()) : k];
  least_ = {std::numeric_limits<std::size_t>::max(), 0};
  const std::size_t candidates = std::min<std::size_t>(n, options.candidates);
  for (std::size_t k = 0; k < candidates; ++k) {
    candidate_.owner = place(k, candidates);
    set_plane(candidate_, builder_.triangle(list[candidate_.owner]));
    if (consider<false>()) return;
  }
  if (!with_free_cuts || n < fewest_for_free_cuts) return;
  // Through the lowest corners of pieces, which it does not cut.
  glm::vec3 low(INFINITY), high(-INFINITY);
  for (const Piece* const piece : sample_) {
    const glm::vec3 corner(piece->low(0), piece->low(1), piece->low(2));
    low = glm::min(low, corner), high = glm::max(high, corner);
  }
  const glm::vec3 size = high - low;
  for (int axis = 0; axis < 3; ++axis) {
    if (4 * size[axis] < std::max({size.x, size.y, size.z})) continue;
    places_.clear();
    for (const Piece* const piece : sample_) places_.push_back(piece->low(axis));
    const auto middle = places_.begin() + static_cast<std::ptrdiff_t>(places_.size() / 2);
    std::nth_element(places_.begin(), middle, places_.end());
    set_free_cut(candidate_, axis, *middle);
    if (consider<true>()) return;
  }
}

template <bool is_free>
bool Bsp::Builder::Worker::consider() {
  const bool is_balanced = builder_.options.choice == BspOptions::Choice::balanced;
  const std::size_t most_cuts = is_balanced ? std::get<0>(least_) / 8 : std::get<0>(least_);
  std::size_t counts[4] = {};
  for (const Piece* const piece : sample_) {
    ++counts[static_cast<unsigned>(lies<is_free, true>(*piece, candidate_))];
    if (counts[3] > most_cuts) return false;
  }
  const std::size_t imbalance = counts[1] > counts[2] ? counts[1] - counts[2] : counts[2] - counts[1];
  if (is_free && 2 * imbalance > sample_.size()) return false;
  // A node that holds no polygon costs something too: a quarter of the sample spared many cuts of triangle soups.
  const std::tuple score = is_balanced
                               ? std::tuple(8 * counts[3] + imbalance + (is_free ? sample_.size() / 4 : 0), std::size_t{0})
                               : std::tuple(counts[3], imbalance);
  if (score < least_) least_ = score, best_ = candidate_;
  return counts[3] == 0 && imbalance <= 1 + sample_.size() / 4;
}

void Bsp::Builder::Worker::cut(const Piece& piece, Piece& negative, Piece& positive) {
  Corner own[3];
  std::span<const Corner> polygon(piece.corners, piece.count);
  if (!piece.corners) {
    for (int k = 0; k < 3; ++k) own[k].at = piece.corner(k);
    polygon = own;
  }
  if (part_.size() <= polygon.size()) part_.resize(polygon.size() + 1);
  Corner* const room = lot_.reserve(2 * polygon.size() + 2);
  const CutCounts counts = cut_polygon(polygon, values_.data(), builder_.epsilon, 1, room, part_.data());
  std::copy_n(part_.data(), counts.positive, room + counts.negative);
  lot_.keep(counts.negative + counts.positive);
  const std::uint32_t triangle = piece.triangle;
  negative = piece_of(triangle, room, counts.negative);
  positive = piece_of(triangle, room + counts.negative, counts.positive);
  ++task_.splits;
}

template <bool is_free>
std::size_t Bsp::Builder::Worker::part(std::span<Piece> list) {
  std::size_t negative = 0, positive = 0;
  if (positive_.size() < list.size()) positive_.resize(list.size());
  for (std::size_t i = 0; i < list.size(); ++i) {
    const Piece& piece = list[i];
    Lies where = !is_free && i == best_.owner ? Lies::within : lies<is_free, false>(piece, best_);
    if (where == Lies::within && (is_free || i != best_.owner)) where = lies_exactly(piece, best_);
    switch (where) {
      case Lies::within:
        task_.sets.push_back(piece);
        task_.corners += piece.count;
        break;
      case Lies::negative:
        if (negative != i) list[negative] = piece;
        ++negative;
        break;
      case Lies::positive:
        positive_[positive++] = piece;
        break;
      case Lies::across:
        cut(piece, list[negative++], positive_[positive++]);
        break;
    }
  }
  positive_count_ = positive;
  return negative;
}

void Bsp::Builder::Worker::grow() {
  struct Part {
    std::size_t begin, depth;  ///< it reaches to the end of the list
    std::uint32_t parent;
    unsigned side;
    bool with_free_cuts;
  };
  List<Piece>& list = task_.pieces;
  std::vector<Part> parts{{0, task_.depth, none, 0, task_.with_free_cuts}};
  while (!parts.empty()) {
    const Part part = parts.back();
    parts.pop_back();
    const auto index = static_cast<std::uint32_t>(task_.nodes.size());
    if (part.parent != none) task_.nodes[part.parent].children[part.side] = index;
    task_.deepest = std::max(task_.deepest, part.depth);
    Node& node = task_.nodes.emplace_back();
    const std::size_t size = list.size() - part.begin;
    if (size == 1) {
      node = {.plane = {}, .children = {none, none}, .first = static_cast<std::uint32_t>(task_.sets.size()), .count = 1};
      task_.sets.push_back(list.back());
      task_.corners += list.back().count;
      list.pop_back();
      continue;
    }
    const std::size_t negative = divide(std::span(list).subspan(part.begin), part.with_free_cuts, node);
    list.resize(part.begin + negative);
    list.insert(list.end(), positive().begin(), positive().end());
    const auto next = [&](std::size_t begin, std::size_t count, unsigned side) {
      if (count > 0) parts.push_back({begin, part.depth + 1, index, side, may_cut_freely(count, size)});
    };
    next(part.begin, negative, 0);
    next(part.begin + negative, positive().size(), 1);
  }
}

Bsp::List<Piece> Bsp::Builder::all_triangles() const {
  List<Piece> pieces(scene.triangle_count());
  bool all_have_area = true;
  std::mutex mutex;
  for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
    const Mesh& mesh = scene.meshes[m];
    for_blocks(mesh.triangles.size(), 4096, [&](std::size_t begin, std::size_t end) {
      bool have_area = true;
      for (std::size_t i = begin; i < end; ++i) {
        const glm::uvec3& t = mesh.triangles[i];
        const auto index = first_triangle[m] + static_cast<std::uint32_t>(i);
        Piece& piece = pieces[index] = piece_of(index, mesh.positions[t.x], mesh.positions[t.y], mesh.positions[t.z]);
        if (normal_of(triangle(piece)) == glm::dvec3(0)) piece.count = 0, have_area = false;
      }
      if (have_area) return;
      const std::scoped_lock lock(mutex);
      all_have_area = false;
    });
  }
  if (!all_have_area) std::erase_if(pieces, [](const Piece& piece) { return piece.count == 0; });
  return pieces;
}

void Bsp::Builder::grow() {
  Task* const root = &tasks.emplace_back();
  root->pieces = all_triangles();
  root->with_free_cuts = options.free_cuts;
  if (root->pieces.empty()) return tasks.clear();
  tbb::parallel_for_each(&root, &root + 1, [&](Task* task, tbb::feeder<Task*>& feeder) {
    Worker worker(*this, *task);
    if (task->pieces.size() < large) {
      worker.grow();
      List<Piece>().swap(task->pieces);
      return;
    }
    const std::size_t size = task->pieces.size();
    const std::size_t negative = worker.divide(task->pieces, task->with_free_cuts, task->nodes.emplace_back());
    task->pieces.resize(negative);
    task->deepest = task->depth;
    for (unsigned side = 0; side < 2; ++side) {
      List<Piece> list = side == 0 ? std::move(task->pieces) : worker.take_positive();
      if (list.empty()) continue;
      Task* const child = add_task();
      child->with_free_cuts = worker.may_cut_freely(list.size(), size);
      child->pieces = std::move(list);
      child->depth = task->depth + 1;
      task->children[side] = child;
      feeder.add(child);
    }
  });
}

void Bsp::Builder::collect(Bsp& bsp) {
  std::vector<Task*> order, stack{&tasks.front()};
  std::size_t nodes = 0, polygons = 0, corners = 0;
  while (!stack.empty()) {
    Task* const task = stack.back();
    stack.pop_back();
    order.push_back(task);
    task->first_node = nodes, task->first_polygon = polygons, task->first_corner = corners;
    nodes += task->nodes.size(), polygons += task->sets.size(), corners += task->corners;
    bsp.split_count_ += task->splits;
    bsp.depth_ = std::max(bsp.depth_, task->deepest);
    for (Task* const child : {task->children[0], task->children[1]})
      if (child) stack.push_back(child);
  }
  if (nodes > none / 2 || corners > none)
    throw Error("a BSP tree of {} nodes and {} corners is beyond {} and {}", nodes, corners, none / 2, none);
  bsp.nodes_.resize(nodes), bsp.polygons_.resize(polygons), bsp.corners_.resize(corners);
  for_blocks(order.size(), 1, [&](std::size_t index, std::size_t) {
    Task& task = *order[index];
    const auto first_node = static_cast<std::uint32_t>(task.first_node);
    for (std::size_t i = 0; i < task.nodes.size(); ++i) {
      Node& node = bsp.nodes_[first_node + i] = task.nodes[i];
      node.first += static_cast<std::uint32_t>(task.first_polygon);
      for (unsigned side = 0; side < 2; ++side) {
        if (node.children[side] != none) node.children[side] += first_node;
        if (task.children[side]) node.children[side] = static_cast<std::uint32_t>(task.children[side]->first_node);
      }
    }
    auto corner = static_cast<std::uint32_t>(task.first_corner);
    for (std::size_t i = 0; i < task.sets.size(); ++i) {
      const Piece& piece = task.sets[i];
      bsp.polygons_[task.first_polygon + i] = {piece.triangle, corner, piece.count};
      for (std::uint32_t k = 0; k < piece.count; ++k)
        bsp.corners_[corner++] = piece.corners ? piece.corners[k] : Corner{piece.corner(static_cast<int>(k)), 0};
    }
    std::vector<Node>().swap(task.nodes);
    std::vector<Piece>().swap(task.sets);
  });
}

Bsp::Bsp(const Scene& scene, const BspOptions& options) {
  for (const auto& [name, value] : {std::pair("candidates", options.candidates), std::pair("sample", options.sample)})
    if (value == 0) throw Error("BspOptions::{} = 0 is outside 1 .. {}", name, none);
  const Bounds bounds = scene.bounds();
  if (bounds.empty()) return;
  const glm::vec3 largest = glm::max(glm::abs(bounds.min), glm::abs(bounds.max));
  epsilon_ = 1e-10 * std::max({largest.x, largest.y, largest.z});
  Builder builder{
      .scene = scene, .options = options, .epsilon = epsilon_, .first_triangle = {}, .arena = {}, .mutex = {}, .tasks = {}};
  std::uint32_t first = 0;
  for (const Mesh& mesh : scene.meshes) {
    builder.first_triangle.push_back(first);
    first += static_cast<std::uint32_t>(mesh.triangles.size());
  }
  builder.grow();
  if (!builder.tasks.empty()) builder.collect(*this);
}

}  // namespace gnomon
