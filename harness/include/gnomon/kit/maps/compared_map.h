#pragma once
#include <gnomon/kit/maps/filter_setting.h>
#include <gnomon/kit/maps/map_causes.h>
#include <gnomon/kit/maps/map_comparison.h>
#include <gnomon/kit/maps/stored_depth.h>
#include <gnomon/kit/shared.h>

namespace gnomon {

/// What techniques share that compare a point with depth images of the light: they differ in which images those are, and in
/// what decides before depth does.
///
/// The bias is a length along the axis of the image. Its parameters are in texels because acne is: a texel's world width at the
/// point, times the parameter, gives meters.
class ComparedMap : public Technique {
 public:
  Support supports(const Scene& scene, const Light& light, const View&) const override;
  void setup() override;
  void build(const Scene& scene) override;
  void update(const Scene& scene, const Changes& changes) override;
  void relight(const Light& light) override;
  void resolve(const GBuffer& gbuffer, VisibilityMask& mask) override;
  Counts counts() const override;
  std::optional<Explanation> explain(std::size_t index) const override;
  std::vector<std::uint32_t> image_parts() const override;
  std::vector<DebugLayer> debug_layers() const override;
  std::vector<float> draw_debug(std::string_view layer) const override;

 protected:
  struct Defaults {
    std::string_view bias;
    double depth_bias, slope_bias;
  };
  explicit ComparedMap(const Defaults& defaults);

  /// Images for any view, drawn by relight; nothing if they depend on the view.
  virtual std::optional<LightCamera> fitted_to_scene(const Light& light, const MeshBoxes& boxes, int margin) const = 0;
  /// Images for this picture, drawn by resolve, which then pays for it; called where there are none for any view.
  virtual LightCamera fitted_to_view(const Light& light, const MeshBoxes& boxes, const GBuffer& gbuffer, int margin) const = 0;
  /// What texels hold. Setup reads its kind; every drawing of images reads its offset.
  virtual StoredDepth stored_depth() const { return {}; }
  virtual LightImages images() const { return LightImages::faces; }

  /// GLSL that answers where something else than depths can, read by setup; empty: depths answer everywhere. It is for both
  /// passes (see mask_program), follows filter_snippet, has texture units and storage bindings as `bind_decision` binds
  /// them, units from 4 on, and offers
  ///
  ///   float decided(vec4 surface, vec4 facet, ComparedPoint point)   the answer; compared(point) is that of the depths
  ///   float noted(vec4 surface, vec4 facet, ComparedPoint point)     a number for `explain_decision` and `noted`
  virtual std::string decision() const { return {}; }
  /// Before a look-up with a decision.
  virtual void bind_decision(const Program&, const Light&, const GBuffer&) const {}
  /// Called after the images of a camera were drawn, in the stage that drew them.
  virtual void images_drawn(const LightCamera&) {}
  /// Whether the decision blends two look-ups of a point: then `noted` is the share of the second one, and it offers
  ///
  ///   ComparedPoint asked_again(vec4 surface, vec4 facet)   the second: as `ask`, in another image
  virtual bool looks_twice() const { return false; }
  /// Changes what the depths explain of a pixel that faces the light, where its answer is not theirs alone.
  virtual void explain_decision([[maybe_unused]] float number, Explanation&) const {}
  /// What the decision notes of each pixel of the last resolve that faces the light; 0 at the others.
  std::vector<float> noted() const;

  int image_resolution() const { return resolution; }
  MaskPass mask_pass() const { return MaskPass(pass.index()); }
  const GBuffer& gbuffer() const { return *gbuffer_; }
  const LightCamera& camera() const { return camera_; }

