#pragma once
#include <gnomon/kit/maps/light_map.h>
#include <gnomon/kit/maps/map_causes.h>
#include <gnomon/kit/maps/moved_tiles.h>
#include <gnomon/kit/maps/prefilter.h>
#include <gnomon/kit/shared.h>

namespace gnomon {

/// What techniques share whose map is filtered before it is read: every texel holds functions of the depth t stored there
/// (moments, exponentials), a filter takes their means, and one look-up tells from these how much of the light arrives. Depth
/// is the distance along the image's axis, from 0 at its near end to 1 at its far end and where nothing is stored.
class FilteredMap : public Technique {
 public:
  Support supports(const Scene&, const Light& light, const View&) const override;
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
  /// The numbers of a texel.
  struct Texel {
    int channels;                ///< 1, 2 or 4
    bool is_within_one = false;  ///< all lie in 0 .. 1: 16 bits are whole numbers then, not floats
    glm::vec4 to_one{1};         ///< times this they lie in 0 .. 1, for tables
  };
  virtual Texel texel() const = 0;
  /// What a technique says of them, in GLSL.
  struct Method {
    std::string encode;     ///< `vec4 encode(float t)`: what a texel holds
    std::string answer;     ///< `float answer(vec4 mean, float t)`: how much of the light arrives at depth t, 0 .. 1
    std::string constants;  ///< one that both may read, as PassConstants has it
  };
  virtual Method method() const = 0;
  /// Sets those constants; a program may use some of them only.
  virtual void set_constants(const Program& program) const = 0;
  /// Whether the numbers of a texel hold what the parameters make of depth.
  virtual Support method_support() const { return Support::full(); }
  bool has_16_bits() const { return bits.is("16"); }
  bool has_table() const { return prefilter.is("table"); }
  /// What storing takes off the mean of what a texel holds; of a table, of the largest that it holds.
  StoredRounding rounding() const { return used_prefilter().rounding(format()); }
  int stores() const { return used_prefilter().stores(); }

  Number<int> resolution{this,           "resolution",
                         1024,           {.unit = "texel", .min = 64, .max = 2048, .log = true},
                         Stage::relight, "Side of the square image (of each cube face for point lights)."};
  Choice fit = Choice(
      this, "fit", "scene", {"scene", "view"}, Stage::relight,
      "Images hold all that casters and receivers share, or what the picture shows of it: then each resolve fits, draws and "
      "blurs them anew, and pays for it.");
  Choice prefilter = Choice(
      this, "prefilter", "blur", {"blur", "mips", "table"}, Stage::setup,
      "Means are those of a blur; of levels, each half as large, by the longest way across a pixel's footprint; or of the box "
      "around the footprint, by a summed-area table of whole numbers.");
  Number<int> widest_footprint = Number<int>(
      this, "widest_footprint", 16, {.unit = "texel", .min = 1, .max = 64, .log = true}, Stage::setup,
      "Means follow a pixel's footprint up to this, and images have a margin for it; for prefilter=mips and table.");
  Choice bits{this, "bits", "32", {"32", "16"}, Stage::setup, "Of each number that a texel holds."};
  Number<int> blur_radius =
      Number<int>(this, "blur_radius", 2, {.unit = "texel", .min = 0, .max = Blur::most_radius}, Stage::setup,
                  "Half the side of the blur beside its middle texel; 0: none. Other means spread no less.");
  Choice blur_weights{
      this, "blur_weights", "box", {"box", "gaussian"}, Stage::setup, "What the blur weighs texels by; for prefilter=blur."};
  Number<double> bias =
      Number<double>(this, "bias", 0.25, {.unit = "texel", .min = 0, .max = 64}, Stage::resolve,
                     "What a point is nearer to the light by when it is looked up, in widths of a texel at the point.");
  Number<double> leak_reduction = Number<double>(this, "leak_reduction", 0, {.unit = "", .min = 0, .max = 0.95}, Stage::resolve,
                                                 "Answers up to this are dark, and the rest is stretched to 0 .. 1.");
  AlphaSetting alpha{this, Stage::relight};
  GlassSetting glass{this};
  UpdateSetting update_by{
      this,
      "Where some casters move and others do not: layers draws those that stand still into an image of their own. The first "
      "relight after an update, or the resolve after it where that draws, keeps this image, draws the others over a copy of it, "
      "and encodes and blurs only tiles whose texels they may have changed; levels and tables are made anew. redraw draws and "
      "filters all."};

  /// What all lights share: a member of it each technique passes to `another`.
  struct Made {
    DepthImages depth_images;
    std::array<Program, 2> encode_programs;  // parallel rays, and rays from a center
    std::array<Program, light_projection_count> resolve_programs;
    Blur blur;
    Texture unblurred;  // where images have layers, in the place of what the blur takes from the means
    MipChain mips;
    SummedAreaTable table;
    Framebuffer framebuffer;
    const Scene* scene = nullptr;
    GlassDifference glass_difference;
    // What questions need, in memory: of one object at a time, for 64 lights' images fill a gigabyte.
    const FilteredMap* read_of = nullptr;
    std::vector<float> read_depths;
    std::optional<AlphaDifference> alpha_difference;
  };
  Shared<Made> made_;

 private:
  /// Of all images.
  struct Images {
    Texture depths, means;
    DepthImages::StillLayer still;  // of the depths
    MovedTiles moved;               // of the means
    double filtered_texels = 0;     // by the last drawing
  };
  void draw_images(LightCamera&& camera);
  /// Draws the images of the present camera; answers how many triangles were drawn.
  std::size_t draw(Images& images, const HoleTest& test) const;
  /// Makes means of the depths: of all, or of what may differ from those of the drawing before.
  void filter(Images& images) const;
  /// What means are taken of: all texels, or those of rectangles and as many as `around` beside them.
  void encode(const Texture& depths, const Texture& to, const std::vector<LayerRectangle>* only, int around) const;
  /// The values of all parameters that means depend on.
  std::string filter_settings() const;
  void look_up(const Images& images, unsigned target) const;
  std::vector<float> answer(const Images& images) const;
  /// What of `alpha` explains a wrong pixel of the last resolve; empty where nothing does.
  std::string_view alpha_cause(std::size_t index) const;
  /// Taps and what comes with them, of a pixel that looks into this image.
  Explanation explain_look_up(std::size_t index, const LightImage& image) const;
  void start_questions() const;
  Prefilter used_prefilter() const {
    const Blur::Weights weights = blur_weights.is("box") ? Blur::Weights::box : Blur::Weights::gaussian;
    return {Prefilter::Kind(prefilter.index()), weights, blur_radius, widest_footprint};
  }
  GLenum format() const;
  bool is_blurred() const { return prefilter.is("blur") && blur_radius > 0; }
  const std::vector<float>& depths() const;

  Light light_;
  LightCamera camera_;
  Images images_;
  std::size_t drawn_triangles_ = 0;
  const GBuffer* gbuffer_ = nullptr;
};

}  // namespace gnomon
