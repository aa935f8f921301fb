#pragma once
#include <span>
#include <vector>

#include "casters.h"
#include "depth.h"

namespace gnomon::soft_volume {

/// Edges that points near to each other may need, ready for a quick look: float32 numbers about a place among the points. What
/// it cannot tell stays.
class EdgeFilter {
 public:
  /// `edges` as Casters::find_edges gives them, with the number of regular ones, for points in a box.
  void set(const Casters& casters, std::span<const std::uint32_t> edges, std::size_t regular_count, const Bounds& points);
  /// Edges that may be silhouette edges for a point in the box, and may pass before the light of `depth`.
  void find(const glm::vec3& point, const LightDepth& depth, std::vector<std::uint32_t>& found);
  std::size_t size() const { return edges_.size(); }

 private:
  std::vector<std::uint32_t> edges_;
  std::size_t regular_count_ = 0;
  glm::dvec3 middle_{0};
  float reach_ = 0;  ///< largest coordinate of a vertex about the middle, plus that of a point
  std::vector<float> planes_[8], corners_[6];
  std::vector<std::uint8_t> stays_;
};

}  // namespace gnomon::soft_volume
