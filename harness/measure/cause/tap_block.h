#pragma once
#include "measure/cause/causes.h"
#include "measure/frame/light_rays.h"

namespace gnomon {

/// One wrong pixel on its way through the steps.
struct TapQuestion {
  std::uint32_t pixel, mesh;  ///< mesh: the receiver
  const Explanation* why;
  bool is_missing;  ///< see ExplainedPixel
  bool is_dark;     ///< false dark; else false lit
  double visibility, reference;
  glm::dvec3 point, normal, to_light;  ///< to_light is unit
  double reach;                        ///< two texel diagonals, meters
  glm::dvec3 shift{0};                 ///< from the point to where the shifted look-up's ray cuts the tangent plane
  std::size_t first_tap = 0;           ///< in the block's flat list

  AnswerKind kind = AnswerKind::binary;

  /// One half is dark; sums of weights are of floats. Behind transmission: nearer to the technique's answer than to the right
  /// one.
  bool is_on_technique_side(double v) const {
    if (kind == AnswerKind::transmitted) return std::abs(v - visibility) < std::abs(v - reference);
    return (v > 0.5 + 1e-6) != is_dark;
  }
  std::size_t tap_count() const { return why->taps.size(); }
};

/// A few questions at once, so that their rays fill packets.
struct TapBlock {
  const LightRays& rays;
  double grid;  ///< of the raster, texels
  std::vector<TapQuestion> questions{};
  std::vector<glm::dvec3> places{};  ///< of all taps of all questions, on their tangent planes
  std::vector<float> seen{};         ///< what part of the light arrives there

  /// The place of tap j on the tangent plane with its ray moved by the grid's side and float32 rounding, four ways.
  std::array<glm::dvec3, 4> shaken(const TapQuestion& q, std::size_t j) const;
};

/// What the taps of a question store, and what is wrong with that where a perfect map would be right.
class StoredTaps {
 public:
  StoredTaps(const TapBlock& block, const TapQuestion& question) : rays_(block.rays), block_(block), q_(question) {}

  /// Whether a tap stores anything before the receiver but the receiver itself.
  bool holds_caster() const;
  /// A perfect map would be on the other side: of lit or of dark.
  Cause cause() const { return q_.is_dark ? of_false_dark() : of_false_lit(); }
  /// False lit where the light's point is seen from the pixel and hidden at the taps: by what covers those.
  Cause of_taps_alone() const;

 private:
  /// The surface that a tap's depth was drawn from. A depth that lies on none, as the midpoint of two does, has the first
  /// surface on the tap's ray, if that lies before it.
  struct Stored {
    std::uint32_t mesh = no_mesh;
    glm::dvec3 at{0};
  };
  const glm::dvec3& place(std::size_t j) const { return block_.places[q_.first_tap + j]; }
  double behind(std::size_t j, bool is_from_plane) const;
  bool compares_with_plane() const;
  std::vector<std::size_t> guilty(bool is_from_plane) const;
  bool is_covered_nearby(std::size_t j) const;
  std::uint32_t stored_mesh(std::size_t j) const;
  Stored stored_surface(std::size_t j) const;
  double own_reach() const;
  Cause of_false_dark() const;
  Cause of_false_lit() const;

  const LightRays& rays_;
  const TapBlock& block_;
  const TapQuestion& q_;
};

}  // namespace gnomon
