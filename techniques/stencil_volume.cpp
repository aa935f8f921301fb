// Stencil shadow volumes: faces of the casters' shadow volumes, counted per pixel by the rasterizer.
#include <gnomon/kit/bases/mask_setting.h>
#include <gnomon/kit/geometry/box_tree.h>
#include <gnomon/kit/geometry/camera.h>
#include <gnomon/kit/volumes/volume_technique.h>
#include <gnomon/registry.h>

#include "stencil_volume/eye_place.h"
#include "stencil_volume/gpu_finder.h"

namespace {
using namespace gnomon;

constexpr About about{
    .title = "Stencil shadow volumes",
    .summary = "Faces of the casters' shadow volumes, counted per pixel by the rasterizer.",
    .source =
        "Crow 1977; Heidmann 1991 (zpass); Everitt and Kilgard 2002 (zfail, infinite far plane, caps); Hornus, Hoberock, "
        "Lefebvre and Hart 2005 (zpass_plus); Bergeron 1986 and Kim, Kim and Jung 2008 (open and non-manifold meshes: "
        "edges with multiplicity); Lengyel 2011, Table 10.1 (winding of side quads).",
    .error =
        "Exact up to the rasterizer's snapping of vertices to 1/256 pixel: the share of pixels that a shift by half of "
        "that would flip is the row's snapping_floor. Light caps and lit surfaces tie bit for bit, so there is no bias. Edges of "
        "holes are rounded to float32 where masks are cut.",
    .fails =
        "The count zpass with the eye in a shadow volume: every pixel is off by the volumes around the eye, and the row "
        "says so. An edge that meets the middle of another one (T-junction) is a crack of the input: single pixels along "
        "its side quad may be wrong. A closed mesh that winds around some region the wrong way (self-intersecting) lights "
        "receivers inside that region.",
    .needs_gl = true,
    .floor = Floor::depth_draw,
    .rasterizes = true,
    .handles = with_alpha_masks};

/// Eighteen vertices a triangle, nine where volumes are pointed.
constexpr std::string_view triangle_sides_body = R"(
void main() {
  int corners = pointed ? 3 : 6, side = gl_VertexID / corners, triangle = side / 3, k = side % 3;
  uint from = triangles[3 * triangle + k], to = triangles[3 * triangle + (k + 1) % 3];
  gl_Position = place(quad_corner(min(from, to), max(from, to), from < to, 0, gl_VertexID % corners));
}
)";

/// Casters between the light and the near plane, thrown onto that plane from the light. `clip_from_world` holds the projection.
const std::string near_cap_vertex = std::string(position_snippet) + R"(
uniform vec4 plane;            // near plane, turned to the light
uniform float light_height;    // of the homogeneous light over it
uniform float light_w;
out float gl_ClipDistance[2];
void main() {
  float height = dot(plane.xyz, position) + plane.w;
  gl_ClipDistance[0] = height;
  gl_ClipDistance[1] = light_height - height * light_w;
  gl_Position = place(vec4(position, 1));
}
)";

class StencilVolume final : public VolumeTechnique {
  Choice count = Choice(this, "count", "zfail", {"zpass", "zfail", "zpass_plus"}, Stage::relight,
                        "Faces before the surface, behind it, or before it with the volumes around the eye added.");
  Choice extrusion = Choice(this, "extrusion", "silhouette", {"silhouette", "per_triangle"}, Stage::relight,
                            "One side quad for every edge of the outline, or for every edge of every triangle.");
  Choice finder = Choice(this, "finder", "cpu", {"cpu", "gpu"}, Stage::setup,
                         "Who finds the outline and caps that a light sees: the processor's threads, or compute shaders.");
  Choice near_cap =
      Choice(this, "near_cap", "eye", {"eye", "rectangle"}, Stage::relight,
             "For zpass_plus: the volumes around the eye, or the casters thrown onto the near rectangle as published.");
  Choice counter =
      Choice(this, "counter", "auto", {"auto", "wide"}, Stage::relight,
             "Eight stencil bits where no more than 255 volumes can overlap and 32 bits elsewhere, or always 32 bits.");
  MaskSetting masks{this};

