#pragma once
#include <gnomon/kit/pictures/lines.h>
#include <gnomon/kit/shared.h>
#include <gnomon/kit/volumes/volume_faces.h>

namespace gnomon {

/// What techniques share that let the rasterizer count the shadow volumes of triangles: the debug layers `volumes`, `counts`
/// and `silhouette`, and the work of a pass. A technique sets the protected members in its stages and draws in `draw`.
class VolumeTechnique : public Technique {
 public:
  std::vector<DebugLayer> debug_layers() const override;
  std::vector<float> draw_debug(std::string_view layer) const override;

 protected:
  using Pass = VolumeCounter::Pass;

  /// Begins a pass, draws every face, and leaves the pass open.
  virtual void draw(Pass pass) const = 0;
  /// The mask of `gbuffer_`.
  virtual void answer(VisibilityMask& mask) const;
  /// The lines of the layer `silhouette`.
  virtual std::vector<Line> outlines() const { return silhouette_lines(made_->adjacency, silhouette()); }

  /// Of the last relight, in memory.
  virtual const Silhouette& silhouette() const { return silhouette_; }
  /// Of what the techniques share, for the count "bytes". The wide picture where the mask is counted in it.
  std::size_t bytes() const {
    const std::size_t shared_bytes = made_->adjacency.bytes() + (keeps_wide() ? made_->counter.wide_bytes() : 0);
    return static_cast<std::size_t>(made_.own(static_cast<double>(shared_bytes))) + silhouette().bytes() + faces_.bytes();
  }
  /// What the stencil cannot tell, by a pass in 32 bits that is thrown away.
  VolumeCounter::Work measure_work() const;
  static Pass pass_of(bool wide) { return wide ? Pass::wide : Pass::stencil; }
  Pass mask_pass() const { return pass_of(wide_); }
  /// Whether a mask counts in the wide picture, so that it stays from one to the next.
  virtual bool keeps_wide() const { return wide_; }
  const FarPlanes* ends() const { return ends_early_ ? &made_->far_planes : nullptr; }
  /// Binds faces to the drawer as `gbuffer_` sees them; `positions` are those of their adjacency.
  void bind_faces(const Buffer& positions, const FaceBuffers& faces) const;
  void bind_faces(const Buffer& positions) const { bind_faces(positions, faces_); }

  struct Made {
    VolumeCounter counter;
    FaceDrawer drawer;
    const Scene* scene = nullptr;
    EdgeAdjacency adjacency;
    FarPlanes far_planes;
  };
  Shared<Made> made_;
  const GBuffer* gbuffer_ = nullptr;
  Light light_;
  mutable Silhouette silhouette_;  ///< read it by `silhouette()`
  FaceBuffers faces_;
  FaceCommands commands_;
  bool ends_early_ = false;  ///< volumes end on far planes, as far as they can
  bool wide_ = false;        ///< the mask is counted in 32 bits instead of the stencil's eight
};

}  // namespace gnomon
