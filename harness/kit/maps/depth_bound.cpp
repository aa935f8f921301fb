#include <gnomon/kit/geometry/across.h>
#include <gnomon/kit/geometry/edges.h>
#include <gnomon/kit/parallel.h>

#include <algorithm>
#include <numeric>

namespace gnomon {

namespace {

/// Bounds from above how many shadow volumes overlap at any point of space: how often the outline that the light sees winds
/// around it. The light's image is unrolled: around an axis through a light at a finite point, onto the four sides of the prism
/// |u| + |v| = 1, which keep lines straight; along a directional light's rays, onto a plane. `across` runs around the axis,
/// `up` along it. On every vertical line the number of volumes is known at the lower end, and changes at edges only.
class DepthBound {
 public:
  DepthBound(const EdgeAdjacency& adjacency, const Silhouette& silhouette, std::int64_t enough)
      : adjacency_(adjacency), silhouette_(silhouette), enough_(enough), light_(silhouette.light) {
    choose_axes();
  }

  /// Quick: half of the edges that any vertical line crosses, since the number must come back to what it is at the upper end.
  /// The finer bound follows where that is over the limit, first in the few columns where it is least likely to hold.
  std::int64_t operator()() const {
    const std::vector<std::int64_t> quick = crossed();
    const std::int64_t bound = *std::ranges::max_element(quick);
    if (bound <= enough_) return bound;
    std::vector<std::int64_t> most(columns, 0);
    constexpr int ratio = fine_columns / columns;
    for (int i = 0; i < fine_columns; ++i) most[i / ratio] = std::max(most[i / ratio], quick[i]);
    std::vector<int> over(columns);
    std::iota(over.begin(), over.end(), 0);
    std::ranges::stable_sort(over, [&](int a, int b) { return most[a] > most[b]; });
    std::erase_if(over, [&](int c) { return most[c] <= enough_; });
    const std::size_t worst = std::min<std::size_t>(over.size(), 4);
    for (const std::span<const int> some : {std::span(over).first(worst), std::span(over).subspan(worst)}) {
      sort_columns(some, most);
      if (std::ranges::any_of(some, [&](int c) { return most[c] > enough_; })) return bound;
    }
    return *std::ranges::max_element(most);
  }

 private:
  static constexpr int fine_columns = 4096, columns = 1024;

  /// Of each fine column; in one pass over the edges.
  std::vector<std::int64_t> crossed() const {
    std::vector<std::int64_t> change(fine_columns + 1, 0);
    for (const SilhouetteEdge& edge : silhouette_.edges)
      for_pieces(edge, [&](const Piece& piece) {
        change[column(piece.from.x, fine_columns, -1)] += piece.count;
        change[column(piece.to.x, fine_columns, 1) + 1] -= piece.count;
      });
    std::int64_t now = 0;
    for (int i = 0; i < fine_columns; ++i) change[i] = ((now += change[i]) + at_ends_) / 2;
    change.pop_back();
    return change;
  }

  /// Line by line. The number at a point beside a column's middle line differs from that on the line at the same height by at
  /// most the edges that pass this height inside the column.
  void sort_columns(std::span<const int> over, std::span<std::int64_t> most) const {
    constexpr std::uint32_t not_listed = 0xffffffffu;
    std::vector<std::uint32_t> list_of(columns, not_listed);
    for (std::uint32_t k = 0; k < over.size(); ++k) list_of[over[k]] = k;
    std::vector<std::vector<std::uint32_t>> edges(over.size());  // that touch each column
    for (std::uint32_t e = 0; e < silhouette_.edges.size(); ++e)
      for_pieces(silhouette_.edges[e], [&](const Piece& piece) {
        const int last = column(piece.to.x + slack * width_, columns, 0);
        for (int c = column(piece.from.x - slack * width_, columns, 0); c <= last; ++c) {
          if (list_of[c] == not_listed) continue;
          std::vector<std::uint32_t>& list = edges[list_of[c]];
          if (list.empty() || list.back() != e) list.push_back(e);
        }
      });
    for_blocks(over.size(), 1, [&](std::size_t k, std::size_t) {
      most[over[k]] = at_ends_ + most_in_column(edges[k], (over[k] + 0.5) * width_ / columns, width_ / columns);
    });
  }

