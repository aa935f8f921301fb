#pragma once
#include <gnomon/light.h>

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace gnomon {

// Biases with numbers of their own: what engines have by default, in their own units, and rules that were published with their
// numbers. Each is stated with its source. None grows with a filter, as those that are set do.

/// How the numbers of a bias are meant. One for all lights of a preset: a shader is compiled for it.
struct BiasForm {
  enum class Slope {
    none,
    raster,  ///< steps of depth from texel to texel along the steeper axis, as glPolygonOffset counts them
    tangent  ///< world widths of a texel times the tangent between normal and light, up to 1
  };
  enum class Normal {
    none,
    whole,
    sine,             ///< of the angle between normal and light
    one_less_cosine,  ///< 1 less the cosine of that angle
    across            ///< the part of the shift that lies across the light ray
  };
  Slope slope = Slope::none;
  Normal normal = Normal::none;
};

/// What is added on the way to the light.
struct BiasNumbers {
  double meters = 0;  ///< along the light ray
  double texels = 0;  ///< along the image's axis, in world widths of a texel at the point
  double slope = 0;   ///< as the form says
  double normal = 0;  ///< how far the look-up point moves, in world widths of a texel there, as the form says
};

/// A bias that has its numbers for some kinds of lights.
struct BiasPreset {
  std::string_view name;    ///< the choice of parameter `bias`
  std::string_view source;  ///< with its version
  BiasForm form{};
  std::optional<BiasNumbers> directional{}, spot{}, point{};
  std::string_view missing{};  ///< why a kind of light has no numbers; empty where all have

  /// None for a light that the preset does not define, and for lights with area.
  std::optional<BiasNumbers> numbers(const Light& light) const;
  /// Why it does not fit a light of a scene with this diagonal, meters; nothing where it does. A bias as long as the scene
  /// hides every shadow.
  std::optional<std::string> refusal(const Light& light, double diagonal) const;
};

/// In the order of the parameter's choices.
std::span<const BiasPreset> bias_presets();

/// The epsilon of adaptive depth bias, meters along the axis of the image, where the light shines straight at the surface: a
/// share of the scene's diagonal (Dou et al. 2014). It grows as 1 / cosine^2, up to `most_adaptive` times (Ehm et al. 2015).
inline constexpr double adaptive_share = 1e-4, most_adaptive = 100;

}  // namespace gnomon
