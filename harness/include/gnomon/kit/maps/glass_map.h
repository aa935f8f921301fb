#pragma once
#include <gnomon/kit/geometry/exact_scene.h>
#include <gnomon/kit/maps/glass_causes.h>
#include <gnomon/kit/maps/glass_lists.h>
#include <gnomon/kit/maps/map_comparison.h>
#include <gnomon/kit/shared.h>

#include <functional>

namespace gnomon {

// Techniques that hold, for each texel of a light camera, what part of the light glass lets through down to any depth. Opaque
// casters are drawn into a plain depth map and compared as ComparedMap does; so are the opaque texels of glass. What remains of
// glass is drawn into images of the technique's own, of the same camera. The answer is the opaque one times the share.
//
// The depth t of a point is (z - near) / (far - near), with its distance z along the image's axis and near and far of the
// LightImage: linear in meters, also where rays start at the light. Glass with t below 0 counts as at 0; with t above 1 it
// lies behind all receivers and is not drawn. A point is looked up at the t of its z less the bias.

/// The glass of a camera, for `GlassMap::draw_glass`. The kit's framebuffer is bound and has no attachments, the viewport
/// covers an image, and no depth is tested: glass behind opaque casters is drawn, too.
class GlassDrawing {
 public:
  GlassDrawing(const LightCamera& camera, const Framebuffer& framebuffer, const SceneBuffers& buffers,
               const CasterPrograms& programs, const std::vector<bool>& is_glass)
      : camera(camera), framebuffer(framebuffer.name()), buffers_(buffers), programs_(programs), is_glass_(is_glass) {}
  const LightCamera& camera;
  const GLuint framebuffer;
  int resolution() const { return camera.resolution; }
  /// Images have layers 0 .. layer_count() - 1; at least 1 is to be allocated.
  int layer_count() const { return std::max(camera.layer_count, 1); }
  /// Calls visit(image) for each image with casters, also where none is of glass: its layer has to be cleared.
  void each_image(const auto& visit) const {
    for (const LightImage& image : camera.images)
      if (image.layer >= 0) visit(image);
  }
  /// Sets a uniform of the programs, where they use it.
  void set(const char* uniform, const auto& value) const { programs_.set_if_used(uniform, value); }
  /// Draws the glass of an image once, by the programs of `Method::draw`.
  void draw(const LightImage& image) const;
  /// How many triangles that were, so far.
  std::size_t drawn_triangles() const { return drawn_triangles_; }

 private:
  const SceneBuffers& buffers_;
  const CasterPrograms& programs_;
  const std::vector<bool>& is_glass_;  // by mesh
  mutable std::size_t drawn_triangles_ = 0;
};

/// What glass maps share: they differ in what a texel holds.
class GlassMap : public Technique {
 public:
  Support supports(const Scene& scene, const Light& light, const View&) const override;
  void setup() override;
  void build(const Scene& scene) override;
  void update(const Scene& scene, const Changes& changes) override;
  void relight(const Light& light) override;
  void resolve(const GBuffer& gbuffer, VisibilityMask& mask) override;
  Counts counts() const override;
  std::optional<Explanation> explain(std::size_t index) const override;
  std::optional<DepthCurve> depth_curve(std::size_t index) const override;
  std::vector<std::uint32_t> image_parts() const override;
  std::vector<DebugLayer> debug_layers() const override;
  std::vector<float> draw_debug(std::string_view layer) const override;

 protected:
  GlassMap();

  /// The technique's shaders, read by setup.
  struct Method {
    /// GLSL of the fragments of glass: outputs, images or buffers, uniforms (GlassDrawing::set) and
    ///   void draw_glass(float t, float transmission)
    /// with t in 0 .. 1 and 0 < transmission < 1. It may discard.
    std::string draw;
    /// GLSL of the look-up, behind light_map_snippet: samplers from unit 4, images, buffers and
    ///   float glass_share(vec2 place, float layer, float t)
    /// what part of the light glass lets through to depth t, 0 .. 1; `place` in texels, inside the image. GLASS_FILTER is 1 for
    /// the bilinear filter, else 0; all four texels of a bilinear one may be clamped to the image. See `filtered_shares`.
    std::string share;
    std::string constants = "";  ///< of the look-up, as PassConstants
    int constant_count = 0;
  };
  virtual Method method() const = 0;
  /// What the device needs beside light maps, scene and G-buffer: `storage_bindings`, `fragment_storage_blocks`, ... of the
  /// technique's own buffers. Bindings 6 and 7 are the kit's.
  virtual GlLimits glass_needs() const { return {}; }
  /// For programs of one's own, held by a Shared of one's own; before the kit warms up with glass. Not called where the device
  /// is too small for glass.
  virtual void setup_glass() {}
  /// Called by relight where the scene has glass: draws it, into textures and buffers of the technique's own, one set for each
  /// light. Whatever state it changes but attachments is put back by the kit.
  virtual void draw_glass(const GlassDrawing& glass) = 0;
  /// Before a look-up: binds what draw_glass drew, and sets the constants.
  virtual void bind_glass(const Program& look_up) const = 0;
  /// Frees what draw_glass made: the scene has no glass.
  virtual void release_glass() = 0;
  virtual std::size_t glass_bytes() const = 0;
  /// More counts than the kit's texels, faces, triangles, bytes.
  virtual Counts more_counts() const { return {}; }

