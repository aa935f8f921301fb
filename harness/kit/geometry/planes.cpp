#include <fmt/format.h>
#include <gnomon/kit/geometry/planes.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <unordered_map>

namespace gnomon {

namespace {

/// Of a point over a plane, meters.
double height(const glm::dvec4& plane, const glm::dvec3& p) { return glm::dot(glm::dvec3(plane), p) + plane.w; }

/// Data by cells of the space of planes: three coordinates of the unit normal, and the offset from the
/// middle of the receivers in their radius. Faces of one plane lie in neighboring cells. A face is entered with both of its
/// orientations.
template <class Content>
class PlaneCells {
 public:
  PlaneCells(const glm::dvec3& middle, double radius, double width) : middle_(middle), radius_(radius), width_(width) {}

  Content& operator[](const glm::dvec4& plane) { return contents_[pack(cell(plane))]; }
  /// Calls visit(content) for the cell of `plane` and its 80 neighbors, where there is one.
  template <class Visit>
  void around(const glm::dvec4& plane, const Visit& visit) {
    const Cell center = cell(plane);
    for (int k = 0; k < 81; ++k) {
      const auto found = contents_.find(
          pack({center[0] + k % 3 - 1, center[1] + k / 3 % 3 - 1, center[2] + k / 9 % 3 - 1, center[3] + k / 27 - 1}));
      if (found != contents_.end()) visit(found->second);
    }
  }
  auto& all() { return contents_; }

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
  std::unordered_map<std::uint64_t, Content> contents_;
};

/// Width of the cells of faces: what two faces of one plane can differ by.
constexpr double cell_width = 0x1p-8;

/// The faces of a wide cell, and the plane of one of them.
struct CellArea {
  double area = 0;
  glm::dvec4 plane{0};
  bool is_wanted = false;
};

/// A triangle of a receiver.
struct ReceiverFace {
  std::uint32_t index = 0;  ///< in plane_of
  std::array<glm::dvec3, 3> corners;
  glm::dvec4 plane{0};
  double area = 0, altitude = 0;  ///< square meters; the smallest of the three altitudes, meters
};

glm::dvec4 plane_through(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  const glm::dvec3 normal = glm::normalize(glm::cross(b - a, c - a));
  return {normal, -glm::dot(normal, a)};
}

/// The plane of three far-apart corners: its error does not grow over the set, as that of one small face would.
glm::dvec4 plane_of_set(const std::vector<ReceiverFace>& faces, const std::vector<std::uint32_t>& members,
                        const glm::dvec4& plane) {
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

/// Takes planes out of the receiving faces, one after the other, each begun by the largest face that is left.
class PlaneFinder {
 public:
  PlaneFinder(const Scene& scene, double min_share) : min_share_(min_share) { gather_faces(scene); }

  ReceiverPlanes find() {
    if (faces_.empty()) return std::move(result_);
    // A coordinate rounds by half a unit in the last place of the extent E, 2^-24 E, so a corner leaves its plane by up to
    // sqrt 3 times that. Three far-apart corners carry this error to the rest of their set less than threefold; a fourth part
    // is the corner's own.
    rounding_ = std::sqrt(3.0) * 0x1p-24 * bounds_.extent();
    result_.tolerance = 4 * rounding_;
    sort_faces();
    taken_.resize(faces_.size());
    is_candidate_.resize(faces_.size());
    for (std::uint32_t seed = 0; seed < faces_.size(); ++seed)
      if (!taken_[seed] && !is_sliver(faces_[seed])) grow_plane(seed);
    sort_planes();
    return std::move(result_);
  }

 private:
  void gather_faces(const Scene& scene) {
    std::uint32_t index = 0;
    for (const Mesh& mesh : scene.meshes) {
      result_.first_triangle.push_back(index);
      for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const Triangle corners = mesh.corners(t);
        ReceiverFace face{.index = index++, .corners = {corners.points[0], corners.points[1], corners.points[2]}};
        if (!mesh.receives || is_degenerate(corners.points[0], corners.points[1], corners.points[2])) continue;
        const auto& [a, b, c] = face.corners;
        face.area = glm::length(glm::cross(b - a, c - a)) / 2;
        face.altitude = 2 * face.area / std::max({glm::distance(a, b), glm::distance(b, c), glm::distance(c, a)});
        face.plane = plane_through(a, b, c);
        bounds_.add(corners.points);
        result_.receiving_area += face.area;
        faces_.push_back(face);
      }
    }
    result_.plane_of.assign(index, no_plane);
    least_area_ = min_share_ * result_.receiving_area;
  }

  /// A face turns by rounding over altitude: where that is more than half a cell, its normal says nothing. Such slivers join
  /// planes and begin none.
  bool is_sliver(const ReceiverFace& face) const { return 2 * rounding_ / face.altitude > cell_width / 2; }

  /// Drops the faces that no plane of the least area can hold, puts the largest first, and the rest into cells. Cells
  /// sixteen times as wide decide: a smooth mesh has few of them, and most cannot hold such a plane together with their
  /// neighbors. Only faces in or beside those that can are looked at more closely.
  void sort_faces() {
    const glm::dvec3 low = bounds_.min, high = bounds_.max, middle = (low + high) / 2.0;
    const double radius = glm::distance(low, high) / 2;
    PlaneCells<CellArea> sieve(middle, radius, 16 * cell_width);
    for (const ReceiverFace& face : faces_) {
      if (is_sliver(face)) {
        sliver_area_ += face.area;
        continue;
      }
      for (const glm::dvec4& side : {face.plane, -face.plane}) {
        CellArea& cell = sieve[side];
        cell.area += face.area;
        cell.plane = side;
      }
    }
    std::vector<CellArea*> around;
    for (const auto& [key, cell] : sieve.all()) {
      double bound = sliver_area_;
      around.clear();
      sieve.around(cell.plane, [&](CellArea& other) {
        bound += other.area;
        around.push_back(&other);
      });
      if (bound >= least_area_)
        for (CellArea* const other : around) other->is_wanted = true;
    }
    std::erase_if(faces_, [&](const ReceiverFace& face) {
      return !is_sliver(face) && !sieve[face.plane].is_wanted && !sieve[-face.plane].is_wanted;
    });
    std::ranges::stable_sort(faces_, [](const ReceiverFace& a, const ReceiverFace& b) { return a.area > b.area; });
    cells_.emplace(middle, radius, cell_width);
    for (std::uint32_t i = 0; i < faces_.size(); ++i) {
      if (is_sliver(faces_[i])) {
        slivers_.push_back(i);
        continue;
      }
      (*cells_)[faces_[i].plane].push_back(i);
      (*cells_)[-faces_[i].plane].push_back(i);
    }
  }

  /// Finds what may lie in one plane with the seed: the cells around it, and slivers. False where that is too little in all.
  bool find_candidates(std::uint32_t seed) {
    candidates_.clear();
    double bound = sliver_area_;
    cells_->around(faces_[seed].plane, [&](const std::vector<std::uint32_t>& cell) {
      for (const std::uint32_t i : cell) {
        if (taken_[i] || is_candidate_[i]) continue;
        is_candidate_[i] = true;
        bound += faces_[i].area;
        candidates_.push_back(i);
      }
    });
    for (const std::uint32_t i : candidates_) is_candidate_[i] = false;
    if (bound < least_area_) return false;
    candidates_.insert(candidates_.end(), slivers_.begin(), slivers_.end());
    return true;
  }

  template <class LiesOn>
  void gather(const LiesOn& lies_on) {
    members_.clear();
    for (const std::uint32_t i : candidates_)
      if (!taken_[i] && std::ranges::all_of(faces_[i].corners, lies_on)) members_.push_back(i);
  }

  /// First with the seed's own plane, whose error grows with the distance from it; then with the plane of the whole set.
  void grow_plane(std::uint32_t seed) {
    if (!find_candidates(seed)) return;
    const ReceiverFace& face = faces_[seed];
    gather([&](const glm::dvec3& p) {
      const double growth = 1 + 2 * glm::distance(p, face.corners[0]) / face.altitude;
      return std::abs(height(face.plane, p)) <= 2 * rounding_ * growth;
    });
    const glm::dvec4 plane = plane_of_set(faces_, members_, face.plane);
    gather([&](const glm::dvec3& p) { return std::abs(height(plane, p)) <= result_.tolerance; });
    double area = 0;
    for (const std::uint32_t i : members_) area += faces_[i].area;
    if (members_.empty() || area < least_area_) return;
    for (const std::uint32_t i : members_) {
      taken_[i] = true;
      result_.plane_of[faces_[i].index] = static_cast<std::uint32_t>(result_.planes.size());
    }
    result_.planes.push_back({plane, area});
    result_.planar_area += area;
  }

  /// Largest first.
  void sort_planes() {
    std::vector<std::uint32_t> order(result_.planes.size()), rank(order.size());
    for (std::uint32_t i = 0; i < order.size(); ++i) order[i] = i;
    std::ranges::stable_sort(order, std::ranges::greater(), [&](std::uint32_t i) { return result_.planes[i].area; });
    std::vector<ReceiverPlane> sorted;
    for (std::uint32_t i = 0; i < order.size(); ++i) {
      rank[order[i]] = i;
      sorted.push_back(result_.planes[order[i]]);
    }
    result_.planes = std::move(sorted);
    for (std::uint32_t& p : result_.plane_of)
      if (p != no_plane) p = rank[p];
  }

  ReceiverPlanes result_;
  double min_share_, least_area_ = 0, sliver_area_ = 0;  // square meters
  double rounding_ = 0;                                  // of a point off its plane, meters
  Bounds bounds_;
  std::vector<ReceiverFace> faces_;
  std::optional<PlaneCells<std::vector<std::uint32_t>>> cells_;  // of faces_
  std::vector<std::uint32_t> slivers_, candidates_, members_;    // of faces_
  std::vector<bool> taken_, is_candidate_;
};

}  // namespace

double height_rounding(const Scene& scene) {
  // The height n.p + d errs by five roundings (three products, three sums, less one) of terms that add up to at most 2 sqrt 3
  // E: less than 18 * 2^-24 E.
  return 18 * 0x1p-24 * scene.bounds().extent();
}

ReceiverPlanes find_receiver_planes(const Scene& scene, double min_share) { return PlaneFinder(scene, min_share).find(); }

Support support_on_planes(bool has_planes, double covered_share, double min_share) {
  if (!has_planes) return Support::unsupported(fmt::format("no plane holds {} of the receiving area", min_share));
  if (covered_share >= 1 - 1e-9) return Support::full();
  return Support::approximate(fmt::format(
      "{:.3g} % of the receiving area lies on no receiver plane; pixels there are not covered", 100 * (1 - covered_share)));
}

}  // namespace gnomon
