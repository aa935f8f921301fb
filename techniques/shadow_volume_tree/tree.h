#pragma once
#include <gnomon/kit/geometry/crossings.h>
#include <gnomon/kit/geometry/receiver.h>
#include <gnomon/kit/parallel.h>

#include <functional>
#include <utility>

#include "nodes.h"

namespace gnomon::shadow_volume_tree {

inline constexpr std::uint32_t none = 0xffffffffu;

/// The larger casters before the smaller ones, in classes by their longest edges, each four times as long as the next; within a
/// class in the order they came in. Where a large caster lies across a plane, the whole tree of that plane is visited from
/// everywhere; so it gets its own place before there are many planes.
inline void put_large_first(std::vector<Caster>& casters) {
  constexpr int smallest = -300, count = (300 + 260) / 4;  // squares of float32 lengths are 2^-298 .. 2^259
  std::vector<std::uint8_t> classes(casters.size());
  for_blocks(casters.size(), 8192, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const double square = longest_edge_squared(casters[i].points);
      classes[i] = static_cast<std::uint8_t>(count - 1 - (std::clamp(std::ilogb(square), smallest, 259) - smallest) / 4);
    }
  });
  std::size_t next[count + 1] = {};
  for (const std::uint8_t c : classes) ++next[c + 1];
  for (int c = 0; c < count; ++c) next[c + 1] += next[c];
  std::vector<Caster> sorted(casters.size());
  for (std::size_t i = 0; i < casters.size(); ++i) sorted[next[classes[i]]++] = casters[i];
  casters = std::move(sorted);
}

/// Work of queries, and what they need from one to the next.
struct QueryWork {
  std::vector<std::uint32_t> stack;  ///< room for Tree::longest_stack()
  std::uint64_t queries = 0, visits = 0, longest_stack = 0;
  SignCounts signs;
  Crossings glass;  ///< of the last query
  QueryWork& operator+=(const QueryWork& other) {
    longest_stack = std::max(longest_stack, other.longest_stack);
    return add_up(*this, other, &QueryWork::queries, &QueryWork::visits, &QueryWork::signs);
  }
};

/// How many casters of a block go each way; then the place of the next one of each way.
struct BlockWays {
  std::uint32_t to[way_count + 1] = {};
  Wedges wedges;
  SignCounts signs;
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
  void grow(std::size_t count, const Frame& frame, bool early_out, bool wedge) {
    frame_ = frame;
    grown_ = {};
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
      split(task, true, rest, grown_);
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
    std::ranges::sort(tops, std::greater());
    for (const std::uint32_t top : tops) finish(top, early_out, wedge);
    for (const Grown& g : grown) {
      grown_.depth = std::max(grown_.depth, g.depth);
      grown_.used += g.used;
      grown_.signs += g.signs;
    }
  }

