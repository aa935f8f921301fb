#pragma once
#include <gnomon/kit/gl/gl.h>

namespace gnomon {

/// The pass that a data sheet names as its floor, made ready to be drawn again and again: About::floor says what each does. All
/// have the picture's size, whatever the size of a technique's own images. Needs a current context in the house state; scene
/// and G-buffer outlive it. Throws Error for Floor::none.
class BarePass {
 public:
  BarePass(Floor floor, const Scene& scene, const GBuffer& gbuffer);
  /// So many times one after the other; does not wait for the device.
  void draw(int times = 1) const;
  /// What the last one left, one number a pixel, row after row: depth, or what was written or copied.
  std::vector<float> read() const;

 private:
  Floor floor_;
  const Scene& scene_;
  const GBuffer& gbuffer_;
  Texture from_, target_;
  Framebuffer framebuffer_;
  Program program_;
  std::vector<std::uint32_t> meshes_;
};

}  // namespace gnomon
