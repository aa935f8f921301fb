#pragma once
// Private to bsp.cpp: triangles and their parts on the way down a BSP tree that is being made, how a plane is chosen for a list
// of these pieces, and what it makes of them.
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <mutex>
#include <tuple>

#include "bsp.h"

namespace gnomon::svbsp::bsp {

/// A triangle, or a part of one. It carries what most tests need, so that a list is read in a row.
struct Piece {
  float at[9];             ///< three corners; of a part the lower and the upper corner of a box around it
  std::uint32_t triangle;  ///< counted over the scene
  const Corner* corners;   ///< of a part; null for a triangle
  std::uint32_t count;     ///< corners

  glm::dvec3 corner(int k) const { return {at[3 * k], at[3 * k + 1], at[3 * k + 2]}; }  ///< of a triangle
  float low(int axis) const { return corners ? at[axis] : std::min({at[axis], at[axis + 3], at[axis + 6]}); }
  float high(int axis) const { return corners ? at[axis + 3] : std::max({at[axis], at[axis + 3], at[axis + 6]}); }
};

inline Piece piece_of(std::uint32_t number, const Triangle& triangle) {
  const auto& [a, b, c] = triangle.points;
  return {{a.x, a.y, a.z, b.x, b.y, b.z, c.x, c.y, c.z}, number, nullptr, 3};
}

inline Piece piece_of(std::uint32_t triangle, const Corner* corners, std::size_t count) {
  Piece made{{}, triangle, corners, static_cast<std::uint32_t>(count)};
  glm::dvec3 low = corners[0].at, high = low;
  for (std::size_t i = 1; i < count; ++i) {
    low = glm::min(low, corners[i].at);
    high = glm::max(high, corners[i].at);
  }
  for (int k = 0; k < 3; ++k) {
    const auto down = static_cast<float>(low[k]), up = static_cast<float>(high[k]);
    made.at[k] = down > low[k] ? std::nextafter(down, -INFINITY) : down;
    made.at[3 + k] = up < high[k] ? std::nextafter(up, INFINITY) : up;
  }
  return made;
}

/// Memory for the corners of parts, for many threads. They stay where they are as long as the arena lives.
class Arena {
 public:
  /// What one thread takes from it.
  class Room {
   public:
    explicit Room(Arena& arena) : arena_(arena) {}
    /// Room for as many, of which `keep` takes the first ones.
    Corner* reserve(std::size_t count) {
      if (static_cast<std::size_t>(end_ - next_) < count) {
        const std::size_t size = std::max<std::size_t>(count, 512);
        next_ = arena_.take(size);
        end_ = next_ + size;
      }
      return next_;
    }
    void keep(std::size_t count) { next_ += count; }

   private:
    Arena& arena_;
    Corner *next_ = nullptr, *end_ = nullptr;
  };

