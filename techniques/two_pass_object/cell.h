#pragma once
#include <gnomon/kit/add_up.h>

#include <functional>

#include "grid.h"
#include "pieces.h"

namespace gnomon::two_pass_object {

/// Work of making a map. `lit` and `shadowed` are the fragments that clipping leaves and takes away.
struct Work {
  std::uint64_t cells = 0, pairs_tested = 0, pairs_clipped = 0, splits = 0, lit = 0, shadowed = 0, near = 0;
  std::uint64_t hidden = 0;  ///< triangles beyond what covers their places in a cell: no fragments, for they are not clipped
  Work& operator+=(const Work& w) {
    return add_up(*this, w, &Work::cells, &Work::pairs_tested, &Work::pairs_clipped, &Work::splits, &Work::lit, &Work::shadowed,
                  &Work::near, &Work::hidden);
  }
};

/// The part of a cell that no caster covers yet: the cell is one more receiver, behind everything, and the shadows of casters
/// are taken away from it in the order of their far ends. Once nothing is left, all that lies beyond is in shadow.
class Cover {
 public:
  void start() {
    casters_.clear();
    next_ = taken_ = 0;
    area_ = expected_ = 0;
    is_started_ = false;
  }
  /// Adds a caster that lies before `farthest` and covers `area` of the places at most.
  void expect(double farthest, double area, std::uint32_t member) {
    casters_.push_back({farthest, area, member});
    expected_ += area;
  }

  /// Takes away the shadows of the casters before a depth, as soon as they may cover the cell. Depths must not fall from call
  /// to call. planes_of(member) gives the shadow planes of a caster, none if it is not in the cell.
  void take(const SceneLightSpace& space, int face, const Places& cell, double depth, const auto& planes_of) {
    if (expected_ < cell.area()) return;
    if (next_ == 0) std::sort(casters_.begin(), casters_.end());
    for (; next_ < casters_.size() && casters_[next_].farthest < depth; ++next_) area_ += casters_[next_].area;
    if (!is_started_) {
      if (area_ < cell.area()) return;
      is_started_ = true;
      Corner corners[4];
      const double deep = space.deepest();
      for (int k = 0; k < 4; ++k)
        corners[k] = {space.point_at(face, {k == 0 || k == 3 ? cell.u0 : cell.u1, k < 2 ? cell.v0 : cell.v1, deep})};
      pieces_.start(corners);
    }
    for (; taken_ < next_ && pieces_.size() > 0 && pieces_.size() < most_pieces; ++taken_)
      if (const std::span<const ClipPlane> planes = planes_of(casters_[taken_].member); !planes.empty())
        pieces_.take(planes, 0, space.epsilon(), [](std::span<const Corner>) {});
  }

  bool is_closed() const { return is_started_ && pieces_.size() == 0; }
  /// Whether one of a triangle's shadow planes keeps it apart from every open piece.
  bool hides(std::span<const ClipPlane> planes, double epsilon) const {
    if (!is_started_) return false;
    for (std::size_t i = 0; i < pieces_.size(); ++i)
      if (!is_outside(pieces_[i], planes, epsilon)) return false;
    return true;
  }

 private:
  /// Small casters with gaps between them make many pieces. No more are cut then: the cover is smaller than it could be, and
  /// true.
  static constexpr std::size_t most_pieces = 24;
  struct Caster {
    double farthest, area;
    std::uint32_t member;
    bool operator<(const Caster& other) const {
      return farthest != other.farthest ? farthest < other.farthest : member < other.member;
    }
  };

  std::vector<Caster> casters_;
  std::size_t next_ = 0, taken_ = 0;
  double area_ = 0, expected_ = 0;  // of the casters up to `next_`, and of all
  bool is_started_ = false;
  Pieces pieces_;
};

/// Clips the triangles of a cell by one another.
class CellClipper {
 public:
  CellClipper(const Triangles& triangles, int face) : triangles_(triangles), space_(triangles.space()), face_(face) {}

  struct Member {
    enum class State : std::uint8_t { waiting, absent, hidden, dark, lit, cut, exact };
    std::uint32_t triangle;
    Places box;  ///< around its places in the cell
    bool casts, receives, doubtful;
    State state;                 ///< absent: not in the cell; hidden: beyond what covers its places; cut: casters took parts
    bool is_known;               ///< whether the members below are set
    std::uint32_t first, count;  ///< corners of what the cell sees
    double nearest, farthest;    ///< depths of these
    double reach;                ///< how far a point that belongs here may be from its ray's place on the triangle
    ClipPlane planes[4];         ///< three shadow planes and its own, positive where it shades
    std::uint32_t clips;
    std::uint32_t first_near, near_count;
    /// The shadow planes; none where the triangle is not in the cell.
    std::span<const ClipPlane> sides() const { return {planes, state == State::absent ? 0u : 3u}; }
  };

