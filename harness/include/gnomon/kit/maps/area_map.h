#pragma once
#include <gnomon/kit/area/light_shape.h>
#include <gnomon/kit/maps/light_map.h>
#include <gnomon/kit/maps/map_causes.h>
#include <gnomon/kit/shared.h>

namespace gnomon {

/// What techniques share that tell from one depth image, drawn from the center of a light with area, how much of all of it
/// arrives at a point.
///
/// A caster at axis distance z is seen from a point at q.z as shifted across the image while one goes over the light: by
/// `spread` = 1/z - 1/q.z times the light's figure. That is projected along the ray through the point onto the plane
/// across the image's axis, where its half sides are two columns of texels: place (s, t) of the light, each in -1 .. 1, is
/// hidden by what is stored at
///
///   position + spread / (1 - dot(tilt, (s, t))) * figure * (s, t)
///
/// exactly, whatever way the light is turned. Of a sphere the figure is the disc with the same directions (LightFigure).
struct AreaPoint {
  const LightImage* image = nullptr;
  glm::dvec3 seen{0};          ///< the point in the frame of its face
  glm::dvec2 position{0};      ///< texels
  double facing = 0;           ///< height over the receiver's plane that a meter along the axis and the point's ray costs
  glm::dvec2 step_height{0};   ///< what one texel to the side takes off that
  double depth = 0, bias = 0;  ///< as the shader has them
  glm::dmat2 figure{1};        ///< texels at spread 1
  glm::dvec2 tilt{0};          ///< how far the half sides go along the axis, in q.z
  glm::dvec3 horizon{0};       ///< heights over the receiver's plane: of the center, and what each half side adds
  bool is_disc = false;

  double spread(double z) const { return 1 / z - 1 / seen.z; }
  /// Half a box around all places of the light at spread 1, texels.
  glm::dvec2 reach() const;
  glm::dvec2 offset(double spread, const glm::dvec2& place) const;
  /// Whether what a texel stores, reversed depth, is before the point: over its plane by more than the bias, and nearer.
  bool is_hidden_by(const glm::ivec2& texel, double stored) const;
  bool is_above_horizon(const glm::dvec2& place) const { return horizon.x + horizon.y * place.x + horizon.z * place.y > 0; }
};

class AreaMap : public Technique {
 public:
  struct Defaults {
    int resolution, most_radius;
  };
  explicit AreaMap(const Defaults& defaults) : defaults_(defaults) {}
  Support supports(const Scene& scene, const Light& light, const View&) const override;
  void setup() override;
  void build(const Scene& scene) override;
  void update(const Scene& scene, const Changes& changes) override;
  void relight(const Light& light) override;
  void resolve(const GBuffer& gbuffer, VisibilityMask& mask) override;
  Counts counts() const override;
  /// Where `alpha` or `glass` is a cause; nothing elsewhere.
  std::optional<Explanation> explain(std::size_t index) const override;
  std::vector<std::uint32_t> image_parts() const override;
  std::vector<DebugLayer> debug_layers() const override;
  std::vector<float> draw_debug(std::string_view layer) const override;

 protected:
  /// GLSL of `float share_seen(Point p, out vec4 account)`: how much of the light arrives; the account is what `explain` needs,
  /// its third component the spread that was searched or filtered with. `area_map_snippet` has what it may use.
  virtual std::string body() const = 0;
  /// What the map counts that bodies read.
  virtual void set_uniforms(const Program&) const {}

  Defaults defaults_;
  Number<int> resolution =
      Number<int>(this, "resolution", defaults_.resolution, {.unit = "texel", .min = 64, .max = 4096, .log = true},
                  Stage::relight, "Side of the square depth image of each cube face around the light's center.");
  Number<int> most_radius =
      Number<int>(this, "most_radius", defaults_.most_radius, {.unit = "texel", .min = 1, .max = 256, .log = true},
                  Stage::relight, "How far from a point's texel others are read at most: wider penumbrae become narrower.");
  Choice fit = Choice(
      this, "fit", "scene", {"scene", "view"}, Stage::relight,
      "Images hold all that casters and receivers share, or what the picture shows of it: then each resolve fits and draws "
      "them anew, and pays for it.");
  Number<double> depth_bias =
      Number<double>(this, "depth_bias", 0.25, {.unit = "texel", .min = 0, .max = 64}, Stage::resolve,
                     "Beside the bias of the receiver's plane: along the image's axis, in widths of a texel at the point.");
  AlphaSetting alpha{this, Stage::relight};
  GlassSetting glass{this};
  UpdateSetting update_by{this};

  /// What all lights share: a member of it each technique passes to `another`.
  struct Made {
    DepthImages depth_images;
    Program nearest_program;
    std::array<Program, 2> resolve_programs;  // of rectangles, and of discs and spheres
    std::array<std::optional<Program>, 2> account_programs;
    Framebuffer framebuffer;
    const Scene* scene = nullptr;
    GlassDifference glass_difference;
    // What questions need, in memory: of one object at a time.
    const AreaMap* read_of = nullptr;
    std::vector<float> depths;
    std::vector<glm::vec4> accounts;
    std::optional<AlphaDifference> alpha_difference;
  };
  Shared<Made> made_;

  /// Pixel `index` of the last resolve; it faces the light.
  AreaPoint point(std::size_t index) const;
  const std::vector<float>& depths() const;
  /// What the shader said of each pixel in the last resolve.
  const std::vector<glm::vec4>& accounts() const;
  const Light& light() const { return light_; }
  const LightCamera& camera() const { return camera_; }
  const GBuffer& gbuffer() const { return *gbuffer_; }
  bool faces(std::size_t index) const { return faces_light(*made_->scene, *gbuffer_, light_, index); }
  /// What of `alpha` explains an error of the last resolve; empty where nothing does.
  std::string_view alpha_cause(std::size_t index) const;
  /// Names the cause of `glass` where it explains an error of the last resolve.
  void explain_glass(Explanation& why, std::size_t index) const {
    made_->glass_difference.explain(why, *gbuffer_, light_, index);
  }

 private:
  /// Of all images.
  struct Images {
    Texture depths, nearest;
    DepthImages::StillLayer still;  // of the depths
  };
  int margin() const { return most_radius + 2; }
  int program_index() const { return LightShape(light_).form == LightShape::Form::rectangle ? 0 : 1; }
  Program program(int which, std::string_view title, std::string_view first_line) const;
  void draw_images(LightCamera&& camera);
  /// Draws the images of the present camera; answers how many triangles were drawn.
  std::size_t draw(Images& images, const HoleTest& test) const;
  void look_up(const Program& program, const Images& images, unsigned target) const;
  std::vector<float> answer(const Images& images) const;
  void start_questions() const;

  Light light_, center_;
  LightCamera camera_;
  Images images_;
  std::size_t drawn_triangles_ = 0;
  const GBuffer* gbuffer_ = nullptr;
};

/// A block of so many texels a side has one nearest depth: `nearest_in` of the shader reads it.
inline constexpr int area_map_block = 8;

}  // namespace gnomon
