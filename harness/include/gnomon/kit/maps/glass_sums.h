#pragma once
#include <gnomon/kit/maps/glass_map.h>

namespace gnomon {

/// Glass maps whose texels hold sums over the glass on their rays, in any order: one pass with additive blending, in float32.
/// Absorbance, -ln(transmission), adds up where shares of light multiply. A filter averages sums, and so absorbance.
class GlassSums : public GlassMap {
 protected:
  /// The numbers of a texel, at most 32, and what they mean in GLSL, with SUM_COUNT for how many they are.
  struct Sums {
    int count;
    std::string add;    ///< `void sums_of(float t, float absorbance, out float sums[SUM_COUNT])`, of one surface
    std::string share;  ///< `float share_of(float sums[SUM_COUNT], float t)`; not called where the absorbance sums[0] is 0
    std::string constants = "";  ///< of `share`, as PassConstants
    int constant_count = 0;
  };
  virtual Sums sums() const = 0;
  virtual void set_constants(const Program&) const {}

 private:
  Method method() const final;
  void draw_glass(const GlassDrawing& glass) final;
  void bind_glass(const Program& look_up) const final;
  void release_glass() final { textures_.clear(); }
  std::size_t glass_bytes() const final;
  bool filters_absorbance() const final { return true; }

  std::vector<Texture> textures_;  // of four sums each
};

}  // namespace gnomon
