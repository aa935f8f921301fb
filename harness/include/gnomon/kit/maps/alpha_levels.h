#pragma once
#include <gnomon/kit/gl/gl.h>

namespace gnomon {

/// One level of a mask's alpha: values 0 .. 1, row after row.
struct AlphaLevel {
  int width = 0, height = 0;
  std::vector<float> alpha{};
  /// How many texels have factor * alpha >= cutoff, all in float32.
  std::size_t solid_count(float factor, float cutoff) const;
  double coverage(float factor, float cutoff) const {
    return static_cast<double>(solid_count(factor, cutoff)) / static_cast<double>(alpha.size());
  }
};

/// What a rule reads of a mask. Level 0 is its alpha, byte / 255.
///   texel      nothing
///   mips       levels down to one texel. Each has half as many texels a side as the one before, rounded down, at least one; a
///              texel is the mean of that over its own area
///   mips_kept  the same, with each level times a number, but no more than 1: the least with which as large a share of its
///              texels passes the cutoff as of level 0, or a larger one (Castano 2010)
///   hashed     level 0
std::vector<AlphaLevel> alpha_levels(const AlphaMask& mask, AlphaRule rule);

/// Bytes of what a rule reads of the masks of a scene.
std::size_t alpha_bytes(const Scene& scene, AlphaRule rule);

/// Holds what a rule reads of the masks of a scene, for shaders.
class AlphaLevels {
 public:
  /// Computes and uploads what the rule reads and is not there yet; lets go what it does not read. Where no mesh has a mask the
  /// rule is the texel's. Of one scene: a new one needs a new object.
  void use(const Scene& scene, AlphaRule rule);
  HoleTest hole_test() const { return {rule_, levels_.name()}; }
  std::size_t bytes() const { return levels_.bytes; }

 private:
  AlphaRule rule_ = AlphaRule::texel;
  Buffer levels_;
};

}  // namespace gnomon
