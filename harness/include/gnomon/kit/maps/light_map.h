#pragma once
#include <gnomon/kit/geometry/edges.h>
#include <gnomon/kit/gl/gl_pass.h>
#include <gnomon/kit/maps/alpha_levels.h>
#include <gnomon/kit/maps/light_camera.h>
#include <gnomon/kit/maps/moving_meshes.h>

#include <functional>

namespace gnomon {

/// Whether the light is outside all parts of a mesh (see solid_parts): what is turned away from it then
/// hides nothing more, for light enters such a part through a triangle that is turned to it before it leaves it.
bool is_seen_from_outside(std::span<const Bounds> solid_parts, const LightSpaceFace& face);

/// What is nearer to the light has the larger depth, or the smaller one: 1 less that.
enum class DepthOrder { reversed, forward };

/// Draws the images of light cameras. One serves all lights of a technique: keep it with what they share.
class DepthImages {
 public:
  /// Every triangle; of solid casters only what is turned to the light: the first surface is the same; or what is turned away.
  enum class Faces { all, lit, unlit };

  /// What one light of a technique has beside an image of first surfaces that is drawn by layers: an image of the casters that
  /// stand still, and how it was drawn. Keep it with that image, its only one.
  class StillLayer {
   public:
    /// A relight begins. The first one after an update may keep the layer; where the technique draws in resolve, the first
    /// resolve after that relight may. Before the first call there are no layers, nor without `wanted`.
    void start_relight(const MovingMeshes& moving, const UpdateSetting& wanted);
    std::size_t bytes() const { return image_.bytes; }
    /// Whether the last drawing was by layers.
    bool is_used() const { return image_.bytes > 0; }
    /// Whether the last drawing kept it: but for what is drawn over it, the image differs from that of the drawing before only
    /// where casters that moved were and are.
    bool was_kept() const { return was_kept_; }
    /// The technique draws more than casters into the image: all of it is copied anew each time.
    bool is_drawn_over = false;

   private:
    friend class DepthImages;
    Texture image_;
    LightCamera camera_;
    AlphaRule rule_ = AlphaRule::texel;
    Faces faces_ = Faces::lit;
    MovingMeshes::Number drawn_, relit_;  // of what the layer shows, and of what was relit last
    bool is_wanted_ = false, may_be_kept_ = false, was_kept_ = false;
  };

  /// Compiles; needs the context.
  void setup();
  /// The scene must live as long as images of it are drawn. The rule is for `use_alpha`. Casters with transmission are drawn
  /// where they are taken for opaque.
  void build(const Scene& scene, AlphaRule rule = AlphaRule::texel, GlassAs glass = GlassAs::opaque);
  /// Brings what build found up to date with vertices that moved; the boxes of meshes hold all of the motion. Where it answers
  /// false it did nothing, and the scene must be built.
  [[nodiscard]] bool update(const Scene& scene, const Changes& changes);
  const MeshBoxes& boxes() const { return boxes_; }
  const MovingMeshes& moving() const { return moving_; }
  /// Makes what a rule about holes needs, unless it is there: for stages in which the rule may change.
  void use_alpha(AlphaRule rule);
  /// By that rule; by the texel's where no mesh has a mask.
  HoleTest hole_test() const { return alpha_levels_.hole_test(); }

  /// What images store depth as, from the next drawing on: GL_DEPTH_COMPONENT32F, 24 or 16. Of second surfaces only reversed
  /// ones are drawn.
  void use_format(GLenum format, DepthOrder order = DepthOrder::reversed) {
    format_ = format;
    order_ = order;
  }
  /// The first surface seen from the light, one layer for each image with casters, into `target`, which becomes an image of the
  /// format and of the camera's size: depth in the order of the format, reversed 0 where there is nothing. Answers how many
  /// triangles were drawn. `test` is `hole_test` or the texel's.
  std::size_t draw(const LightCamera& camera, Texture& target, Faces faces = Faces::lit, const HoleTest& test = {});
  /// The same. Where some casters move and others do not, those that stand still are drawn into the layer, unless it may be
  /// kept, and the others over a copy of it. The nearest surface is the same in whatever order casters are drawn.
  std::size_t draw(const LightCamera& camera, Texture& target, StillLayer& still, Faces faces, const HoleTest& test);
  /// The first surface strictly behind that of `first`; what is as near as that is the same surface, or one glued to it.
  std::size_t draw_second(const LightCamera& camera, const Texture& first, Texture& target, const HoleTest& test = {});

