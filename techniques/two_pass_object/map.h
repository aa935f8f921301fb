#pragma once
#include "cell.h"

namespace gnomon::two_pass_object {

/// How points were decided.
struct PointWork {
  std::uint64_t points = 0, asked = 0;  ///< points located; those decided by exact signs of the triangles in their cell
  PointWork& operator+=(const PointWork& w) { return add_up(*this, w, &PointWork::points, &PointWork::asked); }
};

/// The triangles as the light sees them, in the cells of a grid whose crowded cells have grids of their own, and in each cell
/// the lit pieces of what it holds.
class LightMap {
 public:
  static constexpr std::uint32_t none = 0xffffffffu;
  void clear() {
    patches_.clear();
    roots_.clear();
    work_ = {};
  }
  void make(const Triangles& triangles, double cell_triangles);

  bool is_lit(const Triangles& triangles, const NumberedReceiver& receiver, PointWork& work) const;
  /// The first triangle in the point's cell that shades it, or `none`.
  std::uint32_t shading(const Triangles& triangles, const NumberedReceiver& receiver) const;
  /// Casters that took something from the point's triangle in its cell; 0 where it is not found.
  std::uint32_t clips_at(const Triangles& triangles, const NumberedReceiver& receiver) const;

  /// Calls visit(face, cell, footprints) for all cells of a patch.
  using LeafVisitor = std::function<void(int face, const Node& cell, std::span<const Footprint* const> footprints)>;
  void for_leaves(const Triangles& triangles, std::size_t patch, const LeafVisitor& visit) const;
  std::size_t patch_count() const { return patches_.size(); }
  const Work& work() const { return work_; }
  std::size_t bytes() const;

 private:
  static constexpr std::size_t patch_cells = 64;
  struct Face {
    Node node;
    std::uint32_t first_root = 0, first_patch = 0;
    double margin = 0;
  };
  struct Place {
    const Patch* patch = nullptr;  ///< null where the light sees no triangle
    const Node* cell = nullptr;
    int face = 0;
    PlaceAndDepth seen{};
  };
  Place find(const Triangles& triangles, const glm::dvec3& point) const;
  const Entry* find(const Place& place, std::uint32_t triangle) const;

  Face faces_[6];
  std::vector<std::uint32_t> roots_;  ///< node of each cell of the first division
  std::vector<Patch> patches_;
  Work work_;
};

}  // namespace gnomon::two_pass_object
