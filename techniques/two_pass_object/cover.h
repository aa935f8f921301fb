#pragma once
#include "footprint.h"
#include "pieces.h"

namespace gnomon::two_pass_object {

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
  template <class PlanesOf>
  void take(const SceneLightSpace& space, int face, const Places& cell, double depth, PlanesOf&& planes_of) {
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

}  // namespace gnomon::two_pass_object
