#pragma once
#include <gnomon/kit/maps/light_map.h>

namespace gnomon {

/// Which depth a texel of a depth image stores.
struct StoredDepth {
  enum class Kind {
    first,     ///< the first surface seen from the light
    second,    ///< the first one strictly behind that (Wang and Molnar 1994); nothing where there is none
    midpoint,  ///< half way between both (Woo 1992); nothing where there is no second one
    dual       ///< the midpoint, but no more than an offset behind the first surface (Weiskopf and Ertl 2003)
  };
  Kind kind = Kind::first;
  double offset = 0;  ///< of dual: along the axis, in widths of the texel at the first surface

  bool needs_second() const { return kind != Kind::first; }
  bool is_combined() const { return kind == Kind::midpoint || kind == Kind::dual; }
};

/// Makes midpoints and dual depth layers from images of the first and of the second surface. One serves all lights of a
/// technique.
class DepthCombination {
 public:
  /// Compiles; needs the context.
  void setup(StoredDepth::Kind kind);
  /// `target` becomes as large as `first`, and holds depth as that does. Error: that of float32, a few 2^-24 of the depth.
  void run(const LightCamera& camera, const StoredDepth& stored, const Texture& first, const Texture& second,
           Texture& target) const;

 private:
  std::array<Program, 2> programs_;  // parallel rays, and rays from a center
  Framebuffer framebuffer_;
};

}  // namespace gnomon
