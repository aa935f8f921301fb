#include "bsp.h"

#include <gnomon/error.h>
#include <gnomon/kit/parallel.h>

#include <atomic>
#include <deque>

#include "bsp_dividing.h"

namespace gnomon::svbsp {

using bsp::Arena, bsp::Dividing, bsp::Source, bsp::normal_of, bsp::piece_of;

/// A list of pieces becomes a node and two lists, and each list a tree. Large lists are tasks of their own, which threads take
/// as they come; the tree of a small one is made in one go. What is made depends on the lists alone.
struct Bsp::Builder {
  static constexpr std::size_t large = 8192;

  struct Task {
    UnsetVector<bsp::Piece> pieces;
    std::size_t depth = 1;
    bool with_free_cuts = false;
    Task* children[2] = {};
    // What it has made, its root first; children and polygons count from 0.
    std::vector<Node> nodes;
    std::vector<bsp::Piece> polygons;
    std::size_t cuts = 0, deepest = 0, corners = 0;
    std::size_t first_node = 0, first_polygon = 0, first_corner = 0;  ///< in the whole tree
  };

  Source source;
  Arena arena;
  std::mutex mutex;
  std::deque<Task> tasks;  ///< the root first

  Task* add_task() {
    const std::scoped_lock lock(mutex);
    return &tasks.emplace_back();
  }