  /// Called for each receiver that is clipped, with its lit pieces, and for each part that is put in shadow.
  using Done = std::function<void(std::uint32_t index, const Pieces& lit)>;
  using Dark = std::function<void(const Member& member, std::span<const Corner> part)>;
  /// Takes the footprints of a cell that is grown by `margin`, and clips receivers by casters, nearest first. For points
  /// (`is_detail` false) casters near a receiver's plane are only noted; otherwise they are cut with, their own plane too, and
  /// hidden triangles are called dark.
  void clip(const Node& cell, double margin, bool is_detail, std::span<const Footprint* const> footprints, const Done& done,
            const Dark& dark) {
    ++work_.cells;
    start(cell, margin, footprints);
    for (const auto& [nearest, i] : order_) {
      Member& m = members_[i];
      cover_.take(space_, face_, places_, nearest, [&](std::uint32_t caster) { return known(caster).sides(); });
      if (is_detail || !cover_.is_closed()) known(i);
      if (m.state == State::absent) continue;
      if (cover_.is_closed() || (!m.doubtful && cover_.hides(m.sides(), space_.epsilon()))) {
        m.state = State::hidden;
        ++work_.hidden;
        if (is_detail) dark(m, polygon_of(m));
      } else if (m.doubtful && !is_detail) {
        m.state = State::exact;
      } else if (m.count > 0) {
        clip(i, is_detail, done, dark);
      }
      // A triangle wholly in shadow shades nothing that is lit without it.
      if (m.casts && (m.state == State::hidden || m.state == State::dark)) std::erase(casters_, i);
    }
  }

  /// One for each footprint, in their order.
  std::span<const Member> members() const { return {members_.data(), order_.size()}; }
  std::span<const std::uint32_t> near_of(const Member& m) const { return {near_.data() + m.first_near, m.near_count}; }
  const Work& work() const { return work_; }

 private:
  using State = Member::State;
  struct Start {
    double nearest;  ///< no point of it is nearer
    std::uint32_t member;
    bool operator<(const Start& other) const {
      return nearest != other.nearest ? nearest < other.nearest : member < other.member;
    }
  };
  std::span<const Corner> polygon_of(const Member& m) const { return {corners_.data() + m.first, m.count}; }
  void start(const Node& cell, double margin, std::span<const Footprint* const> footprints) {
    corners_.clear();
    near_.clear();
    casters_.clear();
    order_.clear();
    next_caster_ = 0;
    cover_.start();
    places_ = cell.box.grown(margin);
    const double at[] = {places_.u0, places_.u1, places_.v0, places_.v1};
    for (int k = 0; k < 4; ++k) borders_[k] = k % 2 ? -space_.border(face_, k / 2, at[k]) : space_.border(face_, k / 2, at[k]);
    if (members_.size() < footprints.size()) members_.resize(footprints.size());
    for (std::uint32_t i = 0; i < footprints.size(); ++i) {
      const Footprint& f = *footprints[i];
      Member& m = members_[i];
      m.triangle = f.triangle;
      m.box = f.box.within(places_);
      m.casts = triangles_.is(f.triangle, Triangles::casts);
      m.receives = triangles_.is(f.triangle, Triangles::receives);
      m.doubtful = triangles_.is(f.triangle, Triangles::doubtful);
      m.state = State::waiting;
      m.is_known = false;
      m.first = m.count = m.clips = m.first_near = m.near_count = 0;
      const Depths d = depths(space_, f, m.box);
      order_.push_back({d.nearest, i});
      if (m.casts && d.farthest < INFINITY) cover_.expect(d.farthest, std::min(f.area, m.box.area()), i);
    }
    std::sort(order_.begin(), order_.end());
  }

  /// A member with what the cell sees of it and its planes, computed at the first request.
  Member& known(std::uint32_t index) {
    Member& m = members_[index];
    if (m.is_known) return m;
    m.is_known = true;
    cut_to_cell(m);
    if (m.count == 0 && !m.doubtful) {
      m.state = State::absent;
      return m;
    }
    for (int k = 0; k < 3; ++k) m.planes[k] = triangles_.side(m.triangle, k).unit();
    m.planes[3] = triangles_.cap(m.triangle).unit();
    const double height = std::abs(space_.height(m.planes[3]));
    double steepest = space_.is_parallel() ? height : INFINITY;
    m.nearest = INFINITY;
    m.farthest = -INFINITY;
    Places box;
    for (const Corner& corner : polygon_of(m)) {
      const PlaceAndDepth s = space_.seen(face_, corner.at);
      m.nearest = std::min(m.nearest, s.depth);
      m.farthest = std::max(m.farthest, s.depth);
      if (!space_.is_parallel()) {
        steepest = std::min(steepest, height / glm::distance(corner.at, glm::dvec3(space_.light())));
        if (!space_.has_place(s.depth)) box = places_;
      }
      box.add(s);
    }
    m.reach = space_.rounding() / steepest;
    m.box = box.within(places_);
    // A doubtful triangle may be anywhere.
    if (m.doubtful) {
      m.nearest = -INFINITY;
      m.farthest = INFINITY;
      m.box = places_;
    }
    return m;
  }