  /// A part of an edge that is straight in the unrolled image, from left to right. `turn` is `count` with the sign of its way.
  struct Piece {
    glm::dvec2 from, to;
    std::int32_t count, turn;
  };
  struct Event {
    double height;
    std::int32_t turn, passing;
  };
  /// Share of the image's width that rounding may move a place by.
  static constexpr double slack = 1e-9;

  std::int64_t most_in_column(std::span<const std::uint32_t> edges, double middle, double width) const {
    std::vector<Event> events;
    events.reserve(3 * edges.size());
    const double low_end = middle - width / 2 - slack * width_, high_end = middle + width / 2 + slack * width_;
    const auto add = [&](const Piece& piece) {
      if (piece.to.x < low_end || piece.from.x > high_end) return;
      const double left = std::max(piece.from.x, low_end), right = std::min(piece.to.x, high_end);
      const double span = piece.to.x - piece.from.x;
      const auto height = [&](double x) {
        const double share = span > 0 ? std::clamp((x - piece.from.x) / span, 0.0, 1.0) : 0.0;
        return piece.from.y + share * (piece.to.y - piece.from.y);
      };
      double low = height(left), high = height(right);
      if (!(span > slack * width_)) {  // steep: the whole of it
        low = piece.from.y;
        high = piece.to.y;
      }
      if (low > high) std::swap(low, high);
      const double reach = 1e-9 * (std::abs(low) + std::abs(high)) + 1e-300;
      events.push_back({low - reach, 0, piece.count});
      events.push_back({high + reach, 0, -piece.count});
      if (piece.from.x <= middle && middle < piece.to.x) events.push_back({height(middle), piece.turn, 0});
    };
    for (const std::uint32_t e : edges) for_pieces(silhouette_.edges[e], add);
    // What begins at a height is counted before what ends there.
    std::ranges::sort(events, [](const Event& a, const Event& b) {
      return a.height != b.height ? a.height < b.height : a.passing > b.passing;
    });
    std::int64_t winding = 0, passing = 0, most = 0;
    for (const Event& event : events) {
      winding += event.turn;
      passing += event.passing;
      most = std::max(most, std::abs(winding) + passing);
    }
    return most;
  }

  /// The axis leads along an axis of the world past all casters, where there is one; then no volume lies at either end.
  void choose_axes() {
    Bounds all;
    for (const EdgeAdjacency::Part& part : adjacency_.parts()) all.add(part.bounds);
    if (all.empty()) return;
    if (light_.w == 0) {
      const glm::dvec3 along = glm::normalize(glm::dvec3(light_));
      u_ = Across(-along).u;
      axis_ = glm::cross(along, u_);
      const glm::dvec3 middle = (glm::dvec3(all.min) + glm::dvec3(all.max)) / 2.0, half = glm::dvec3(all.max) - middle;
      const double reach = glm::dot(glm::abs(u_), half) * (1 + 1e-9) + 1e-300;
      left_ = glm::dot(u_, middle) - reach;
      width_ = 2 * reach;
      return;
    }
    light_ /= light_.w;
    const glm::dvec3 l(light_);
    int beside = 0;  // the axis along which the light is beside all casters
    while (beside < 3 && l[beside] >= all.min[beside] && l[beside] <= all.max[beside]) ++beside;
    const int axis = beside < 3 ? (beside + 1) % 3 : 0;
    axis_[axis] = 1;
    u_[(axis + 1) % 3] = 1;
    v_[(axis + 2) % 3] = 1;
    width_ = 4;
    if (beside == 3) at_ends_ = near_axis();
  }

