#pragma once
#include <gnomon/kit/gl/gl.h>
#include <gnomon/kit/maps/alpha_levels.h>
#include <gnomon/technique.h>

namespace gnomon {

/// Causes of techniques with an AlphaSetting, for their About.
inline constexpr OwnCause alpha_causes[] = {
    {"mip_level", "Alpha filtered between texels or levels of the mask, not its bit, decided.", {240, 156, 228}},
    {"hashed_threshold", "A random threshold, not the mask's bit, decided.", {252, 252, 36}},
};

/// The parameter `alpha` of techniques that draw casters with holes into maps, and what it means. A member of the technique:
///
///   AlphaSetting alpha{this, Stage::relight};
///   Support supports(...) const override { return alpha.limit(scene, Support::full()); }
class AlphaSetting {
 public:
  AlphaSetting(Parametrized* owner, Stage spoils)
      : rule_(
            owner, "alpha", "texel", {"texel", "mips", "mips_kept", "hashed"}, spoils,
            "Casters with holes: what decides for a texel of the map. texel: the mask's bit. mips: alpha between texels and "
            "levels of the mask, against the cutoff. mips_kept: the same, with levels that keep the mask's solid share. hashed: "
            "alpha against a threshold that is random for each place.") {}

  AlphaRule rule() const { return AlphaRule(rule_.index()); }
  /// What is left of `support` where the device's storage buffers must hold what the rule reads.
  Support limit(const Scene& scene, Support support) const {
    if (!support || rule() == AlphaRule::texel || !scene.has_alpha_masks()) return support;
    const auto bytes = static_cast<std::int64_t>(alpha_bytes(scene, rule()));
    const Support enough = within_limits({.fragment_storage_blocks = 1, .storage_bindings = 8, .storage_block_bytes = bytes});
    return enough ? support : enough;
  }

 private:
  Choice rule_;
};

/// At which pixels of a picture the rule of a map, not the mask's bit, decided.
class AlphaDifference {
 public:
  /// `answer` and `by_texel` are a technique's answers by its rule and by the texel's, of the same picture. Of a wrong pixel
  /// where light arrives or not the latter is right where it is on the other side of one half. Under a light with area, and in
  /// a scene with transmission, the truth has `shares`: it has a part in the error where they differ by more than 1/16, for a
  /// filter of that many texels changes by as much with one of them.
  AlphaDifference(AlphaRule rule, std::span<const float> answer, std::span<const float> by_texel, bool has_shares);
  /// One of `alpha_causes`, or nothing.
  std::string_view cause(std::size_t pixel) const { return differs_[pixel] != 0 ? cause_ : ""; }
  /// The same; at the first question `draw` makes images by the texel's rule, and `answer` gives the masks of these and of
  /// `images`.
  template <class Images>
  static std::string_view cause(std::optional<AlphaDifference>& difference, AlphaRule rule, bool has_shares, std::size_t pixel,
                                const Images& images, const auto& draw, const auto& answer) {
    if (!difference) {
      const StateGuard guard;
      Images by_texel;
      draw(by_texel);
      difference.emplace(rule, answer(images), answer(by_texel), has_shares);
    }
    return difference->cause(pixel);
  }

 private:
  std::string_view cause_;
  std::vector<std::uint8_t> differs_;
};

}  // namespace gnomon