 public:
  Support supports(const Scene& scene, const Light& light, const View& view) const override {
    if (has_area(light)) return Support::unsupported("a shadow volume has one apex: lights with area have none");
    if (const Support limit = masks.limit(scene, Support::full()); !limit) return limit;
    return masks.limit(scene, supports_polygons(cut(scene).scene(), light, view));
  }

  void setup() override {
    made_->drawer.setup("stencil_volume");
    own_->triangle_sides = FaceDrawer::program("stencil_volume triangle sides", triangle_sides_body);
    own_->near_cap_program = VolumeProgram("stencil_volume near cap", near_cap_vertex);
    made_->counter.setup();
    if (finder.is("gpu")) own_->gpu_finder.setup();
    counts_wide_ = true;  // the pass of deep scenes, and of counts()
    warm_up(*this);
    made_->counter.drop_pictures();
    counts_wide_ = false;
    warm_up(*this);
  }

  void build(const Scene& original) override {
    // What replaces it may lie where it was.
    if (own_->cut.is_cut()) forget_scene(own_->cut.scene());
    own_->cut = cut(original);
    const Scene& scene = own_->cut.scene();
    made_->scene = &scene;
    own_->casters.reset();
    scene_buffers(scene);
    made_->adjacency = EdgeAdjacency(scene);
    made_->far_planes = FarPlanes(scene);
    if (finder.is("gpu")) own_->gpu_finder.build(made_->adjacency);
  }

  void relight(const Light& light) override {
    const StateGuard guard;
    light_ = light;
    const glm::dvec4 l = homogeneous(light);
    const bool behind = where() == CountWhere::behind_surface;
    // Before the surface volumes are open: only what has both caps can end where nothing receives any more.
    ends_early_ = behind && extrusion.is("silhouette") && !made_->far_planes.empty();
    const WantedFaces wanted{.outline = extrusion.is("silhouette"),
                             .light_caps = behind || near_rectangle(),
                             .dark_caps = behind && (l.w != 0 || ends_early_),
                             .ends = ends()};
    if (finder.is("gpu")) {
      commands_ = own_->gpu_finder.find(scene_buffers(*made_->scene), made_->adjacency, l, wanted, faces_);
      is_on_device_only_ = true;
      depth_bound_ = own_->gpu_finder.depth_bound(made_->adjacency, l).value_or(INT64_MAX);
      // Too many sides for the short proof, or every resolve requires the silhouette: the processor computes it, too.
      if (depth_bound_ > VolumeCounter::stencil_limit || count.is("zpass_plus"))
        depth_bound_ = bound_depth(made_->adjacency, silhouette(), VolumeCounter::stencil_limit);
    } else {
      is_on_device_only_ = false;
      made_->adjacency.find_silhouette(l, silhouette_);
      commands_ = write_faces(made_->adjacency, silhouette_, wanted, faces_);
      depth_bound_ = bound_depth(made_->adjacency, silhouette_, VolumeCounter::stencil_limit);
    }
    wide_ = counts_wide_ || counter.is("wide") || depth_bound_ > VolumeCounter::stencil_limit;
    glFinish();
  }

  void resolve(const GBuffer& gbuffer, VisibilityMask& mask) override {
    const StateGuard guard;
    gbuffer_ = &gbuffer;
    volumes_at_eye_ = 0;
    if (count.is("zpass_plus") && !uses_near_rectangle())
      volumes_at_eye_ = stencil_volume::volumes_at(made_->adjacency, gbuffer.view.eye, silhouette());
    answer(mask);
  }

