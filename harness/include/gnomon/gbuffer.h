#pragma once
#include <gnomon/scene.h>

#include <memory>
#include <span>

namespace gnomon {

inline constexpr std::uint32_t no_mesh = 0xffffffffu;

/// What the eye sees through pixel centers, made once per view and given to every technique. Struct of arrays, row-major,
/// pixel (0,0) top left, sample points at +0.5. `position` is the point every technique must decide: recomputed in double on
/// the receiver's triangle plane or shape, then rounded. `normal` is the unit geometric normal turned toward the eye: winding
/// never decides anything. Background pixels have mesh == no_mesh, position and normal zero. The arrays belong to `storage`.
struct GBuffer {
  View view;
  Truth truth = Truth::shape;
  int width = 0, height = 0;
  std::span<const float> px, py, pz;        ///< position, meters
  std::span<const float> nx, ny, nz;        ///< normal
  std::span<const std::uint32_t> mesh;      ///< index into Scene::meshes, or no_mesh
  std::span<const std::uint32_t> triangle;  ///< index into Mesh::triangles; 0 on an exact curved shape
  std::shared_ptr<const void> storage;

  std::size_t size() const { return static_cast<std::size_t>(width) * height; }
  bool is_background(std::size_t i) const { return mesh[i] == no_mesh; }
  glm::vec3 position(std::size_t i) const { return {px[i], py[i], pz[i]}; }
  glm::vec3 normal(std::size_t i) const { return {nx[i], ny[i], nz[i]}; }
};

/// Whether pixel i must be decided at all: not background, on a mesh that receives, turned toward the light, inside the spot
/// cone; of a light with area, with some of it above the horizon (LightFigure::is_seen). The rest are classes B and F, and
/// their mask is 1.
bool faces_light(const Scene& scene, const GBuffer& gbuffer, const Light& light, std::size_t i);

/// A technique's answer: 1 lit, 0 umbra, between penumbra; cast shadows only. Pixels that do not face the light are 1.
/// It lives in memory or in a GL texture, whichever the technique requested last; texel (x,y) is pixel (x,y).
class VisibilityMask {
 public:
  VisibilityMask(int width, int height);
  ~VisibilityMask();
  VisibilityMask(const VisibilityMask&) = delete;
  VisibilityMask& operator=(const VisibilityMask&) = delete;

  int width() const { return width_; }
  int height() const { return height_; }
  /// Memory to write, row-major; contents are those of the last read or write.
  std::span<float> pixels();
  /// Name of a GL texture (R32F, width x height, one level) to render into. Needs a current context.
  unsigned texture();
  /// The finished mask in memory; reads the texture back if the answer lives there. Outside the timed stages.
  std::span<const float> read();

 private:
  int width_, height_;
  std::vector<float> pixels_;
  unsigned texture_ = 0;
  bool in_texture_ = false;
};

}  // namespace gnomon
