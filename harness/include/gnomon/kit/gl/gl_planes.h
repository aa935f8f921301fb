#pragma once
#include <gnomon/kit/geometry/planes.h>
#include <gnomon/kit/gl/gl_pass.h>

namespace gnomon {

/// The receiver planes of a scene, and of every pixel the one that it lies on, in memory and for shaders.
class PlaneLookup {
 public:
  /// Needs a current context.
  void build(const Scene& scene, double min_share);
  const ReceiverPlanes& planes() const { return planes_; }
  /// Of each plane's receivers.
  const std::vector<Bounds>& bounds() const { return bounds_; }
  /// The plane of a pixel that is no background, or no_plane. Under shape truth curved shapes lie on none, whatever their
  /// triangles say.
  std::uint32_t plane_of(const GBuffer& gbuffer, std::size_t pixel) const;
  /// For `plane_lookup_snippet`: shader storage 0 and 1.
  void bind(Truth truth) const;
  /// What the shader needs of the device.
  static GlLimits needs(const Scene& scene);
  std::size_t bytes() const;

 private:
  ReceiverPlanes planes_;
  std::vector<Bounds> bounds_;
  std::vector<std::uint8_t> is_off_;  ///< of each mesh: curved under shape truth, and not flat for all that
  Buffer plane_of_, plane_of_shapes_, first_triangle_;
};

/// Fragment shader code: `uint receiver_plane(uvec2 ids)` of what `ids_here()` gives where it is no background; 0xffffffff
/// where there is none.
extern const std::string_view plane_lookup_snippet;

}  // namespace gnomon
