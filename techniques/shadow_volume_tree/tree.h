#pragma once
#include <gnomon/kit/geometry/receiver.h>

#include <limits>
#include <span>
#include <vector>

#include "nodes.h"

namespace gnomon::shadow_volume_tree {

inline constexpr std::uint32_t none = 0xffffffffu;

/// The larger casters before the smaller ones, in classes by their longest edges, each four times as long as the next; within a
/// class in the order they came in. Where a large caster lies across a plane, the whole tree of that plane is visited from
/// everywhere; so it gets its own place before there are many planes.
void put_large_first(std::vector<Caster>& casters);

/// Work of queries, and what they need from one to the next.
struct QueryWork {
  std::vector<std::uint32_t> stack;  ///< room for Tree::longest_stack()
  std::uint64_t queries = 0, visits = 0, longest_stack = 0;
  SignCounts signs;
  QueryWork& operator+=(const QueryWork& other) {
    queries += other.queries;
    visits += other.visits;
    signs += other.signs;
    longest_stack = std::max(longest_stack, other.longest_stack);
    return *this;
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

  /// To start queries with.
  QueryWork make_work() const { return {.stack = std::vector<std::uint32_t>(longest_stack() + 1), .signs = {}}; }
  /// The first caster found that shades the point, counted over the scene, or `none`.
  std::uint32_t shading_triangle(const Scene& scene, const NumberedReceiver& receiver, QueryWork& work) const;

  std::size_t triangles() const { return used_; }  ///< in the tree
  std::size_t depth() const { return depth_; }     ///< triangles on the longest way from the root
  const SignCounts& signs() const { return signs_; }
  std::size_t bytes() const { return bytes_of(groups_, ways_, nearest_, stack_, casters_[0], casters_[1]); }

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

}  // namespace gnomon::shadow_volume_tree