  /// What all lights share: a member of it each technique passes to `another`.
  struct Made {
    DepthImages depth_images;
    DepthCombination combination;
    std::array<Program, light_projection_count> resolve_programs;  // of the present bias, filter and pass
    std::array<std::array<std::optional<Program>, light_projection_count>, 2> explain_programs;  // by look-up
    Framebuffer framebuffer;
    const Scene* scene = nullptr;
    double diagonal = 0;  // of the scene, for adaptive: a pass over all vertices
    GlassDifference glass_difference;
    // What questions need, in memory: of one object at a time, for 64 lights' images fill a gigabyte.
    const ComparedMap* read_of = nullptr;
    std::vector<float> read_depths;  // of all layers, read at the first question after a relight
    // By look-up and pixel, drawn at the first question after a resolve.
    std::array<std::vector<glm::vec4>, 2> read_look_ups;
    std::optional<AlphaDifference> alpha_difference;
  };
  Shared<Made> made_;

 private:
  Number<int> resolution;
  Choice bias;
  Number<double> depth_bias, slope_bias, normal_offset;
  FilterSetting filter{this};
  Choice pass, faces, depth_bits, depth_order;
  AlphaSetting alpha{this, Stage::relight};
  GlassSetting glass{this};
  UpdateSetting update_by{this};

  /// The same, unless bits leave depth steps that a scene shows.
  Support coarse_depth(const Scene& scene, const Light& light, const Support& support) const;
  /// Biases are for one texel: a filter compares with texels farther away. The light has a part in those of a preset.
  MapComparison comparison(const Light& light) const;
  /// The one that is chosen; null where the bias is set.
  const BiasPreset* preset() const;
  /// Arrays with one layer for each image that is drawn.
  struct Depths {
    Texture first, second, combined;
    DepthImages::StillLayer still;  // of the first
  };
  const Texture& map(const Depths& depths) const {
    const StoredDepth stored = stored_depth();
    return stored.is_combined() ? depths.combined : stored.needs_second() ? depths.second : depths.first;
  }
  /// Draws the images of the present camera; answers how many triangles were drawn.
  std::size_t draw(Depths& depths, const HoleTest& test) const;
  /// Of depth in the present setting: 16, 24 or 32.
  int bits() const { return stored_depth().needs_second() ? 32 : 16 + 8 * depth_bits.index(); }
  DepthOrder order() const { return stored_depth().needs_second() ? DepthOrder::reversed : DepthOrder(depth_order.index()); }
  /// Bits of fixed point that round as much as what is stored does; 32: those of a reversed float, which round nothing.
  int rounding_bits() const;
  void start_questions() const;
  const std::vector<float>& depths() const;
  /// A pixel's image and its place there, in texels, in the last resolve.
  struct Place {
    const LightImage* image = nullptr;  ///< null: nothing casts there
    glm::dvec2 texel{0};
    float noted = 0;  ///< by the decision
    bool is_decided_early = false;
  };
  static constexpr int decided_early = 1024;  ///< what explaining shaders add to the layer then
  enum class LookUpOf { first, second };
  Place looked_up(std::size_t index, LookUpOf which = LookUpOf::first) const;
  /// What the depths say of a pixel there; where nothing casts, that a ray is lit.
  Explanation explain_place(std::size_t index, const Place& place) const;
  std::vector<float> answer(const Depths& depths) const;
  /// What of `alpha` explains a wrong pixel of the last resolve; empty where nothing does.
  std::string_view alpha_cause(std::size_t index) const;
  void draw_images(LightCamera&& camera);
  /// Runs a program of resolve over all pixels, into a texture.
  void look_up(const Program& program, MaskPass by, const Depths& depths, unsigned target) const;
  /// What a program is for: the mask, or where one of the look-ups of a point is.
  enum class Purpose { resolve, explain, explain_again };
  Program resolve_program(LightProjection projection, Purpose purpose) const;
  LightProjection projection() const { return projection_of(camera_); }

  Light light_;
  LightCamera camera_;
  bool draws_in_resolve_ = false;
  Depths depths_;
  std::size_t drawn_triangles_ = 0;
  const GBuffer* gbuffer_ = nullptr;
};

}  // namespace gnomon
