#pragma once
#include "grid.h"
#include "pieces.h"

namespace gnomon::two_pass_object {

/// What a cell knows of a triangle that it sees.
struct Entry {
  enum class Kind : std::uint8_t { absent, lit, dark, pieces, asks };  ///< absent: not a receiver; asks: every point is asked
  std::uint32_t triangle;
  std::uint32_t first_piece = 0, first_near = 0;
  std::uint16_t piece_count = 0, near_count = 0;
  std::uint16_t clips = 0;  ///< casters that took something away, up to 65535
  Kind kind = Kind::absent;
};

/// A lit piece: a box around its places, and planes that it lies inside, by their marks.
struct LitPiece {
  float u0, v0, u1, v1;
  std::uint32_t first_mark, mark_count;
};

/// Cells, one after the other, and all they hold.
struct Patch {
  std::vector<Node> nodes;
  std::vector<Entry> entries;  ///< of each leaf, by triangle
  std::vector<LitPiece> pieces;
  std::vector<std::uint32_t> marks;
  std::vector<std::uint32_t> near;  ///< casters that lie so near to a receiver's plane that each point is asked
  std::size_t bytes() const {
    return nodes.capacity() * sizeof(Node) + entries.capacity() * sizeof(Entry) + pieces.capacity() * sizeof(LitPiece) +
           (marks.capacity() + near.capacity()) * sizeof(std::uint32_t);
  }
  void fit() {
    nodes.shrink_to_fit(), entries.shrink_to_fit(), pieces.shrink_to_fit(), marks.shrink_to_fit(), near.shrink_to_fit();
  }
};

struct Work {
  std::uint64_t cells = 0, pairs_tested = 0, pairs_clipped = 0, splits = 0, lit = 0, shadowed = 0, near = 0;
  Work& operator+=(const Work& w) {
    cells += w.cells, pairs_tested += w.pairs_tested, pairs_clipped += w.pairs_clipped, splits += w.splits;
    lit += w.lit, shadowed += w.shadowed, near += w.near;
    return *this;
  }
};

/// Clips the triangles of a cell by one another.
class CellClipper {
 public:
  CellClipper(const Triangles& triangles, int face) : triangles_(triangles), space_(triangles.space()), face_(face) {}

  /// Takes the triangles of a cell that is grown by `margin`, in rising order, and clips receivers by casters, nearest first.
  /// For points (`is_detail` false) casters near a receiver's plane are only noted; otherwise they are cut with, their own
  /// plane too. Calls done(member, lit pieces) for each receiver, and dark(triangle, corners) for each part in shadow.
  template <class Done, class Dark>
  void clip(const Node& cell, double margin, bool is_detail, std::span<const std::uint32_t> ids, Done&& done, Dark&& dark);

  struct Member {
    std::uint32_t triangle;
    std::uint32_t first, count;  ///< corners of what the cell sees
    double nearest, farthest;    ///< depths of these
    double u0, v0, u1, v1;       ///< a box around their places
    ClipPlane planes[4];         ///< three shadow planes and its own, positive where it shades
    double reach;                ///< how far a point that belongs here may be from its ray's place on the triangle
    bool casts, receives, doubtful;
    bool has_pieces = false, asks = false;
    std::uint32_t clips = 0;
    std::uint32_t first_near = 0, near_count = 0;
  };
  std::span<const Member> members() const { return members_; }
  std::span<const std::uint32_t> near_of(const Member& m) const { return {near_.data() + m.first_near, m.near_count}; }
  const Work& work() const { return work_; }

 private:
  std::span<const Corner> polygon_of(const Member& m) const { return {corners_.data() + m.first, m.count}; }
  void gather(const Node& cell, double margin, std::span<const std::uint32_t> ids);
  enum class Verdict { apart, cuts, near };
  Verdict judge(const Member& receiver, const Member& caster);
  /// Whether the caster's planes and those of the receiver's own edges keep them apart, but for epsilon.
  bool are_apart(const Member& receiver, const Member& caster) const;

