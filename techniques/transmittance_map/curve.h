#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <tuple>
#include <vector>

// What part of the light is left along the ray of a texel.
namespace gnomon::transmittance_map {

/// A surface that the ray crosses. Depth: any measure that grows along the ray, below that of all places behind.
struct Surface {
  float depth, transmission;  ///< what the surface lets through, 0 .. 1
  auto operator<=>(const Surface&) const = default;
};

/// A corner of a curve T(depth). T is 1 up to the depth of the first node, itself included, and that of the last node behind
/// it.
struct Node {
  float depth, share;  ///< of the light that is left right behind `depth`, 0 .. 1
  bool operator==(const Node&) const = default;
};

/// Which nodes are kept.
///
///   all    A node for each surface: T steps there, and is exact.
///   error  As few as a greedy walk takes so that T is nowhere off by more than the tolerance. Between two nodes T is a line,
///          and it steps where two have the same depth (Lokovic and Veach 2000).
///   nodes  So many at most: T steps, and too much light is left where a node is gone (Salvi et al. 2010).
struct Keep {
  enum class Kind { all, error, nodes } kind = Kind::all;
  double tolerance = 0;          ///< above 0; for error
  std::uint32_t most_nodes = 0;  ///< 1 or more; for nodes
  bool has_lines() const { return kind == Kind::error; }
};

/// Makes the curves of texels, and keeps its room from one to the next. One serves one thread.
class CurveMaker {
 public:
  explicit CurveMaker(const Keep& keep) : keep_(keep) {}

  /// The nodes in the order of their depths; valid until the next call. Sorts the surfaces: the order in which they come does
  /// not matter. No nodes where nothing takes light away.
  std::span<const Node> make(std::span<Surface> surfaces) {
    step(surfaces);
    if (keep_.kind == Keep::Kind::error) draw_lines();
    if (keep_.kind == Keep::Kind::nodes) drop_nodes();
    return nodes_;
  }

 private:
  /// The exact curve: one node for each depth where T changes. The product is in double, rounded once for each node.
  void step(std::span<Surface> surfaces) {
    std::ranges::sort(surfaces);
    nodes_.clear();
    double share = 1;
    for (const Surface& surface : surfaces) {
      if (surface.transmission == 1) continue;
      share *= surface.transmission;
      if (!nodes_.empty() && nodes_.back().depth == surface.depth) nodes_.pop_back();
      nodes_.push_back({surface.depth, static_cast<float>(share)});
      if (share == 0) break;
    }
  }

  /// What a line has to pass at a step of T from `before` to `behind`. It is in the band of half-width eps on both sides; where
  /// the step is higher than the band, it ends there, and another begins behind.
  struct Gate {
    double low, high;
    bool is_end;
  };
  Gate gate(std::size_t i) const {
    const double before = nodes_[i - 1].share, behind = nodes_[i].share, eps = keep_.tolerance;
    const bool is_end = before - eps > behind + eps;
    return {before - eps, (is_end ? before : behind) + eps, is_end};
  }

  /// T is constant between two steps, so a line that is in the band at both of them is in it all the way. From a corner in the
  /// band a line that falls or is level passes the next gate always: `low` is below the corner.
  void draw_lines() {
    if (nodes_.size() < 2) return;
    lines_.clear();
    double depth = nodes_[0].depth, share = nodes_[0].share;  // the last corner
    double steepest = -INFINITY, flattest = 0;                // slopes that pass all gates since
    const auto corner_at = [&](double at, double value) {
      lines_.push_back({static_cast<float>(at), static_cast<float>(value)});
      depth = at;
      share = value;
      steepest = -INFINITY;
      flattest = 0;
    };
    const auto pass = [&](std::size_t i) {
      const double way = nodes_[i].depth - depth;
      const auto [low, high, is_end] = gate(i);
      // A corner is below `low` by rounding at most.
      return std::pair(std::max(steepest, std::min(low - share, 0.0) / way), std::min(flattest, (high - share) / way));
    };
    corner_at(depth, share);
    for (std::size_t i = 1; i < nodes_.size(); ++i) {
      auto [steep, flat] = pass(i);
      if (steep > flat) {
        const double at = nodes_[i - 1].depth;
        corner_at(at, share + (steepest + flattest) / 2 * (at - depth));
        std::tie(steep, flat) = pass(i);
      }
      steepest = steep;
      flattest = flat;
      const bool is_last = i + 1 == nodes_.size();
      if (!is_last && !gate(i).is_end) continue;
      // To the value behind if that is in reach, else as near as can be, and then down or up to it.
      const double at = nodes_[i].depth, behind = nodes_[i].share, way = at - depth;
      const double value = share + std::clamp((behind - share) / way, steepest, flattest) * way;
      corner_at(at, value);
      if (lines_.back().share != nodes_[i].share) corner_at(at, behind);
    }
    nodes_.swap(lines_);
  }

  /// Drops the node whose absence adds least to the area below T, the last one never, until few enough are left. The areas of
  /// its two neighbors are then others.
  void drop_nodes() {
    const auto area = [&](std::size_t i) {
      const double before = i == 0 ? 1.0 : nodes_[i - 1].share;
      return (double(nodes_[i + 1].depth) - nodes_[i].depth) * (before - nodes_[i].share);
    };
    areas_.clear();
    for (std::size_t i = 0; i + 1 < nodes_.size(); ++i) areas_.push_back(area(i));
    while (nodes_.size() > keep_.most_nodes) {
      const std::ptrdiff_t least = std::ranges::min_element(areas_) - areas_.begin();
      nodes_.erase(nodes_.begin() + least);
      areas_.erase(areas_.begin() + least);
      const auto next = static_cast<std::size_t>(least);
      if (next > 0) areas_[next - 1] = area(next - 1);
      if (next < areas_.size()) areas_[next] = area(next);
    }
  }

  Keep keep_;
  std::vector<Node> nodes_, lines_;
  std::vector<double> areas_;  // of all nodes but the last
};

/// T of a curve at a depth, as the shader reads it.
inline double share_at(std::span<const Node> nodes, const Keep& keep, double depth) {
  const auto behind = std::ranges::partition_point(nodes, [&](const Node& node) { return node.depth < depth; });
  if (behind == nodes.begin()) return 1;
  const Node& last = behind[-1];
  if (!keep.has_lines() || behind == nodes.end()) return last.share;
  return last.share + (double(behind->share) - last.share) * ((depth - last.depth) / (double(behind->depth) - last.depth));
}

}  // namespace gnomon::transmittance_map