  /// Those with an area.
  UnsetVector<bsp::Piece> all_triangles() const {
    UnsetVector<bsp::Piece> pieces(source.scene.triangle_count());
    std::atomic<bool> all_have_area = true;
    for (std::size_t m = 0; m < source.scene.meshes.size(); ++m) {
      const Mesh& mesh = source.scene.meshes[m];
      for_blocks(mesh.triangles.size(), 4096, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
          const Triangle triangle = mesh.corners(i);
          const auto index = source.numbers.first_of(m) + static_cast<std::uint32_t>(i);
          pieces[index] = piece_of(index, triangle);
          if (normal_of(triangle) == glm::dvec3(0)) {
            pieces[index].count = 0;
            all_have_area = false;
          }
        }
      });
    }
    if (!all_have_area) std::erase_if(pieces, [](const bsp::Piece& piece) { return piece.count == 0; });
    return pieces;
  }

  /// Makes the next node of a task, of the last pieces of its list, from `begin` on. The list ends with the negative pieces
  /// then.
  static void add_node(Task& task, std::size_t begin, bool with_free_cuts, Dividing& dividing) {
    Node& node = task.nodes.emplace_back();
    node = {.plane = {}, .children = {none, none}, .first = static_cast<std::uint32_t>(task.polygons.size()), .count = 0};
    const std::span<bsp::Piece> list = std::span(task.pieces).subspan(begin);
    const std::size_t negative = dividing.divide(list, with_free_cuts, task.polygons);
    task.pieces.resize(begin + negative);
    node.plane = dividing.plane();
    node.count = static_cast<std::uint32_t>(task.polygons.size()) - node.first;
  }

  static void grow_whole(Task& task, Dividing& dividing) {
    struct Part {
      std::size_t begin, depth;  ///< it reaches to the end of the list
      std::uint32_t parent;
      unsigned side;
      bool with_free_cuts;
    };
    UnsetVector<bsp::Piece>& list = task.pieces;
    task.nodes.reserve(list.size() + list.size() / 8);
    task.polygons.reserve(list.size() + list.size() / 8);
    std::vector<Part> parts{{0, task.depth, none, 0, task.with_free_cuts}};
    while (!parts.empty()) {
      const Part part = parts.back();
      parts.pop_back();
      const auto index = static_cast<std::uint32_t>(task.nodes.size());
      if (part.parent != none) task.nodes[part.parent].children[part.side] = index;
      task.deepest = std::max(task.deepest, part.depth);
      const std::size_t size = list.size() - part.begin;
      if (size == 1) {
        const auto first = static_cast<std::uint32_t>(task.polygons.size());
        task.nodes.push_back({.plane = {}, .children = {none, none}, .first = first, .count = 1});
        task.polygons.push_back(list.back());
        list.pop_back();
        continue;
      }
      add_node(task, part.begin, part.with_free_cuts, dividing);
      const std::size_t middle = list.size();
      list.insert(list.end(), dividing.positive().begin(), dividing.positive().end());
      const auto next = [&](std::size_t begin, std::size_t count, unsigned side) {
        if (count > 0) parts.push_back({begin, part.depth + 1, index, side, dividing.may_cut_freely(count, size)});
      };
      next(part.begin, middle - part.begin, 0);
      next(middle, list.size() - middle, 1);
    }
  }

  void grow() {
    Task* const root = add_task();
    root->pieces = all_triangles();
    root->with_free_cuts = source.options.free_cuts;
    if (root->pieces.empty()) return tasks.clear();
    for_tasks<Task*>(root, [&](Task* task, const auto& add) {
      Dividing dividing(source, arena);
      const std::size_t size = task->pieces.size();
      if (size < large) {
        grow_whole(*task, dividing);
      } else {
        add_node(*task, 0, task->with_free_cuts, dividing);
        task->deepest = task->depth;
        for (unsigned side = 0; side < 2; ++side) {
          UnsetVector<bsp::Piece> list = side == 0 ? std::move(task->pieces) : dividing.take_positive();
          if (list.empty()) continue;
          Task* const child = task->children[side] = add_task();
          child->with_free_cuts = dividing.may_cut_freely(list.size(), size);
          child->pieces = std::move(list);
          child->depth = task->depth + 1;
          add(child);
        }
      }
      task->cuts = dividing.cuts();
      for (const bsp::Piece& piece : task->polygons) task->corners += piece.count;
      UnsetVector<bsp::Piece>().swap(task->pieces);
    });
  }

  void collect(Bsp& bsp) {
    std::vector<Task*> order, stack{&tasks.front()};
    std::size_t nodes = 0, polygons = 0, corners = 0;
    while (!stack.empty()) {
      Task* const task = stack.back();
      stack.pop_back();
      order.push_back(task);
      task->first_node = nodes;
      task->first_polygon = polygons;
      task->first_corner = corners;
      nodes += task->nodes.size();
      polygons += task->polygons.size();
      corners += task->corners;
      bsp.split_count_ += task->cuts;
      bsp.depth_ = std::max(bsp.depth_, task->deepest);
      for (Task* const child : {task->children[0], task->children[1]})
        if (child) stack.push_back(child);
    }
    if (nodes > none / 2 || corners > none)
      throw Error("a BSP tree of {} nodes and {} corners is beyond {} and {}", nodes, corners, none / 2, none);
    bsp.nodes_.resize(nodes);
    bsp.polygons_.resize(polygons);
    bsp.corners_.resize(corners);
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
      for (std::size_t i = 0; i < task.polygons.size(); ++i) {
        const bsp::Piece& piece = task.polygons[i];
        bsp.polygons_[task.first_polygon + i] = {piece.triangle, corner, piece.count};
        for (std::uint32_t k = 0; k < piece.count; ++k)
          bsp.corners_[corner++] = piece.corners ? piece.corners[k] : Corner{piece.corner(static_cast<int>(k)), 0};
      }
      std::vector<Node>().swap(task.nodes);
      std::vector<bsp::Piece>().swap(task.polygons);
    });
  }
};

Bsp::Bsp(const Scene& scene, const BspOptions& options) {
  for (const auto& [name, value] : {std::pair("candidates", options.candidates), std::pair("sample", options.sample)})
    if (value == 0) throw Error("BspOptions::{} = 0 is outside 1 .. {}", name, none);
  const Bounds bounds = scene.bounds();
  if (bounds.empty()) return;
  const glm::vec3 largest = glm::max(glm::abs(bounds.min), glm::abs(bounds.max));
  epsilon_ = 1e-10 * std::max({largest.x, largest.y, largest.z});
  Builder builder{.source = {scene, options, epsilon_, TriangleNumbers(scene)}, .arena = {}, .mutex = {}, .tasks = {}};
  builder.grow();
  if (!builder.tasks.empty()) builder.collect(*this);
}

}  // namespace gnomon::svbsp