 private:
  Corner* take(std::size_t size) {
    std::unique_ptr<Corner[]> block(new Corner[size]);
    const std::scoped_lock lock(mutex_);
    blocks_.push_back(std::move(block));
    return blocks_.back().get();
  }
  std::mutex mutex_;
  std::vector<std::unique_ptr<Corner[]>> blocks_;
};

/// What divides a list of pieces: the plane of one of their triangles, or a free cut.
struct Divider {
  ClipPlane plane;
  int axis = -1;          ///< that a free cut is across
  float place = 0;        ///< of a free cut, on its axis
  std::size_t owner = 0;  ///< otherwise the piece's place in the list,
  Triangle triangle;      ///< and its triangle
};

/// A normal of any length, zero only when the triangle's area is zero. The unit normal's error, an angle, is that of the
/// product, a few 2^-53, over the sine between the edges: below 1e-11 where the sine is above 1e-4. Elsewhere the product is
/// taken in quadruple precision, where it is exact but for exponents 60 bits apart.
inline glm::dvec3 normal_of(const Triangle& t) {
  const glm::dvec3 a(t.points[0]), u = glm::dvec3(t.points[1]) - a, v = glm::dvec3(t.points[2]) - a, n = glm::cross(u, v);
  if (glm::dot(n, n) > 1e-8 * glm::dot(u, u) * glm::dot(v, v)) return n;
  using Quad = __float128;
  const auto product = [&](int i, int j) { return Quad(u[i]) * v[j] - Quad(u[j]) * v[i]; };
  const Quad q[3] = {product(1, 2), product(2, 0), product(0, 1)};
  Quad largest = 0;
  for (const Quad x : q) largest = std::max(largest, x < 0 ? -x : x);
  if (largest == 0) return glm::dvec3(0);
  return {static_cast<double>(q[0] / largest), static_cast<double>(q[1] / largest), static_cast<double>(q[2] / largest)};
}

inline void set_plane(Divider& divider, const Triangle& triangle) {
  const glm::dvec3 n = normal_of(triangle);
  divider.axis = -1;
  divider.triangle = triangle;
  divider.plane.normal = n / std::sqrt(glm::dot(n, n));
  divider.plane.offset = -glm::dot(divider.plane.normal, glm::dvec3(triangle.points[0]));
}

inline void set_free_cut(Divider& divider, int axis, float place) {
  divider.axis = axis;
  divider.place = place;
  divider.plane = {.normal = glm::dvec3(0), .offset = -double{place}};
  divider.plane.normal[axis] = 1;
}

/// Where the pieces come from.
struct Source {
  const Scene& scene;
  const BspOptions& options;
  double epsilon;  ///< meters
  TriangleNumbers numbers;

  Triangle triangle(const Piece& piece) const {
    if (!piece.corners) return {{glm::vec3(piece.corner(0)), glm::vec3(piece.corner(1)), glm::vec3(piece.corner(2))}};
    return triangle_of(scene, numbers, piece.triangle);
  }
};

/// Divides lists of pieces, one after the other.
class Dividing {
 public:
  static constexpr std::size_t fewest_for_free_cuts = 48;

  Dividing(const Source& source, Arena& arena) : source_(source), room_(arena) {}

  /// Chooses what divides a list of two pieces or more, and does it. The pieces on its negative side are in the front of the
  /// list then, those on the positive side in positive(), both in their order; what lies in the plane is appended to `set`.
  /// Returns the number of negative pieces.
  std::size_t divide(std::span<Piece> list, bool with_free_cuts, std::vector<Piece>& set) {
    choose(list, with_free_cuts);
    return best_.axis < 0 ? part<false>(list, set) : part<true>(list, set);
  }
  std::span<const Piece> positive() const { return {positive_.data(), positive_count_}; }
  UnsetVector<Piece> take_positive() {
    positive_.resize(positive_count_);
    return std::move(positive_);
  }

  const ClipPlane& plane() const { return best_.plane; }
  /// Whether a side with `size` pieces of a list of `of` may be divided by a free cut. These take no piece away; one that
  /// hardly divides a list is followed by a plane that does, so that there is an end.
  bool may_cut_freely(std::size_t size, std::size_t of) const {
    return source_.options.free_cuts && (best_.axis < 0 || 10 * size <= 9 * of);
  }
  std::size_t cuts() const { return cuts_; }  ///< so far

 private:
  /// For pieces within epsilon: exactly in the plane, or on the side of their triangle. One that goes through another's plane
  /// there belongs to its set; it need not lie in a free cut that it goes through.
  Lies lies_exactly(const Piece& piece, const Divider& divider) const {
    const Triangle own = source_.triangle(piece);
    int low = 1, high = -1;
    for (const glm::vec3& p : own.points) {
      const glm::vec3* const t = divider.triangle.points;
      const int sign = divider.axis < 0 ? orient3d_sign(t[0], t[1], t[2], p)
                                        : (p[divider.axis] > divider.place) - (p[divider.axis] < divider.place);
      low = std::min(low, sign);
      high = std::max(high, sign);
    }
    if (low >= 0 && high > 0) return Lies::positive;
    if (high <= 0 && low < 0) return Lies::negative;
    return low == 0 || divider.axis < 0 ? Lies::within : Lies::negative;
  }

