#pragma once
#include <functional>

#include "cover.h"
#include "patch.h"

namespace gnomon::two_pass_object {

/// Clips the triangles of a cell by one another.
class CellClipper {
 public:
  CellClipper(const Triangles& triangles, int face) : triangles_(triangles), space_(triangles.space()), face_(face) {}

  struct Member {
    enum class State : std::uint8_t { waiting, absent, hidden, dark, lit, cut, asks };
    std::uint32_t triangle;
    Places box;  ///< around its places in the cell
    bool casts, receives, doubtful;
    State state;                 ///< absent: not in the cell; hidden: beyond what covers its places; cut: something took a part
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
            const Dark& dark);

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
  void start(const Node& cell, double margin, std::span<const Footprint* const> footprints);
  Member& known(std::uint32_t index);
  void cut_to_cell(Member& m);
  void add_casters(double depth);
  void clip(std::uint32_t index, bool is_detail, const Done& done, const Dark& dark);
  enum class Verdict { apart, cuts, near };
  Verdict judge(const Member& receiver, const Member& caster);
  /// Whether the caster's planes and those of the receiver's own edges keep them apart, but for epsilon.
  bool are_apart(const Member& receiver, const Member& caster) const;

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
