#pragma once
// Private to kit/planes: planes by cells of the space of planes, where those that may be one lie near each other.
#include <gnomon/scene.h>

#include <array>
#include <cmath>
#include <unordered_map>
#include <vector>

namespace gnomon {

/// Of a point over a plane, meters.
inline double height(const glm::dvec4& plane, const glm::dvec3& p) { return glm::dot(glm::dvec3(plane), p) + plane.w; }

/// Planes as points: three coordinates of the unit normal, and the offset from the middle of the receivers in their radius.
/// Cut into cells; faces of one plane lie in neighboring cells. A face is entered with both of its orientations.
class PlaneSpace {
 public:
  PlaneSpace(const glm::dvec3& middle, double radius, double width) : middle_(middle), radius_(radius), width_(width) {}

  std::uint64_t key(const glm::dvec4& plane) const { return pack(cell(plane)); }
  /// Calls visit(key) for the cell of `plane` and its 80 neighbors.
  template <class Visit>
  void around(const glm::dvec4& plane, const Visit& visit) const {
    const auto center = cell(plane);
    for (int k = 0; k < 81; ++k)
      visit(pack({center[0] + k % 3 - 1, center[1] + k / 3 % 3 - 1, center[2] + k / 9 % 3 - 1, center[3] + k / 27 - 1}));
  }

 private:
  using Cell = std::array<std::int64_t, 4>;
  Cell cell(const glm::dvec4& plane) const {
    const double offset = height(plane, middle_) / radius_;
    return {std::int64_t(std::floor(plane.x / width_)), std::int64_t(std::floor(plane.y / width_)),
            std::int64_t(std::floor(plane.z / width_)), std::int64_t(std::floor(offset / width_))};
  }
  /// Each index is within +-1025.
  static std::uint64_t pack(const Cell& c) {
    std::uint64_t key = 0;
    for (const std::int64_t i : c) key = key << 16 | std::uint64_t(i + 4096);
    return key;
  }

  glm::dvec3 middle_;
  double radius_, width_;
};

/// The faces by cells as wide as what two faces of one plane can differ by.
class PlaneCells {
 public:
  static constexpr double width = 0x1p-8;

  PlaneCells(const glm::dvec3& middle, double radius) : space_(middle, radius, width) {}
  void add(const glm::dvec4& plane, std::uint32_t face) {
    cells_[space_.key(plane)].push_back(face);
    cells_[space_.key(-plane)].push_back(face);
  }
  /// Calls visit(face) for all faces that may be coplanar with `plane`; some come twice, some are not.
  template <class Visit>
  void around(const glm::dvec4& plane, const Visit& visit) const {
    space_.around(plane, [&](std::uint64_t key) {
      const auto found = cells_.find(key);
      if (found != cells_.end())
        for (const std::uint32_t face : found->second) visit(face);
    });
  }

 private:
  PlaneSpace space_;
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> cells_;
};

/// Cells sixteen times as wide, which hold areas only: a smooth mesh has few of them, and most cannot hold a plane of the least
/// area together with their neighbors. Only what lies in or beside those that can is worth a closer look.
class PlaneSieve {
 public:
  PlaneSieve(const glm::dvec3& middle, double radius) : space_(middle, radius, 16 * PlaneCells::width) {}
  void add(const glm::dvec4& plane, double area) {
    for (const glm::dvec4& side : {plane, -plane}) {
      Part& part = parts_[space_.key(side)];
      part.area += area;
      part.plane = side;
    }
  }
  /// Call once, after the last `add`.
  void sift(double least_area, double area_anywhere) {
    std::vector<std::uint64_t> wanted;
    for (const auto& [key, part] : parts_) {
      double bound = area_anywhere;
      std::vector<std::uint64_t> around;
      space_.around(part.plane, [&](std::uint64_t k) {
        const auto found = parts_.find(k);
        if (found == parts_.end()) return;
        bound += found->second.area;
        around.push_back(k);
      });
      if (bound >= least_area) wanted.insert(wanted.end(), around.begin(), around.end());
    }
    for (const std::uint64_t key : wanted) parts_[key].is_wanted = true;
  }
  bool keeps(const glm::dvec4& plane) const {
    return parts_.at(space_.key(plane)).is_wanted || parts_.at(space_.key(-plane)).is_wanted;
  }

 private:
  struct Part {
    double area = 0;
    glm::dvec4 plane{0};
    bool is_wanted = false;
  };
  PlaneSpace space_;
  std::unordered_map<std::uint64_t, Part> parts_;
};

}  // namespace gnomon
