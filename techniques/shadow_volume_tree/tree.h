#pragma once
#include <gnomon/kit/parallel.h>

#include <limits>
#include <span>
#include <vector>

#include "nodes.h"

namespace gnomon::shadow_volume_tree {

inline constexpr std::uint32_t none = 0xffffffffu;

/// Work of queries.
struct Tally {
  std::uint64_t queries = 0, visits = 0, longest_stack = 0;
  SignCounts signs;
  Tally& operator+=(const Tally& other) {
    queries += other.queries, visits += other.visits, signs += other.signs;
    longest_stack = std::max(longest_stack, other.longest_stack);
    return *this;
  }
};

/// A point that asks for its light, and what never occludes it: the casters exactly coplanar with its own triangle, or those of
/// its own mesh.
struct Asked {
  glm::vec3 point{0};
  std::uint32_t own_mesh = none;
  std::uint32_t own_triangle = none;  ///< counted over the scene
  glm::vec3 own[3] = {};              ///< its corners

  bool is_own(const Caster& caster) const {
    if (caster.triangle == own_triangle || caster.mesh == own_mesh) return true;
    const auto on_plane = [&](const glm::vec3& p) { return coplanar(own[0], own[1], own[2], p); };
    return own_triangle != none && on_plane(caster.corners[0]) && on_plane(caster.corners[1]) && on_plane(caster.corners[2]);
  }
};

/// Partitioned shadow volumes of casters and a light. The tree is that of inserting one caster after the other, but is made
/// from the root: the first caster takes its place, the rest go their ways from it, in order, and each way is a tree again. A
/// tree so has its nodes in a row, and ways are made side by side.
class Tree {
 public:
  /// Makes room for as many casters.
  void reserve(std::size_t casters) {
    groups_.resize(casters);
    ways_.resize(casters);
    nearest_.resize(casters);
    stack_.resize(casters);
    for (auto& list : casters_) list.resize(casters);
  }
  /// Where the next tree's casters are to be put, in order of insertion, counter-clockwise seen from the light.
  std::span<Caster> casters() { return casters_[0]; }
  /// The tree of the first `count` of them. On all threads; the outcome does not depend on their number. `early_out`: queries
  /// pass by trees that are farther from the light than the point; `wedge`: and by those of casters across a plane that all
  /// stay closer to the plane.
  void grow(std::size_t count, const Frame& frame, bool early_out, bool wedge);

  /// What a query needs from call to call.
  using Stack = std::vector<std::uint32_t>;
  Stack make_stack() const { return Stack(longest_stack() + 1); }
  /// The first caster found that occludes the point, counted over the scene, or `none`.
  std::uint32_t occluder(const Asked& asked, Stack& stack, Tally& tally) const;

  std::size_t triangles() const { return used_; }  ///< in the tree
  std::size_t depth() const { return depth_; }     ///< triangles on the longest way from the root
  const SignCounts& signs() const { return signs_; }
  std::size_t bytes() const {
    const auto held = [](const auto& v) { return v.capacity() * sizeof(v[0]); };
    return held(groups_) + held(ways_) + held(nearest_) + held(stack_) + held(casters_[0]) + held(casters_[1]);
  }

 private:
  struct Link {
    float nearest;        ///< no point nearer to the light is occluded there; no number where there is no tree
    std::uint32_t group;  ///< its root
  };
  /// The nodes of a caster.
  struct Group {
    Planes planes;
    Wedges wedges;
    Link links[way_count];
    std::uint32_t triangle;
    std::uint32_t mesh;
  };
  struct Task {
    std::uint32_t begin, count, depth;
    bool flipped;  ///< the casters are in the second list
  };
  struct Grown {
    std::size_t depth = 0, used = 0;
    SignCounts signs;
  };
  /// Places the first caster of a task and appends what remains as tasks.
  void split(const Task& task, bool on_all_threads, std::vector<Task>& rest, Grown& grown);
  /// Finishes a group whose trees are finished.
  void finish(std::uint32_t group, bool early_out, bool wedge);
  std::size_t longest_stack() const { return used_ == 0 ? 1 : std::max(stack_[0], 1u); }