  void choose(std::span<const Piece> list, bool with_free_cuts) {
    const BspOptions& options = source_.options;
    const std::size_t n = list.size();
    if (options.choice == BspOptions::Choice::first) {
      best_.owner = 0;
      return set_plane(best_, source_.triangle(list[0]));
    }
    // The middles of `count` equal shares of the list.
    const auto place = [&](std::size_t k, std::size_t count) { return (2 * k + 1) * n / (2 * count); };
    sample_.resize(std::min<std::size_t>(n, options.sample));
    for (std::size_t k = 0; k < sample_.size(); ++k) sample_[k] = &list[n > options.sample ? place(k, sample_.size()) : k];
    least_ = {std::numeric_limits<std::size_t>::max(), 0};
    const std::size_t candidates = std::min<std::size_t>(n, options.candidates);
    for (std::size_t k = 0; k < candidates; ++k) {
      candidate_.owner = place(k, candidates);
      set_plane(candidate_, source_.triangle(list[candidate_.owner]));
      if (consider<false>()) return;
    }
    if (!with_free_cuts || n < fewest_for_free_cuts) return;
    // Through the lowest corners of pieces, which it does not cut.
    glm::vec3 low(INFINITY), high(-INFINITY);
    for (const Piece* const piece : sample_) {
      const glm::vec3 corner(piece->low(0), piece->low(1), piece->low(2));
      low = glm::min(low, corner);
      high = glm::max(high, corner);
    }
    const glm::vec3 size = high - low;
    for (int axis = 0; axis < 3; ++axis) {
      if (4 * size[axis] < std::max({size.x, size.y, size.z})) continue;
      places_.clear();
      for (const Piece* const piece : sample_) places_.push_back(piece->low(axis));
      const auto middle = places_.begin() + static_cast<std::ptrdiff_t>(places_.size() / 2);
      std::nth_element(places_.begin(), middle, places_.end());
      set_free_cut(candidate_, axis, *middle);
      if (consider<true>()) return;
    }
  }

  /// Tries candidate_ on the sample; whether it is good enough to try no other one: no cuts, and fairly even sides.
  template <bool is_free>
  bool consider() {
    const bool is_balanced = source_.options.choice == BspOptions::Choice::balanced;
    const std::size_t most_cuts = is_balanced ? std::get<0>(least_) / 8 : std::get<0>(least_);
    std::size_t counts[4] = {};
    for (const Piece* const piece : sample_) {
      ++counts[static_cast<unsigned>(lies<is_free, true>(*piece, candidate_))];
      if (counts[3] > most_cuts) return false;
    }
    const std::size_t imbalance = counts[1] > counts[2] ? counts[1] - counts[2] : counts[2] - counts[1];
    if (is_free && 2 * imbalance > sample_.size()) return false;
    // A node that holds no polygon costs something too: a quarter of the sample spared many cuts of triangle soups.
    const std::tuple score = is_balanced
                                 ? std::tuple(8 * counts[3] + imbalance + (is_free ? sample_.size() / 4 : 0), std::size_t{0})
                                 : std::tuple(counts[3], imbalance);
    if (score < least_) {
      least_ = score;
      best_ = candidate_;
    }
    return counts[3] == 0 && imbalance <= 1 + sample_.size() / 4;
  }

