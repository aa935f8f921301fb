#include <gnomon/kit/planes.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <unordered_map>

namespace gnomon {

namespace {

struct Face {
  std::uint32_t index = 0;  ///< in plane_of
  std::array<glm::dvec3, 3> corners;
  glm::dvec4 plane{0};
  double area = 0, altitude = 0;  ///< the smallest of the three altitudes
};

glm::dvec4 plane_through(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  const glm::dvec3 normal = glm::normalize(glm::cross(b - a, c - a));
  return {normal, -glm::dot(normal, a)};
}

double height(const glm::dvec4& plane, const glm::dvec3& p) { return glm::dot(glm::dvec3(plane), p) + plane.w; }

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
class Cells {
 public:
  static constexpr double width = 0x1p-8;

  Cells(const glm::dvec3& middle, double radius) : space_(middle, radius, width) {}
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
class Sieve {
 public:
  Sieve(const glm::dvec3& middle, double radius) : space_(middle, radius, 16 * Cells::width) {}
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
        if (const auto found = parts_.find(k); found != parts_.end()) bound += found->second.area, around.push_back(k);
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

/// The plane of three far-apart corners: its error does not grow over the set, as that of one small face would.
glm::dvec4 plane_of_set(const std::vector<Face>& faces, const std::vector<std::uint32_t>& members, const glm::dvec4& plane) {
  const auto farthest = [&](const auto& distance) {
    glm::dvec3 best = faces[members[0]].corners[0];
    for (const std::uint32_t m : members)
      for (const glm::dvec3& p : faces[m].corners)
        if (distance(p) > distance(best)) best = p;
    return best;
  };
  const glm::dvec3 start = faces[members[0]].corners[0];
  const glm::dvec3 a = farthest([&](const glm::dvec3& p) { return glm::distance(p, start); });
  const glm::dvec3 b = farthest([&](const glm::dvec3& p) { return glm::distance(p, a); });
  const glm::dvec3 c = farthest([&](const glm::dvec3& p) { return glm::length(glm::cross(p - a, b - a)); });
  const glm::dvec4 fitted = plane_through(a, b, c);
  return glm::dot(glm::dvec3(fitted), glm::dvec3(plane)) < 0 ? -fitted : fitted;
}

}  // namespace

double height_rounding(const Scene& scene) {
  // The height n.p + d errs by five roundings (three products, three sums, less one) of terms that add up to at most 2 sqrt 3
  // E: less than 18 * 2^-24 E.
  const Bounds all = scene.bounds();
  if (all.empty()) return 0;
  const glm::vec3 largest = glm::max(glm::abs(all.min), glm::abs(all.max));
  return 18 * 0x1p-24 * std::max({largest.x, largest.y, largest.z});
}

ReceiverPlanes find_receiver_planes(const Scene& scene, double min_share) {
  ReceiverPlanes result;
  std::vector<Face> faces;
  Bounds bounds;
  std::uint32_t index = 0;
  for (const Mesh& mesh : scene.meshes) {
    result.first_triangle.push_back(index);
    for (const glm::uvec3& t : mesh.triangles) {
      Face face{.index = index++, .corners = {mesh.positions[t.x], mesh.positions[t.y], mesh.positions[t.z]}};
      if (!mesh.receives) continue;
      const auto& [a, b, c] = face.corners;
      face.area = glm::length(glm::cross(b - a, c - a)) / 2;
      face.altitude = 2 * face.area / std::max({glm::distance(a, b), glm::distance(b, c), glm::distance(c, a)});
      face.plane = plane_through(a, b, c);
      for (const std::uint32_t v : {t.x, t.y, t.z}) bounds.add(mesh.positions[v]);
      result.receiving_area += face.area;
      faces.push_back(face);
    }
  }
  result.plane_of.assign(index, no_plane);
  if (faces.empty()) return result;

  // A coordinate rounds by half a unit in the last place of the extent E, 2^-24 E, so a corner leaves its plane by up to
  // sqrt 3 times that. Three far-apart corners carry this error to the rest of their set less than threefold; a fourth part is
  // the corner's own.
  const glm::vec3 largest = glm::max(glm::abs(bounds.min), glm::abs(bounds.max));
  const double rounding = std::sqrt(3.0) * 0x1p-24 * std::max({largest.x, largest.y, largest.z});
  result.tolerance = 4 * rounding;

  // A face turns by rounding over altitude: where that is more than half a cell, its normal says nothing. Such slivers join
  // planes and found none.
  const glm::dvec3 low = bounds.min, high = bounds.max;
  const glm::dvec3 middle = (low + high) / 2.0;
  const double radius = glm::distance(low, high) / 2;
  Cells cells(middle, radius);
  Sieve sieve(middle, radius);
  const auto is_sliver = [&](const Face& face) { return 2 * rounding / face.altitude > Cells::width / 2; };
  const double least_area = min_share * result.receiving_area;
  double sliver_area = 0;
  for (const Face& face : faces) {
    if (is_sliver(face))
      sliver_area += face.area;
    else
      sieve.add(face.plane, face.area);
  }
  sieve.sift(least_area, sliver_area);
  std::erase_if(faces, [&](const Face& face) { return !is_sliver(face) && !sieve.keeps(face.plane); });
  std::ranges::stable_sort(faces, [](const Face& a, const Face& b) { return a.area > b.area; });
  std::vector<std::uint32_t> slivers;
  for (std::uint32_t i = 0; i < faces.size(); ++i) {
    if (is_sliver(faces[i]))
      slivers.push_back(i);
    else
      cells.add(faces[i].plane, i);
  }

  std::vector<bool> taken(faces.size()), near(faces.size());
  std::vector<std::uint32_t> candidates, members;
  for (std::uint32_t seed = 0; seed < faces.size(); ++seed) {
    if (taken[seed] || is_sliver(faces[seed])) continue;
    // No plane through this face can hold more than what lies in the cells around it.
    candidates.clear();
    double bound = sliver_area;
    const auto consider = [&](std::uint32_t i) {
      if (taken[i] || near[i]) return;
      near[i] = true;
      bound += faces[i].area;
      candidates.push_back(i);
    };
    cells.around(faces[seed].plane, consider);
    for (const std::uint32_t i : candidates) near[i] = false;
    if (bound < least_area) continue;
    candidates.insert(candidates.end(), slivers.begin(), slivers.end());

    // First with the seed's own plane, whose error grows with the distance from it; then with the plane of the whole set.
    const auto gather = [&](const auto& lies_on) {
      members.clear();
      for (const std::uint32_t i : candidates)
        if (!taken[i] && std::ranges::all_of(faces[i].corners, lies_on)) members.push_back(i);
    };
    const Face& face = faces[seed];
    gather([&](const glm::dvec3& p) {
      const double growth = 1 + 2 * glm::distance(p, face.corners[0]) / face.altitude;
      return std::abs(height(face.plane, p)) <= 2 * rounding * growth;
    });
    const glm::dvec4 plane = plane_of_set(faces, members, face.plane);
    gather([&](const glm::dvec3& p) { return std::abs(height(plane, p)) <= result.tolerance; });
    double area = 0;
    for (const std::uint32_t i : members) area += faces[i].area;
    if (members.empty() || area < least_area) continue;
    for (const std::uint32_t i : members) {
      taken[i] = true;
      result.plane_of[faces[i].index] = static_cast<std::uint32_t>(result.planes.size());
    }
    result.planes.push_back({plane, area});
    result.planar_area += area;
  }

  // Largest first.
  std::vector<std::uint32_t> order(result.planes.size()), rank(order.size());
  for (std::uint32_t i = 0; i < order.size(); ++i) order[i] = i;
  std::ranges::stable_sort(order,
                           [&](std::uint32_t a, std::uint32_t b) { return result.planes[a].area > result.planes[b].area; });
  std::vector<ReceiverPlane> sorted;
  for (std::uint32_t i = 0; i < order.size(); ++i) {
    rank[order[i]] = i;
    sorted.push_back(result.planes[order[i]]);
  }
  result.planes = std::move(sorted);
  for (std::uint32_t& p : result.plane_of)
    if (p != no_plane) p = rank[p];
  return result;
}

}  // namespace gnomon