  const Triangles& triangles_;
  const LightSpace& space_;
  int face_;
  std::vector<Member> members_;
  std::vector<Corner> corners_;
  std::vector<std::uint32_t> order_, casters_, near_;
  Pieces pieces_;
  Work work_;
};

inline void CellClipper::gather(const Node& cell, double margin, std::span<const std::uint32_t> ids) {
  members_.clear(), corners_.clear(), near_.clear();
  const double epsilon = space_.epsilon();
  const double u0 = cell.u0 - margin, v0 = cell.v0 - margin, u1 = cell.u1 + margin, v1 = cell.v1 + margin;
  ClipPlane borders[4] = {space_.border(face_, 0, u0), space_.border(face_, 0, u1), space_.border(face_, 1, v0),
                          space_.border(face_, 1, v1)};
  for (const int k : {1, 3}) borders[k].normal = -borders[k].normal, borders[k].offset = -borders[k].offset;
  for (const std::uint32_t id : ids) {
    Corner polygon[2][8];
    double values[8];
    std::size_t count = 3;
    int at = 0;
    for (int k = 0; k < 3; ++k) polygon[0][k] = {glm::dvec3(triangles_[id].points[k])};
    for (int k = 0; k < 4 && count > 0; ++k) {
      const Lies lies = classify({polygon[at], count}, borders[k], epsilon, values);
      if (lies == Lies::positive) continue;
      if (lies != Lies::across) {
        count = 0;
        break;
      }
      Corner lost[8];
      count = cut_polygon({polygon[at], count}, values, epsilon, 0, lost, polygon[1 - at]).positive;
      at = 1 - at;
    }
    // A doubtful triangle may be anywhere.
    const bool is_doubtful = triangles_.is(id, Triangles::doubtful);
    if (count == 0 && !is_doubtful) continue;
    Member m;
    m.triangle = id, m.first = static_cast<std::uint32_t>(corners_.size()), m.count = static_cast<std::uint32_t>(count);
    corners_.insert(corners_.end(), polygon[at], polygon[at] + count);
    m.casts = triangles_.is(id, Triangles::casts), m.receives = triangles_.is(id, Triangles::receives);
    m.doubtful = is_doubtful;
    m.nearest = INFINITY, m.farthest = -INFINITY;
    double low_u = INFINITY, low_v = INFINITY, high_u = -INFINITY, high_v = -INFINITY, steepest = INFINITY;
    for (int k = 0; k < 3; ++k) m.planes[k] = triangles_.side(id, k).unit();
    m.planes[3] = triangles_.cap(id).unit();
    const double height = space_.is_parallel() ? std::abs(glm::dot(m.planes[3].normal, glm::dvec3(space_.light()))) /
                                                     glm::length(glm::dvec3(space_.light()))
                                               : std::abs(m.planes[3].at(glm::dvec3(space_.light())));
    for (const Corner& corner : polygon_of(m)) {
      Seen s = space_.seen(face_, corner.at);
      m.nearest = std::min(m.nearest, s.depth), m.farthest = std::max(m.farthest, s.depth);
      if (!space_.is_parallel()) {
        steepest = std::min(steepest, height / glm::distance(corner.at, glm::dvec3(space_.light())));
        if (!(s.depth > 0x1p-30 * space_.extent())) low_u = u0, low_v = v0, high_u = u1, high_v = v1;
      }
      low_u = std::min(low_u, s.u), high_u = std::max(high_u, s.u), low_v = std::min(low_v, s.v),
      high_v = std::max(high_v, s.v);
    }
    if (space_.is_parallel()) steepest = height;
    m.reach = space_.rounding() / steepest;
    m.u0 = std::max(low_u, u0), m.u1 = std::min(high_u, u1), m.v0 = std::max(low_v, v0), m.v1 = std::min(high_v, v1);
    if (is_doubtful) m.nearest = -INFINITY, m.farthest = INFINITY, m.u0 = u0, m.v0 = v0, m.u1 = u1, m.v1 = v1;
    members_.push_back(m);
  }
}

inline bool CellClipper::are_apart(const Member& receiver, const Member& caster) const {
  const double epsilon = space_.epsilon();
  const std::span<const Corner> polygon = polygon_of(receiver);
  for (int k = 0; k < 3; ++k) {
    double most = -INFINITY;
    for (const Corner& corner : polygon) most = std::max(most, caster.planes[k].at(corner.at));
    if (most <= epsilon) return true;
  }
  if (receiver.doubtful) return false;
  for (int k = 0; k < 3; ++k) {
    double most = -INFINITY;
    for (const glm::vec3& p : triangles_[caster.triangle].points) most = std::max(most, receiver.planes[k].at(glm::dvec3(p)));
    if (most <= epsilon) return true;
  }
  return false;
}

inline CellClipper::Verdict CellClipper::judge(const Member& receiver, const Member& caster) {
  if (caster.doubtful) return triangles_.are_coplanar(receiver.triangle, caster.triangle) ? Verdict::apart : Verdict::near;
  double least = INFINITY, most = -INFINITY;
  for (const Corner& corner : polygon_of(receiver)) {
    const double value = caster.planes[3].at(corner.at);
    least = std::min(least, value), most = std::max(most, value);
  }
  if (most < -receiver.reach) return Verdict::apart;
  if (are_apart(receiver, caster)) return Verdict::apart;
  if (least > receiver.reach) return Verdict::cuts;
  // Only what the caster may shade counts.
  const std::span<const Corner> part = pieces_.part_inside(polygon_of(receiver), {caster.planes, 3}, space_.epsilon());
  if (part.empty()) return Verdict::apart;
  least = INFINITY, most = -INFINITY;
  for (const Corner& corner : part) {
    const double value = caster.planes[3].at(corner.at);
    least = std::min(least, value), most = std::max(most, value);
  }
  if (most < -receiver.reach) return Verdict::apart;
  if (least > receiver.reach) return Verdict::cuts;
  return triangles_.are_coplanar(receiver.triangle, caster.triangle) ? Verdict::apart : Verdict::near;
}

template <class Done, class Dark>
void CellClipper::clip(const Node& cell, double margin, bool is_detail, std::span<const std::uint32_t> ids, Done&& done,
                       Dark&& dark) {
  ++work_.cells;
  gather(cell, margin, ids);
  order_.resize(members_.size());
  for (std::uint32_t i = 0; i < order_.size(); ++i) order_[i] = i;
  std::ranges::sort(order_, [&](std::uint32_t a, std::uint32_t b) {
    return members_[a].nearest != members_[b].nearest ? members_[a].nearest < members_[b].nearest : a < b;
  });
  casters_.clear();
  for (const std::uint32_t i : order_)
    if (members_[i].casts) casters_.push_back(i);
  const double epsilon = space_.epsilon();
  for (const std::uint32_t i : order_) {
    Member& receiver = members_[i];
    receiver.first_near = static_cast<std::uint32_t>(near_.size());
    receiver.asks = receiver.doubtful && !is_detail;
    if (receiver.asks || receiver.count == 0) continue;
    if (!receiver.receives && !receiver.casts) continue;
    pieces_.start(polygon_of(receiver));
    bool is_touched = false;
    const double farthest = receiver.farthest + receiver.reach;
    for (const std::uint32_t j : casters_) {
      const Member& caster = members_[j];
      if (caster.nearest >= farthest) break;
      if (j == i || caster.u0 > receiver.u1 || caster.u1 < receiver.u0 || caster.v0 > receiver.v1 || caster.v1 < receiver.v0)
        continue;
      ++work_.pairs_tested;
      const Verdict verdict = judge(receiver, caster);
      if (verdict == Verdict::apart) continue;
      if (verdict == Verdict::near && !is_detail) {
        near_.push_back(caster.triangle);
        ++receiver.near_count;
        continue;
      }
      const Pieces::Cut cut = pieces_.take({caster.planes, verdict == Verdict::near ? 4u : 3u}, caster.triangle, epsilon,
                                           [&](std::span<const Corner> part) { dark(receiver, part); });
      if (cut.shadowed == 0) continue;
      is_touched = true;
      ++receiver.clips, ++work_.pairs_clipped;
      work_.splits += cut.splits, work_.shadowed += cut.shadowed;
      if (pieces_.size() == 0) break;
    }
    receiver.has_pieces = is_touched;
    work_.lit += pieces_.size(), work_.near += receiver.near_count;
    // What is dark throughout shades nothing that is not in shadow without it.
    if (pieces_.size() == 0 && receiver.casts) std::erase(casters_, i);
    if (receiver.receives) done(receiver, pieces_);
  }
}

}  // namespace gnomon::two_pass_object