  /// What explains a wrong pixel: the exact lists of the rays of the texels that were read.
  struct Reading {
    double truth;                    ///< what arrives at the point
    double opaque;                   ///< the map's answer for opaque casters
    double share;                    ///< the technique's, for glass
    std::vector<GlassTexel> texels;  ///< weights add up to 1
    /// What exact lists would answer, filtered as shares and as absorbance -ln(share).
    double exact_share() const;
    double exact_absorbance_share() const;
    /// Whether the answer with that share would be right.
    bool is_right(double glass_share) const { return std::abs(opaque * glass_share - truth) <= 1.0 / 20; }
  };
  /// Whether the filter averages absorbance, so that the share is its exponential.
  virtual bool filters_absorbance() const { return false; }
  /// One of About::causes, or nothing; called where the answer is wrong. By default, where exact lists of the same texels with
  /// filtered shares would be right: `filtered_absorbance` where those with filtered absorbance would not, else `curve`.
  virtual std::string_view glass_cause(const Reading& reading) const;

  /// A heat layer of what `value` says of the texels that hold the points of the last resolve: column, row, layer.
  std::vector<float> heat_of_texels(const std::function<float(const glm::ivec3& texel)>& value) const;

  int image_resolution() const { return resolution; }
  bool is_bilinear() const { return filter.is("bilinear"); }
  const LightCamera& camera() const { return camera_; }

  /// What all lights share: a member of it each technique passes to `another`.
  struct Made {
    DepthImages depth_images;
    CasterPrograms glass_programs, opaque_programs;
    std::array<std::array<Program, light_projection_count>, 2> resolve_programs;  // without and with glass
    std::array<std::array<std::optional<Program>, light_projection_count>, 2> explain_programs;
    std::array<std::optional<Program>, light_projection_count> curve_programs;  // with glass
    Framebuffer framebuffer, glass_framebuffer;
    const Scene* scene = nullptr;
    MeshBoxes boxes;             // glass casts
    std::vector<bool> is_glass;  // by mesh: casts and lets light through
    std::vector<bool> has_opaque_texels;
    bool has_glass = false;
    // What questions need, in memory: of one object at a time.
    const GlassMap* read_of = nullptr;
    std::vector<float> read_depths;
    std::vector<glm::vec4> read_look_ups;  // by pixel: texel, share, 8 * layer + 7 * opaque answer
    std::unique_ptr<GlassLists> lists;
    std::unique_ptr<ExactScene> exact;
  };
  Shared<Made> made_;

 private:
  Number<int> resolution;
  Number<double> depth_bias, slope_bias;
  Choice filter;
  UpdateSetting update_by{this};

  MapComparison comparison() const;
  /// Of a scene with glass, and with alpha masks or without.
  Support glass_support(const Light& light, bool has_masks) const;
  /// What a program of the look-up is for: the mask, what explains a pixel, or one place at many depths.
  enum class Purpose { resolve, explain, curve };
  Program look_up_program(LightProjection projection, bool has_glass, Purpose purpose) const;
  void look_up(const Program& program, unsigned target) const;
  void draw_all_glass();
  void draw_opaque_texels();
  void start_questions() const;
  const std::vector<float>& depths() const;
  struct Place {
    const LightImage* image;  ///< null: nothing casts there
    glm::dvec2 texel;
    double opaque, share;
  };
  Place looked_up(std::size_t index) const;
  Explanation why_at(const Place& place, std::size_t index) const;
  /// Along the image's axis, where a point was looked up.
  static double depth_at(const LightImage& image, const glm::dvec3& point, double bias) {
    return image.seen(point).z - bias / image.stretch(point);
  }
  /// The glass on a ray but for texels that let nothing through, which the map of opaque casters holds.
  std::vector<GlassCrossing> glass_along(const Tap& ray) const;
  /// The texels that a look-up reads, without their share.
  std::vector<GlassTexel> texels_of(const Place& place) const;
  std::vector<GlassTexel> texels_at(const Place& place, const glm::dvec3& point, double bias) const;
  std::vector<float> held_shares(const Place& place, int count) const;
  SharesAlong exact_shares(const Place& place) const;
  void prepare_lists() const;
  std::vector<float> draw_curve_errors() const;
  /// Calls visit(pixel, place) on all threads for the pixels of the last resolve that were looked up on an image.
  void each_looked_up(const std::function<void(std::size_t, const Place&)>& visit) const;
  LightProjection projection() const { return projection_of(camera_); }

  Light light_;
  LightCamera camera_;
  Texture depths_;
  DepthImages::StillLayer still_;
  std::size_t drawn_triangles_ = 0;
  const GBuffer* gbuffer_ = nullptr;
};

/// GLSL at the end of Method::share for who filters shares: glass_share as the mean over the filter's texels of the technique's
///   float glass_at(ivec3 texel, float t)
/// with column, row and layer.
extern const std::string_view filtered_shares;

}  // namespace gnomon