  /// Divides a list by best_.
  template <bool is_free>
  std::size_t part(std::span<Piece> list, std::vector<Piece>& set) {
    std::size_t negative = 0, positive = 0;
    if (positive_.size() < list.size()) positive_.resize(list.size());
    for (std::size_t i = 0; i < list.size(); ++i) {
      const Piece piece = list[i];
      Lies where = lies<is_free, false>(piece, best_);
      if (where == Lies::within || where == Lies::across || (!is_free && i == best_.owner)) {
        if (!is_free && i == best_.owner)
          where = Lies::within;
        else if (where == Lies::within)
          where = lies_exactly(piece, best_);
        if (where == Lies::within) set.push_back(piece);
        if (where == Lies::across) cut(piece, list[negative++], positive_[positive++]);
        if (where == Lies::within || where == Lies::across) continue;
      }
      // The side is not predictable: written to both, without a branch.
      list[negative] = piece;
      positive_[positive] = piece;
      negative += where == Lies::negative;
      positive += where == Lies::positive;
    }
    positive_count_ = positive;
    return negative;
  }

  void cut(const Piece& piece, Piece& negative, Piece& positive) {
    Corner own[3];
    std::span<const Corner> polygon(piece.corners, piece.count);
    if (!piece.corners) {
      for (int k = 0; k < 3; ++k) own[k].at = piece.corner(k);
      polygon = own;
    }
    if (part_.size() <= polygon.size()) part_.resize(polygon.size() + 1);
    Corner* const room = room_.reserve(2 * polygon.size() + 2);
    const CutCounts counts = cut_polygon(polygon, values_.data(), source_.epsilon, 1, room, part_.data());
    std::copy_n(part_.data(), counts.positive, room + counts.negative);
    room_.keep(counts.negative + counts.positive);
    const std::uint32_t triangle = piece.triangle;
    negative = piece_of(triangle, room, counts.negative);
    positive = piece_of(triangle, room + counts.negative, counts.positive);
    ++cuts_;
  }

  /// Of a piece that lies across the divider values_ are those of its corners, unless it is only estimated; then a part may be
  /// said to lie across where its box does.
  template <bool is_free, bool is_estimate>
  [[gnu::always_inline]] Lies lies(const Piece& piece, const Divider& divider) {
    const double epsilon = source_.epsilon;
    if constexpr (is_free) {
      const float low = piece.low(divider.axis), high = piece.high(divider.axis);
      if (high <= divider.place) return low == divider.place ? Lies::within : Lies::negative;
      if (low >= divider.place) return Lies::positive;
      if (is_estimate) return Lies::across;
    }
    if (!piece.corners) {
      const double a = divider.plane.at(piece.corner(0)), b = divider.plane.at(piece.corner(1)),
                   c = divider.plane.at(piece.corner(2));
      if (!is_estimate) {
        values_[0] = a;
        values_[1] = b;
        values_[2] = c;
      }
      const unsigned is_negative = (a < -epsilon) | (b < -epsilon) | (c < -epsilon),
                     is_positive = (a > epsilon) | (b > epsilon) | (c > epsilon);
      return static_cast<Lies>(is_negative | is_positive << 1);
    }
    if constexpr (!is_free) {
      const glm::dvec3& n = divider.plane.normal;
      double low = divider.plane.offset, high = low;
      for (int k = 0; k < 3; ++k) {
        low += n[k] * piece.at[n[k] > 0 ? k : 3 + k];
        high += n[k] * piece.at[n[k] > 0 ? 3 + k : k];
      }
      if (low > epsilon) return Lies::positive;
      if (high < -epsilon) return Lies::negative;
      if (is_estimate) return Lies::across;
    }
    if (values_.size() < piece.count) values_.resize(piece.count);
    return classify({piece.corners, piece.count}, divider.plane, epsilon, values_.data());
  }

  const Source& source_;
  Arena::Room room_;
  Divider best_, candidate_;
  std::tuple<std::size_t, std::size_t> least_;  ///< score of best_
  std::vector<const Piece*> sample_;
  std::vector<float> places_;
  UnsetVector<Piece> positive_;
  std::size_t positive_count_ = 0, cuts_ = 0;
  std::vector<double> values_ = std::vector<double>(8);
  std::vector<Corner> part_;
};

}  // namespace gnomon::svbsp::bsp