  /// At least as many triangles as the axis meets on both sides of the light.
  std::int64_t near_axis() const {
    std::int64_t count = 0;
    for (std::size_t t = 0; t < silhouette_.facing.size(); ++t) {
      if (silhouette_.facing[t] == 0) continue;
      glm::dvec2 low(INFINITY), high(-INFINITY);
      for (int k = 0; k < 3; ++k) {
        const glm::dvec3 p = from_light(adjacency_.triangles()[t][k]);
        const glm::dvec2 q(glm::dot(u_, p), glm::dot(v_, p));
        low = glm::min(low, q);
        high = glm::max(high, q);
      }
      count += low.x <= 0 && high.x >= 0 && low.y <= 0 && high.y >= 0;
    }
    return count;
  }

  glm::dvec3 from_light(std::uint32_t vertex) const {
    return glm::dvec3(adjacency_.positions()[vertex]) - (light_.w != 0 ? glm::dvec3(light_) : glm::dvec3(0));
  }

  /// Column of a place, one more to the side for rounding.
  int column(double across, int columns, int more) const {
    return std::clamp(static_cast<int>(std::floor(across / width_ * columns)) + more, 0, columns - 1);
  }

  /// The pieces of an edge. Around a point light it is cut where the prism has its edges: at u = 0 and v = 0.
  template <class Visit>
  void for_pieces(const SilhouetteEdge& edge, Visit&& visit) const {
    const auto emit = [&](glm::dvec2 a, glm::dvec2 b) {
      const bool rightward = a.x <= b.x;
      if (!rightward) std::swap(a, b);
      visit(Piece{a, b, std::abs(edge.count), rightward ? edge.count : -edge.count});
    };
    const glm::dvec3 a = from_light(edge.low), b = from_light(edge.high);
    if (light_.w == 0)
      return emit({glm::dot(u_, a) - left_, glm::dot(axis_, a)}, {glm::dot(u_, b) - left_, glm::dot(axis_, b)});
    const glm::dvec3 p(glm::dot(u_, a), glm::dot(v_, a), glm::dot(axis_, a));
    const glm::dvec3 q(glm::dot(u_, b), glm::dot(v_, b), glm::dot(axis_, b));
    double cuts[4] = {0, 1, 1, 1};
    int cut_count = 1;
    for (int k = 0; k < 2; ++k)
      if ((p[k] < 0) != (q[k] < 0)) cuts[cut_count++] = p[k] / (p[k] - q[k]);
    if (cut_count == 3 && cuts[1] > cuts[2]) std::swap(cuts[1], cuts[2]);
    for (int i = 0; i < cut_count; ++i) {
      const double end = i + 1 < cut_count ? cuts[i + 1] : 1;
      const glm::dvec3 middle = p + (q - p) * ((cuts[i] + end) / 2);
      emit(unrolled(p + (q - p) * cuts[i], middle), unrolled(p + (q - p) * end, middle));
    }
  }

  /// Place of a point in the image, on the side of the prism that `inside` lies on.
  static glm::dvec2 unrolled(const glm::dvec3& p, const glm::dvec3& inside) {
    const double su = inside.x < 0 ? -1 : 1, sv = inside.y < 0 ? -1 : 1;
    const double u = std::max(su * p.x, 0.0), v = std::max(sv * p.y, 0.0), sum = std::max(u + v, 1e-300);
    const double share = v / sum;  // 0 at the u axis, 1 at the v axis
    const double across = su > 0 ? (sv > 0 ? share : 4 - share) : (sv > 0 ? 2 - share : 2 + share);
    return {across, std::clamp(p.z / sum, -1e150, 1e150)};
  }

  const EdgeAdjacency& adjacency_;
  const Silhouette& silhouette_;
  std::int64_t enough_;
  glm::dvec4 light_;
  glm::dvec3 u_{0}, v_{0}, axis_{0};
  double left_ = 0, width_ = 1;
  std::int64_t at_ends_ = 0;
};

}  // namespace

std::int64_t bound_depth(const EdgeAdjacency& adjacency, const Silhouette& silhouette, std::int64_t enough) {
  return DepthBound(adjacency, silhouette, enough)();
}

}  // namespace gnomon