  std::size_t bytes() const {
    return boxes_.meshes.size() * sizeof(MeshBox) + bytes_of(solid_parts_) + moving_.bytes() + alpha_levels_.bytes();
  }

 private:
  enum class Which { all, still, moving };
  /// What moves is drawn over what `target` holds.
  std::size_t draw(CasterPrograms& programs, const LightCamera& camera, Texture& target, Faces faces, const HoleTest& test,
                   Which which);
  bool is_drawn(Which which, std::uint32_t mesh) const {
    return which == Which::all || (which == Which::moving) == moving_.moves(mesh);
  }
  void copy_layer(const LightCamera& camera, const Texture& layer, Texture& target, bool only_where_casters_move) const;

  CasterPrograms first_, second_;
  Framebuffer framebuffer_;
  const Scene* scene_ = nullptr;
  MeshBoxes boxes_;
  MovingMeshes moving_;
  SolidParts solid_parts_;
  AlphaLevels alpha_levels_;
  GLenum format_ = GL_DEPTH_COMPONENT32F;
  DepthOrder order_ = DepthOrder::reversed;
};

/// Half a step between depths that a number of bits tells apart, 32 meaning float: what is stored may be off by so much at axis
/// distance z, in meters. Depth is near / z where rays start at the light, linear where they are parallel.
double half_depth_step(int bits, const LightImage& image, double z);

/// How a camera looks; for shaders PROJECTION of `light_map_head`.
enum class LightProjection { parallel, centered, cube };
inline constexpr int light_projection_count = 3;
LightProjection projection_of(const LightCamera& camera);

/// For a pass whose fragments look points up in the images of a camera. The head comes first, the constants are declared to
/// pass_program, and the snippet offers:
///
///   vec3 light_origin                 subtract it from a point; what follows takes the difference v
///   void choose_image(vec3 v)         of the six; then `light_window` and `light_facts` are those of that image
///   vec4 light_window                 scale and offset
///   vec4 light_facts                  layer, the texel's larger width in window coordinates, near, and far or what
///                                     `set_light_camera` was given instead
///   vec3 in_image(vec3 v)             texel column and row, both times z where rays start at the light; z: the axis distance
///   vec3 along_image(vec3 step)       what in_image gives more where v is longer by a step; of faces
///   vec2 across_image(vec3 n)         how far a direction goes along columns and rows, in texels at axis distance 1
///   vec2 way_in_image(vec2 a, vec2 b) from texel to texel, in the measure of across_image: b - a unless the image is warped
///   float stored_depth(vec2 texel)    of a texel by its whole numbers; 0 beside the image and where nothing is stored; read
///                                     by 1 less it where FORWARD_DEPTH is defined
///   bool faces_light_at(vec4 position, vec4 normal, vec3 v)   what faces_light says, with no constant more
///
/// Of slices, there are
///
///   float depth_along_view(vec3 v)    from the eye, meters
///   float light_ahead                 0; what choose_image adds to that, for a look-up in a slice that is not a point's own
///
/// In a warped image, across_image is for texels as large as at the pivot, and `light_stretch` is how much larger the
/// box around one is at the point of the last call of in_image; `light_facts.y` is then of that place.
///
/// `spot` of faces_light_constants is among the constants where rays start at the light.
std::string light_map_head(LightProjection projection, LightImages images = LightImages::faces);
/// Full, unless the light has an area (a map has one center), the margin of a fit leaves less than half of the texels, or the
/// device is too small for images of so many and for passes, one for each projection, that have so many constants beside those
/// below.
Support light_map_support(const Light& light, int resolution, int margin, int more_constants,
                          LightImages images = LightImages::faces);
std::string light_map_constants(LightProjection projection, LightImages images = LightImages::faces);
extern const std::string_view light_map_snippet;
/// Sets light, spot and the constants. `fourth` gives the last of `light_facts`; without it, that is far.
void set_light_camera(const Program& program, const Light& light, const LightCamera& camera,
                      const std::function<double(const LightImage&)>& fourth = {});

}  // namespace gnomon