  void cut_to_cell(Member& m) {
    clipper_.start();
    for (const glm::vec3& p : triangles_[m.triangle].points) clipper_.add({p});
    for (const ClipPlane& border : borders_)
      if (!has_inside(clipper_.keep_positive(border, space_.epsilon()))) return;
    const std::span<const Corner> seen = clipper_.corners();
    m.first = static_cast<std::uint32_t>(corners_.size());
    m.count = static_cast<std::uint32_t>(seen.size());
    corners_.insert(corners_.end(), seen.begin(), seen.end());
  }

  /// Adds casters that may lie nearer than a depth.
  void add_casters(double depth) {
    for (; next_caster_ < order_.size() && order_[next_caster_].nearest < depth; ++next_caster_) {
      const std::uint32_t i = order_[next_caster_].member;
      if (!members_[i].casts || members_[i].state == State::hidden || members_[i].state == State::dark) continue;
      if (known(i).state != State::absent) casters_.push_back(i);
    }
  }
  void clip(std::uint32_t index, bool is_detail, const Done& done, const Dark& dark) {
    const double farthest = members_[index].farthest + members_[index].reach;
    add_casters(farthest);
    Member& receiver = members_[index];
    receiver.first_near = static_cast<std::uint32_t>(near_.size());
    pieces_.start(polygon_of(receiver));
    receiver.state = State::lit;
    for (const std::uint32_t j : casters_) {
      const Member& caster = members_[j];
      if (j == index || caster.nearest >= farthest || caster.box.misses(receiver.box)) continue;
      ++work_.pairs_tested;
      const Verdict verdict = judge(receiver, caster);
      const bool is_near = verdict == Verdict::near;
      if (verdict == Verdict::apart) continue;
      if (is_near && !is_detail) {
        near_.push_back(caster.triangle);
        ++receiver.near_count;
        continue;
      }
      const Pieces::Cut cut = pieces_.take({caster.planes, is_near ? 4u : 3u}, caster.triangle, space_.epsilon(),
                                           [&](std::span<const Corner> part) { dark(receiver, part); });
      if (cut.shadowed == 0) continue;
      receiver.state = State::cut;
      ++receiver.clips;
      ++work_.pairs_clipped;
      work_.splits += cut.splits;
      work_.shadowed += cut.shadowed;
      if (pieces_.size() == 0) break;
    }
    if (pieces_.size() == 0) receiver.state = State::dark;
    work_.lit += pieces_.size();
    work_.near += receiver.near_count;
    if (receiver.receives) done(index, pieces_);
  }

  enum class Verdict { apart, cuts, near };
  Verdict judge(const Member& receiver, const Member& caster) {
    if (caster.doubtful) return triangles_.are_coplanar(receiver.triangle, caster.triangle) ? Verdict::apart : Verdict::near;
    const auto heights = [&](std::span<const Corner> polygon) {
      double least = INFINITY, most = -INFINITY;
      for (const Corner& corner : polygon) {
        const double value = caster.planes[3].at(corner.at);
        least = std::min(least, value);
        most = std::max(most, value);
      }
      return std::pair(least, most);
    };
    const auto [least, most] = heights(polygon_of(receiver));
    if (most < -receiver.reach || are_apart(receiver, caster)) return Verdict::apart;
    if (least > receiver.reach) return Verdict::cuts;
    // Only what the caster may shade counts.
    const std::span<const Corner> part = pieces_.part_inside(polygon_of(receiver), {caster.planes, 3}, space_.epsilon());
    const auto [least_of_part, most_of_part] = heights(part);
    if (part.empty() || most_of_part < -receiver.reach) return Verdict::apart;
    if (least_of_part > receiver.reach) return Verdict::cuts;
    return triangles_.are_coplanar(receiver.triangle, caster.triangle) ? Verdict::apart : Verdict::near;
  }

  /// Whether the caster's planes and those of the receiver's own edges keep them apart, but for epsilon.
  bool are_apart(const Member& receiver, const Member& caster) const {
    if (is_outside(polygon_of(receiver), {caster.planes, 3}, space_.epsilon())) return true;
    const glm::vec3* const p = triangles_[caster.triangle].points;
    const Corner corners[] = {{p[0]}, {p[1]}, {p[2]}};
    return !receiver.doubtful && is_outside(corners, {receiver.planes, 3}, space_.epsilon());
  }

  const Triangles& triangles_;
  const SceneLightSpace& space_;
  int face_;
  Places places_{};         // of the cell and its margin
  ClipPlane borders_[4]{};  // positive inside
  std::vector<Member> members_;
  std::vector<Start> order_;
  std::size_t next_caster_ = 0;         // in order_
  std::vector<std::uint32_t> casters_;  // those before next_caster_ that are not in shadow throughout
  std::vector<std::uint32_t> near_;
  std::vector<Corner> corners_;
  Clipper clipper_;
  Cover cover_;
  Pieces pieces_;
  Work work_;
};

}  // namespace gnomon::two_pass_object