  Frame frame_;
  std::vector<Group> groups_;         // a group's trees follow it; its caster is at the same place of casters_[0]
  std::vector<Caster> casters_[2];    // in turns
  std::vector<std::uint8_t> ways_;    // of each caster from the one that is being placed
  std::vector<float> nearest_;        // of each tree
  std::vector<std::uint32_t> stack_;  // most that waits while a query is in a tree
  std::size_t used_ = 0, depth_ = 0;
  SignCounts signs_;
};

inline void Tree::grow(std::size_t count, const Frame& frame, bool early_out, bool wedge) {
  frame_ = frame;
  Grown sum;
  const std::size_t large = std::max<std::size_t>(2048, count / 64);
  std::vector<Task> tasks, small, rest;
  std::vector<std::uint32_t> tops;
  if (count > 0) tasks.push_back({0, static_cast<std::uint32_t>(count), 1, false});
  while (!tasks.empty()) {
    const Task task = tasks.back();
    tasks.pop_back();
    if (task.count <= large) {
      small.push_back(task);
      continue;
    }
    rest.clear();
    split(task, true, rest, sum);
    tops.push_back(task.begin);
    tasks.insert(tasks.end(), rest.begin(), rest.end());
  }
  std::vector<Grown> grown(small.size());
  for_blocks(small.size(), 1, [&](std::size_t k, std::size_t) {
    const Task& whole = small[k];
    std::vector<Task> waiting{whole};
    while (!waiting.empty()) {
      const Task task = waiting.back();
      waiting.pop_back();
      split(task, false, waiting, grown[k]);
    }
    for (std::uint32_t i = whole.begin + whole.count; i-- > whole.begin;) finish(i, early_out, wedge);
  });
  std::ranges::sort(tops);
  while (!tops.empty()) finish(tops.back(), early_out, wedge), tops.pop_back();
  for (const Grown& g : grown) sum.depth = std::max(sum.depth, g.depth), sum.used += g.used, sum.signs += g.signs;
  used_ = sum.used, depth_ = sum.depth, signs_ = sum.signs;
}

inline void Tree::split(const Task& task, bool on_all_threads, std::vector<Task>& rest, Grown& grown) {
  const std::vector<Caster>& from = casters_[task.flipped];
  std::vector<Caster>& to = casters_[!task.flipped];
  const Caster placed = from[task.begin];
  casters_[0][task.begin] = placed;
  Group& group = groups_[task.begin];
  group.planes = Planes(placed, frame_);
  group.wedges = {};
  group.triangle = placed.triangle, group.mesh = placed.mesh;
  for (Link& link : group.links) link = {NAN, 0};
  nearest_[task.begin] = frame_.nearest(placed);
  ++grown.used;
  grown.depth = std::max<std::size_t>(grown.depth, task.depth);
  if (task.count == 1) return;

  // Count how many go each way, block by block, then deal them out: each keeps its order.
  constexpr std::size_t block = 4096;
  struct Dealt {
    std::uint32_t to[way_count + 1] = {};
    Wedges wedges;
    SignCounts signs;
  };
  const std::size_t first = task.begin + 1, size = task.count - 1, blocks = (size + block - 1) / block;
  Dealt one;
  std::vector<Dealt> many(blocks > 1 ? blocks : 0);
  Dealt* const dealt = blocks > 1 ? many.data() : &one;
  const float error = Planes::error(frame_.reach);
  const auto count_block = [&](std::size_t begin, std::size_t end) {
    Dealt& mine = dealt[begin / block];
    for (std::size_t i = first + begin; i < first + end; ++i) {
      const Way way = way_of(from[i], placed, group.planes, frame_, error, mine.wedges, mine.signs);
      ways_[i] = static_cast<std::uint8_t>(way);
      ++mine.to[way];
    }
  };
  const auto deal_block = [&](std::size_t begin, std::size_t end) {
    Dealt& mine = dealt[begin / block];
    for (std::size_t i = first + begin; i < first + end; ++i)
      if (ways_[i] != no_way) to[mine.to[ways_[i]]++] = from[i];
  };
  const auto for_all = [&](const auto& work) {
    if (on_all_threads) return for_blocks(size, block, work);
    for (std::size_t begin = 0; begin < size; begin += block) work(begin, std::min(size, begin + block));
  };
  for_all(count_block);
  auto next = static_cast<std::uint32_t>(first);
  for (unsigned way = 0; way < way_count; ++way) {
    const std::uint32_t begin = next;
    for (std::size_t b = 0; b < blocks; ++b) {
      const std::uint32_t count = dealt[b].to[way];
      dealt[b].to[way] = next;
      next += count;
    }
    if (next == begin) continue;
    group.links[way] = {0, begin};
    rest.push_back({begin, next - begin, task.depth + 1, !task.flipped});
  }
  for_all(deal_block);
  for (std::size_t b = 0; b < blocks; ++b) group.wedges.add(dealt[b].wedges), grown.signs += dealt[b].signs;
  for (std::size_t i = next; i < first + size; ++i) groups_[i].triangle = none;
}

// Ways are pushed in order, so that k - 1 others wait while a query is in the kth.
inline void Tree::finish(std::uint32_t place, bool early_out, bool wedge) {
  Group& group = groups_[place];
  if (group.triangle == none) return;
  std::uint32_t waiting = 0, most = 0;
  for (Link& link : group.links) {
    if (link.group == 0) continue;
    link.nearest = early_out ? nearest_[link.group] : -INFINITY;
    nearest_[place] = std::min(nearest_[place], nearest_[link.group]);
    most = std::max(most, waiting + stack_[link.group]);
    ++waiting;
  }
  stack_[place] = std::max(most, waiting);
  for (unsigned k = 0; k < 4; ++k)
    if ((!wedge || k == 3) && group.links[crosses_plane + 2 * k].group != 0)
      group.wedges.low[k] = -INFINITY, group.wedges.high[k] = INFINITY;
}

/// A point on a shadow plane looks at both sides of it: it is then shaded through an edge or vertex. A point on the capping
/// plane is not shaded by what is behind that, nor is one before it. A point behind it is, and done, unless the caster is its
/// own: then all of the caster's trees remain.
inline std::uint32_t Tree::occluder(const Asked& asked, Stack& stack, Tally& tally) const {
  ++tally.queries;
  if (used_ == 0) return none;
  const glm::vec3 p(glm::dvec3(asked.point) - glm::dvec3(frame_.center));
  const float error = Planes::error(std::max(frame_.reach, Frame::largest(p))), depth = frame_.farthest(asked.point),
              steepness = frame_.steepness(asked.point);
  const unsigned unknown = error < INFINITY && steepness < INFINITY ? 0 : 7;
  std::uint32_t* const waiting = stack.data();
  std::size_t size = 1, longest = 1;
  std::uint64_t visits = 0;
  waiting[0] = 0;
  std::uint32_t found = none;
  while (size > 0) {
    const std::uint32_t place = waiting[--size];
    const Group& group = groups_[place];
    const auto push = [&](unsigned way) {
      waiting[size] = group.links[way].group;
      size += depth >= group.links[way].nearest;
    };
    const Four values = group.planes.at(p);
    const unsigned inside = bits(values > error), outside = bits(values < -error);
    unsigned crossed = group.wedges.hold(values, error, steepness) | unknown, k = 0;
    for (; k < 3; ++k) {
      if (crossed >> k & 1) push(crosses_plane + 2 * k);
      if (inside >> k & 1) continue;
      if (outside >> k & 1) break;
      const int sign = exact_sign(casters_[0][place], k, asked.point, frame_, tally.signs);
      if (sign < 0) break;
      if (sign == 0) push(outside_plane + 2 * k);
    }
    visits += k + 1;
    if (k < 3) {
      push(outside_plane + 2 * k);
    } else {
      const bool is_own = group.triangle == asked.own_triangle || group.mesh == asked.own_mesh;
      bool is_behind = false;
      if (!is_own) {
        is_behind = outside >> 3 & 1;
        if (!is_behind && !(inside >> 3 & 1))
          is_behind = exact_sign(casters_[0][place], 3, asked.point, frame_, tally.signs) < 0;
        if (is_behind && !asked.is_own(casters_[0][place])) {
          found = group.triangle;
          break;
        }
      }
      push(crosses_cap);
      if (is_own || is_behind) push(behind_cap);
      push(before_cap);
    }
    longest = std::max(longest, size);
  }
  tally.visits += visits;
  tally.longest_stack = std::max<std::uint64_t>(tally.longest_stack, longest);
  return found;
}

}  // namespace gnomon::shadow_volume_tree