  Counts counts() const override {
    const auto closed = std::ranges::count_if(made_->adjacency.parts(), &EdgeAdjacency::Part::closed);
    double edges = 0;  // with multiplicity
    for (const SilhouetteEdge& edge : silhouette().edges) edges += std::abs(edge.count);
    const auto own_bytes = static_cast<double>(own_->gpu_finder.bytes() + own_->cut.bytes());
    const std::size_t bytes = VolumeTechnique::bytes() + static_cast<std::size_t>(own_.own(own_bytes));
    const std::int64_t depth_bound =
        finder.is("gpu") ? bound_depth(made_->adjacency, silhouette(), VolumeCounter::stencil_limit) : depth_bound_;
    Counts counts{{"closed_parts", double(closed), ""},
                  {"open_parts", double(std::ssize(made_->adjacency.parts()) - closed), ""},
                  {"silhouette_edges", edges, ""},
                  {"triangles", double(commands_.triangle_count()), ""},
                  {"depth_bound", double(depth_bound), "", Count::Together::largest},
                  {"bytes", double(bytes), "byte"}};
    if (!gbuffer_) return counts;

    const auto [fill, deepest] = measure_work();
    counts.insert(counts.end(), {{"fill", fill, "pixel"},
                                 {"deepest", deepest, "volume", Count::Together::largest},
                                 {"volumes_at_eye", double(volumes_at_eye_), "volume"},
                                 {"counter_bits", wide_ ? 32.0 : 8.0, "bit", Count::Together::largest}});
    return counts;
  }

  /// The element is the first triangle of the scene, by number, between the point and the light: its volume holds the point.
  std::optional<Explanation> explain(std::size_t index) const override {
    Explanation why;
    if (!faces_light(*made_->scene, *gbuffer_, light_, index)) return why;
    if (!own_->casters) {
      std::vector<Bounds> bounds(made_->adjacency.triangles().size());
      for (std::size_t t = 0; t < bounds.size(); ++t) bounds[t].add(made_->adjacency.corners(t).points);
      own_->casters = std::make_unique<BoxTree>(bounds);
    }
    const Segment way{gbuffer_->position(index), homogeneous(light_)};
    std::uint64_t first = made_->adjacency.triangles().size();
    own_->casters->any(SegmentSlabs(way), 0, [&](std::uint32_t place) {
      const std::uint32_t t = own_->casters->order()[place];
      if (silhouette().facing[t] != 0 && crosses(way, made_->adjacency.corners(t)) != Crossing::none)
        first = std::min<std::uint64_t>(first, own_->cut.source(t));
      return false;
    });
    if (first < made_->adjacency.triangles().size()) why.element = first;
    return why;
  }

  std::unique_ptr<Technique> for_another_light() const override {
    return another(*this, &StencilVolume::made_, &StencilVolume::own_);
  }