  /// To start queries with.
  QueryWork make_work() const { return {.stack = std::vector<std::uint32_t>(longest_stack() + 1), .signs = {}, .glass = {}}; }
  /// The first opaque caster found that shades the point, counted over the scene, or `none`. `work.glass` becomes the casters
  /// with transmission that the way to the light crosses; where an opaque one is found, some. `numbers` are those of the scene
  /// where a caster has holes or transmission.
  ///
  /// A query of a point on a shadow plane visits both sides: the point is then shaded through an edge or vertex. A caster
  /// shades neither a point on its capping plane nor one before it. It shades a point behind that plane, and the query ends,
  /// unless the caster is the point's own, of glass, or the way goes through a hole of it: then all of the caster's trees
  /// remain.
  std::uint32_t shading_triangle(const Scene& scene, const NumberedReceiver& receiver, QueryWork& work,
                                 const TriangleNumbers& numbers = {}) const {
    ++work.queries;
    work.glass.clear();
    if (grown_.used == 0) return none;
    const glm::vec3 p(glm::dvec3(receiver.point) - glm::dvec3(frame_.center));
    const float error = Planes::error(std::max(frame_.reach, Frame::largest(p))), depth = frame_.farthest(receiver.point),
                steepness = frame_.steepness(receiver.point);
    const unsigned unknown = error < INFINITY && steepness < INFINITY ? 0 : 7;
    std::uint32_t* const waiting = work.stack.data();
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
        const int sign = exact_sign(casters_[0][place], k, receiver.point, frame_, work.signs);
        if (sign < 0) break;
        if (sign == 0) push(outside_plane + 2 * k);
      }
      visits += k + 1;
      if (k < 3) {
        push(outside_plane + 2 * k);
      } else {
        const bool is_own = receiver.is_own(group.triangle);
        bool is_behind = false;
        if (!is_own) {
          is_behind = outside >> 3 & 1;
          if (!is_behind && !(inside >> 3 & 1))
            is_behind = exact_sign(casters_[0][place], 3, receiver.point, frame_, work.signs) < 0;
          if (is_behind && !receiver.is_coplanar(scene, casters_[0][place].points) &&
              (casters_[0][place].mesh != no_mesh || blocks(scene, numbers, casters_[0][place], receiver.point, work.glass))) {
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
    work.visits += visits;
    work.longest_stack = std::max<std::uint64_t>(work.longest_stack, longest);
    return found;
  }

  std::size_t triangles() const { return grown_.used; }  ///< in the tree
  std::size_t depth() const { return grown_.depth; }     ///< triangles on the longest way from the root
  const SignCounts& signs() const { return grown_.signs; }
  std::size_t bytes() const { return bytes_of(groups_, ways_, nearest_, stack_, casters_[0], casters_[1]); }

 private:
  /// Whether a caster that the way from a point to the light crosses, with holes or transmission, is solid and opaque there;
  /// solid glass joins the others. Apart from the loop of queries, which is slower with it inside.
  [[gnu::noinline]] bool blocks(const Scene& scene, const TriangleNumbers& numbers, const Caster& caster,
                                const glm::vec3& point, Crossings& glass) const {
    const std::uint32_t mesh = numbers.mesh_of(caster.triangle), triangle = caster.triangle - numbers.first_of(mesh);
    if (!is_solid_at(scene.meshes[mesh], triangle, {point, frame_.light})) return false;
    if (!scene.meshes[mesh].transmission) return true;
    glass.add(mesh, triangle);
    return false;
  }

  struct Link {
    float nearest;        ///< no point nearer to the light is in shadow there; not a number where there is no tree
    std::uint32_t group;  ///< its root
  };
  /// The nodes of a caster.
  struct Group {
    Planes planes;
    Wedges wedges;
    Link links[way_count];
    std::uint32_t triangle;
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
  void split(const Task& task, bool on_all_threads, std::vector<Task>& rest, Grown& grown) {
    const std::vector<Caster>& from = casters_[task.flipped];
    std::vector<Caster>& to = casters_[!task.flipped];
    const Caster placed = from[task.begin];
    casters_[0][task.begin] = placed;
    Group& group = groups_[task.begin];
    group.planes = Planes(placed, frame_);
    group.wedges = {};
    group.triangle = placed.triangle;
    for (Link& link : group.links) link = {NAN, 0};
    nearest_[task.begin] = frame_.nearest(placed);
    ++grown.used;
    grown.depth = std::max<std::size_t>(grown.depth, task.depth);
    if (task.count == 1) return;

    // Count how many go each way, block by block, then move them there: each way keeps their order.
    constexpr std::size_t block = 4096;
    const std::size_t first = task.begin + 1, size = task.count - 1, block_count = (size + block - 1) / block;
    BlockWays one;
    std::vector<BlockWays> many(block_count > 1 ? block_count : 0);
    const std::span<BlockWays> blocks = block_count > 1 ? std::span(many) : std::span(&one, 1);
    const float error = Planes::error(frame_.reach);
    const auto for_all = [&](const auto& work) {
      if (on_all_threads) return for_blocks(size, block, work);
      for (std::size_t begin = 0; begin < size; begin += block) work(begin, std::min(size, begin + block));
    };
    for_all([&](std::size_t begin, std::size_t end) {
      BlockWays& mine = blocks[begin / block];
      for (std::size_t i = first + begin; i < first + end; ++i) {
        const Way way = way_of(from[i], placed, group.planes, frame_, error, mine.wedges, mine.signs);
        ways_[i] = static_cast<std::uint8_t>(way);
        ++mine.to[way];
      }
    });
    auto next = static_cast<std::uint32_t>(first);
    for (unsigned way = 0; way < way_count; ++way) {
      const std::uint32_t begin = next;
      for (BlockWays& ways : blocks) next += std::exchange(ways.to[way], next);
      if (next == begin) continue;
      group.links[way] = {0, begin};
      rest.push_back({begin, next - begin, task.depth + 1, !task.flipped});
    }
    for_all([&](std::size_t begin, std::size_t end) {
      BlockWays& mine = blocks[begin / block];
      for (std::size_t i = first + begin; i < first + end; ++i)
        if (ways_[i] != no_way) to[mine.to[ways_[i]]++] = from[i];
    });
    for (const BlockWays& ways : blocks) {
      group.wedges.add(ways.wedges);
      grown.signs += ways.signs;
    }
    for (std::size_t i = next; i < first + size; ++i) groups_[i].triangle = none;
  }

  /// Finishes a group whose trees are finished. Ways are pushed in order: k - 1 others wait while a query is in the kth.
  void finish(std::uint32_t place, bool early_out, bool wedge) {
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
      if ((!wedge || k == 3) && group.links[crosses_plane + 2 * k].group != 0) {
        group.wedges.low[k] = -INFINITY;
        group.wedges.high[k] = INFINITY;
      }
  }

  std::size_t longest_stack() const { return grown_.used == 0 ? 1 : std::max(stack_[0], 1u); }

  Frame frame_;
  std::vector<Group> groups_;         // a group's trees follow it; its caster is at the same place of casters_[0]
  std::vector<Caster> casters_[2];    // in turns
  std::vector<std::uint8_t> ways_;    // of each caster from the one that is being placed
  std::vector<float> nearest_;        // of each tree
  std::vector<std::uint32_t> stack_;  // most that waits while a query is in a tree
  Grown grown_;
};

}  // namespace gnomon::shadow_volume_tree