 private:
  /// Its pieces are drawn from the eye, too: light caps tie with nothing else.
  CutMasks cut(const Scene& scene) const { return masks.cut(scene, CutMasks::Shown::pieces); }
  /// Of a scene without holes.
  Support supports_polygons(const Scene& scene, const Light& light, const View& view) const {
    GlLimits needed = FaceDrawer::needs(scene);
    if (finder.is("gpu")) needed = most_of(needed, stencil_volume::GpuFinder::needs(scene));
    if (const Support enough = within_limits(needed); !enough) return enough;
    if (count.is("zfail")) return Support::full();
    const stencil_volume::EyePlace eye = stencil_volume::EyePlaceFinder(scene, light, view).place();
    if (eye.boundary) return Support::approximate("the eye lies on the boundary of a shadow volume, within rounding");
    if (eye.inside && count.is("zpass"))
      return Support::approximate("the eye is inside a shadow volume, which zpass does not count");
    if (near_rectangle() && eye.light_beside)
      return Support::approximate("the light lies in the near plane: the volumes around the eye are counted instead");
    if (near_rectangle() && eye.near_rectangle)
      return Support::approximate(
          "a shadow volume cuts the near rectangle, where near cap and sides do not meet in every pixel");
    return Support::full();
  }
  CountWhere where() const { return count.is("zfail") ? CountWhere::behind_surface : CountWhere::before_surface; }
  bool near_rectangle() const { return count.is("zpass_plus") && near_cap.is("rectangle"); }
  /// The near rectangle as the light sees it, unless the light lies in its plane.
  bool uses_near_rectangle() const {
    if (!near_rectangle()) return false;
    const double near_plane = gbuffer_textures(*gbuffer_, *made_->scene).near_plane;
    return !stencil_volume::is_between(homogeneous(light_), gbuffer_->view, near_plane, near_plane);
  }
  void draw(Pass pass) const override {
    made_->counter.begin(depth_stencil(*made_->scene, *gbuffer_), gbuffer_textures(*gbuffer_, *made_->scene), pass, where(),
                         static_cast<int>(volumes_at_eye_));
    bind_faces(scene_buffers(*made_->scene).positions);
    if (uses_near_rectangle() && pass != Pass::layer) {
      draw_near_cap();
      glDisable(GL_DEPTH_CLAMP);  // what lies before the near plane is in the near cap
    }
    if (extrusion.is("silhouette"))
      made_->drawer.draw_sides(made_->counter);
    else
      made_->drawer.draw_arrays(made_->counter, own_->triangle_sides, VolumeFace::side, offsetof(FaceCommands, triangle_sides));
    if (where() == CountWhere::behind_surface) made_->drawer.draw_caps(made_->counter);
    glBindVertexArray(0);
  }

  /// Triangles between light and near plane, thrown onto the plane: M = (P.L) I - L P^T, as for planar projected shadows.
  void draw_near_cap() const {
    const Camera camera(gbuffer_->view, gbuffer_->width, gbuffer_->height);
    const glm::dvec4 light = homogeneous(light_);
    const double near_plane = gbuffer_textures(*gbuffer_, *made_->scene).near_plane;
    glm::dvec4 plane(camera.forward, -glm::dot(camera.forward, camera.eye) - near_plane);
    const bool behind = glm::dot(plane, light) < 0;  // the light looks the eye's way
    if (behind) plane = -plane;
    const double height = glm::dot(plane, light);
    const glm::dmat4 projected = height * glm::dmat4(1) - glm::outerProduct(light, plane);
    const glm::dmat4 clip = clip_from_world(*gbuffer_, *made_->scene) * projected;
    own_->near_cap_program.each([&](const Program& p) {
      p.set("clip_from_world", glm::mat4(clip));
      p.set("plane", glm::vec4(plane));
      p.set("light_height", static_cast<float>(height));
      p.set("light_w", static_cast<float>(light.w));
    });
    glEnable(GL_CLIP_DISTANCE0);
    glEnable(GL_CLIP_DISTANCE1);
    // Seen with the light they keep their turn, seen against it they change it.
    made_->drawer.draw_light_caps(made_->counter, own_->near_cap_program, !behind);
    glDisable(GL_CLIP_DISTANCE0);
    glDisable(GL_CLIP_DISTANCE1);
  }

  /// What the device found stays there: the first request in memory computes it again.
  const Silhouette& silhouette() const override {
    if (is_on_device_only_) made_->adjacency.find_silhouette(homogeneous(light_), silhouette_);
    is_on_device_only_ = false;
    return silhouette_;
  }

  struct Own {
    CutMasks cut;
    VolumeProgram triangle_sides, near_cap_program;
    stencil_volume::GpuFinder gpu_finder;
    std::unique_ptr<BoxTree> casters;  // made by the first `explain`
  };
  Shared<Own> own_;
  std::int64_t depth_bound_ = 0;
  mutable bool is_on_device_only_ = false;  // the silhouette
  bool counts_wide_ = false;                // while setup warms the wide pass
  std::int64_t volumes_at_eye_ = 0;
};

}  // namespace

GNOMON_TECHNIQUE(stencil_volume, StencilVolume, about)
