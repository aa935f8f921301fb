// Stencil shadow volumes: faces of the casters' shadow volumes, counted per pixel by the rasterizer.
#include <gnomon/kit/bases/mask_setting.h>
#include <gnomon/kit/volumes/volume_technique.h>
#include <gnomon/registry.h>

#include "stencil_volume/eye_place.h"
#include "stencil_volume/first_caster.h"
#include "stencil_volume/glass.h"
#include "stencil_volume/near_cap.h"
#include "stencil_volume/triangle_sides.h"

namespace {
using namespace gnomon;
using namespace stencil_volume;

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
        "holes are rounded to float32 where masks are cut. Glass: surfaces of each transmission t are counted by themselves, and "
        "the mask is multiplied by t^n. With c transmissions on the way the product is off by (2 c - 1) 2^-24 of itself.",
    .fails =
        "The count zpass with the eye in a shadow volume: every pixel is off by the volumes around the eye, and the row "
        "says so. An edge that meets the middle of another one (T-junction) is a crack of the input: single pixels along "
        "its side quad may be wrong. A closed mesh that winds around some region the wrong way (self-intersecting) lights "
        "receivers inside that region. Glass whose transmission has texels, and more than 8 transmissions, are unsupported.",
    .device = Device::opengl,
    .floor = Floor::depth_draw,
    .rasterizes = true,
    .handles = with_gray_transmission};

class StencilVolume final : public VolumeTechnique {
  Choice count = Choice(this, "count", "zfail", {"zpass", "zfail", "zpass_plus"}, Stage::relight,
                        "Faces before the surface, behind it, or before it with the volumes around the eye added.");
  Choice extrusion = Choice(this, "extrusion", "silhouette", {"silhouette", "per_triangle"}, Stage::relight,
                            "One side quad for every edge of the outline, or for every edge of every triangle.");
  Choice finder = Choice(this, "finder", "cpu", {"cpu", "gpu"}, Stage::setup,
                         "Who finds the outline and caps that a light sees: the processor's threads, or compute shaders.");
  Choice near_cap =
      Choice(this, "near_cap", "eye", {"eye", "rectangle"}, Stage::relight,
             "The volumes around the eye, or the casters thrown onto the near rectangle as published; for count=zpass_plus.");
  Choice counter =
      Choice(this, "counter", "auto", {"auto", "wide"}, Stage::relight,
             "Eight stencil bits where no more than 255 volumes can overlap and 32 bits elsewhere, or always 32 bits.");
  MaskSetting masks{this};

 public:
  Support supports(const Scene& scene, const Light& light, const View& view) const override {
    if (has_area(light)) return Support::unsupported("a shadow volume has one apex: lights with area have none");
    if (const Support glass = supports_glass(scene); !glass) return glass;
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
    warm_up(*this, true);
    made_->counter.drop_pictures();
    counts_wide_ = false;
    warm_up(*this, true);
  }

  void build(const Scene& original) override {
    // What replaces it may lie where it was.
    if (own_->cut.is_cut()) forget_scene(own_->cut.scene());
    own_->cut = cut(original);
    const Scene& scene = own_->cut.scene();
    made_->scene = &scene;
    own_->number += 2;
    take_positions();
    own_->has_unseen = std::ranges::any_of(scene.meshes, [](const Mesh& mesh) { return mesh.casts && !mesh.seen; });
    own_->glass.clear();
    glass_.clear();
    for_groups(scene, [&](float transmission, const Scene& casters) {
      if (transmission == 0) {
        made_->adjacency = EdgeAdjacency(casters, Joins::in_every_pose);
        if (finder.is("gpu")) own_->gpu_finder.build(made_->adjacency);
        return;
      }
      own_->glass.push_back({transmission, EdgeAdjacency(casters, Joins::in_every_pose), own_->gpu_finder.another()});
      if (finder.is("gpu")) own_->glass.back().gpu_finder.build(own_->glass.back().adjacency);
    });
  }

  /// Which triangles share an edge stays. Where masks are cut, all is built.
  void update(const Scene& scene, const Changes& changes) override {
    const auto can_follow = [&](const EdgeAdjacency& adjacency) { return adjacency.can_follow(changes); };
    if (own_->cut.is_cut() || !can_follow(made_->adjacency)) return build(scene);
    if (!std::ranges::all_of(own_->glass, can_follow, &GlassGroup::adjacency)) return build(scene);
    own_->number += 1;
    take_positions();
    own_->moved = made_->adjacency.move(scene, changes);
    for (GlassGroup& group : own_->glass) group.moved = group.adjacency.move(scene, changes);
  }

  void relight(const Light& light) override {
    const StateGuard guard;
    light_ = light;
    const glm::dvec4 l = homogeneous(light);
    const bool behind = where() == CountWhere::behind_surface;
    // Before the surface volumes are open: only what has both caps can end where nothing receives any more.
    ends_early_ = behind && extrusion.is("silhouette") && !made_->far_planes.empty();
    const WantedFaces wanted{.outline = extrusion.is("silhouette"),
                             .light_caps = behind || near_rectangle() || own_->has_unseen,
                             .dark_caps = behind && (l.w != 0 || ends_early_),
                             .ends = ends()};
    // After one update the faces of what did not move may stay, on the processor, which has the outline in memory.
    const bool may_keep = own_->number == number_ + 1 && wanted == wanted_ && finder.is("cpu");
    const auto find = [&](const CasterEdges& casters, const FaceCommands& before, Silhouette& silhouette, FaceBuffers& faces) {
      if (finder.is("gpu"))
        return find_on_device(scene_buffers(*made_->scene), casters, l, wanted, !count.is("zpass_plus"), silhouette, faces);
      return find_faces(casters, l, wanted, may_keep ? &before : nullptr, silhouette, faces);
    };
    number_ = 0;  // until all is found
    wanted_ = wanted;
    const Found opaque = find({made_->adjacency, own_->gpu_finder, own_->moved}, commands_, silhouette_, faces_);
    commands_ = opaque.commands;
    depth_bound_ = opaque.depth_bound;
    is_on_device_only_ = opaque.is_on_device_only;
    wide_ = is_wide(depth_bound_);
    glass_.resize(own_->glass.size());
    for (std::size_t k = 0; k < glass_.size(); ++k) {
      GlassGroup& group = own_->glass[k];
      GroupFaces& glass = glass_[k];
      glass.found = find({group.adjacency, group.gpu_finder, group.moved}, glass.found.commands, glass.silhouette, glass.faces);
      glass.wide = is_wide(glass.found.depth_bound);
      const std::vector<float> powers = powers_of(group.transmission, most_surfaces(group, glass.found));
      glass.powers = Buffer(powers.data(), powers.size() * sizeof(float));
    }
    number_ = own_->number;
    glFinish();
  }

  void resolve(const GBuffer& gbuffer, VisibilityMask& mask) override {
    const StateGuard guard;
    gbuffer_ = &gbuffer;
    const bool counts_at_eye = count.is("zpass_plus") && !uses_near_rectangle();
    volumes_at_eye_ = counts_at_eye ? volumes_at(made_->adjacency, gbuffer.view.eye, silhouette()) : 0;
    for (std::size_t k = 0; k < glass_.size(); ++k)
      glass_[k].volumes_at_eye =
          counts_at_eye ? volumes_at(own_->glass[k].adjacency, gbuffer.view.eye, glass_silhouette(k)) : 0;
    answer(mask);
  }

  Counts counts() const override {
    double closed = 0, open = 0, edges = 0;  // edges with multiplicity
    std::size_t triangles = commands_.triangle_count();
    std::int64_t depth_bound = 0;
    auto own_bytes = static_cast<double>(own_->gpu_finder.bytes() + own_->cut.bytes());
    const auto add = [&](const EdgeAdjacency& adjacency, const Silhouette& silhouette, std::int64_t bound) {
      const auto closed_here = std::ranges::count_if(adjacency.parts(), &EdgeAdjacency::Part::closed);
      closed += double(closed_here);
      open += double(std::ssize(adjacency.parts()) - closed_here);
      for (const SilhouetteEdge& edge : silhouette.edges) edges += std::abs(edge.count);
      if (finder.is("gpu")) bound = bound_depth(adjacency, silhouette, VolumeCounter::stencil_limit);
      depth_bound = std::max(depth_bound, bound);
    };
    add(made_->adjacency, silhouette(), depth_bound_);
    std::size_t bytes = VolumeTechnique::bytes();
    std::int64_t at_eye = volumes_at_eye_;
    for (std::size_t k = 0; k < glass_.size(); ++k) {
      add(own_->glass[k].adjacency, glass_silhouette(k), glass_[k].found.depth_bound);
      triangles += glass_[k].found.commands.triangle_count();
      bytes += glass_[k].bytes();
      own_bytes += static_cast<double>(own_->glass[k].bytes());
      at_eye += glass_[k].volumes_at_eye;
    }
    bytes += static_cast<std::size_t>(own_.own(own_bytes));
    Counts counts{{"closed_parts", closed, ""},
                  {"open_parts", open, ""},
                  {"silhouette_edges", edges, ""},
                  {"triangles", double(triangles), ""},
                  {"depth_bound", double(depth_bound), "", Count::Together::largest},
                  {"bytes", double(bytes), "byte"}};
    if (!gbuffer_) return counts;

    const auto [fill, deepest] = measure_work();
    counts.insert(counts.end(), {{"fill", fill, "pixel"},
                                 {"deepest", deepest, "volume", Count::Together::largest},
                                 {"volumes_at_eye", double(at_eye), "volume"},
                                 {"counter_bits", keeps_wide() ? 32.0 : 8.0, "bit", Count::Together::largest}});
    return counts;
  }

  /// The element is the first triangle of the scene, by number, between the point and the light: its volume holds the point.
  std::optional<Explanation> explain(std::size_t index) const override {
    Explanation why;
    if (!faces_light(*made_->scene, *gbuffer_, light_, index)) return why;
    if (!own_->casters) own_->casters = std::make_unique<CasterTree>(made_->adjacency);
    const Segment way{gbuffer_->position(index), homogeneous(light_)};
    const auto is_part = [&](std::uint32_t t) { return takes_part(t); };
    why.element = first_caster(*own_->casters, made_->adjacency, own_->cut, way, is_part);
    return why;
  }

  std::unique_ptr<Technique> for_another_light() const override {
    return another(*this, &StencilVolume::made_, &StencilVolume::own_);
  }

 private:
  /// Its pieces are drawn from the eye, too: light caps tie with nothing else.
  CutMasks cut(const Scene& scene) const { return masks.cut(scene, CutMasks::Drawn::pieces); }
  /// Of a scene without holes.
  Support supports_polygons(const Scene& scene, const Light& light, const View& view) const {
    GlLimits needed = FaceDrawer::needs(scene);
    if (finder.is("gpu")) needed = most_of(needed, GpuFinder::needs(scene));
    if (scene.has_transmission()) needed = most_of(needed, {.fragment_storage_blocks = 1});
    if (const Support enough = within_limits(needed); !enough) return enough;
    if (count.is("zfail")) return Support::full();
    EyePlace eye;
    for_groups(scene, [&](float, const Scene& casters) { eye = both(eye, EyePlaceFinder(casters, light, view).place()); });
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
    return !is_between(homogeneous(light_), gbuffer_->view, near_plane, near_plane);
  }
  bool is_wide(std::int64_t bound) const { return counts_wide_ || counter.is("wide") || bound > VolumeCounter::stencil_limit; }
  bool keeps_wide() const override { return wide_ || std::ranges::any_of(glass_, &GroupFaces::wide); }

  /// What of the scene is taken anew in every pose, beside adjacency.
  void take_positions() {
    own_->casters.reset();
    scene_buffers(*made_->scene);
    made_->far_planes = FarPlanes(*made_->scene);
  }

  void begin(Pass pass, std::int64_t volumes_at_eye) const {
    made_->counter.begin(depth_stencil(*made_->scene, *gbuffer_), gbuffer_textures(*gbuffer_, *made_->scene), pass, where(),
                         static_cast<int>(volumes_at_eye));
  }
  /// Opaque casters and glass in one count.
  void draw(Pass pass) const override {
    std::int64_t at_eye = volumes_at_eye_;
    for (const GroupFaces& glass : glass_) at_eye += glass.volumes_at_eye;
    begin(pass, at_eye);
    draw_faces(faces_, pass);
    for (const GroupFaces& glass : glass_) draw_faces(glass.faces, pass);
  }
  /// One count for the opaque casters, and one for each transmission.
  void answer(VisibilityMask& mask) const override {
    const GBufferTextures& textures = gbuffer_textures(*gbuffer_, *made_->scene);
    begin(mask_pass(), volumes_at_eye_);
    draw_faces(faces_, mask_pass());
    made_->counter.write_mask(textures, light_, mask);
    for (const GroupFaces& glass : glass_) {
      begin(pass_of(glass.wide), glass.volumes_at_eye);
      draw_faces(glass.faces, pass_of(glass.wide));
      made_->counter.multiply_mask(textures, light_, glass.powers, mask);
    }
    glFinish();
  }
  void draw_faces(const FaceBuffers& faces, Pass pass) const {
    bind_faces(scene_buffers(*made_->scene).positions, faces);
    if (uses_near_rectangle() && pass != Pass::layer) {
      glEnable(GL_DEPTH_CLAMP);
      draw_near_cap(own_->near_cap_program, made_->drawer, made_->counter, *gbuffer_, *made_->scene, homogeneous(light_));
      glDisable(GL_DEPTH_CLAMP);  // what lies before the near plane is in the near cap
    }
    if (extrusion.is("silhouette"))
      made_->drawer.draw_sides(made_->counter);
    else
      made_->drawer.draw_arrays(made_->counter, own_->triangle_sides, VolumeFace::side, offsetof(FaceCommands, triangle_sides));
    // Before the surface, what the eye sees ends at the light caps; through casters that it does not see it enters there.
    if (where() == CountWhere::behind_surface)
      made_->drawer.draw_caps(made_->counter);
    else if (own_->has_unseen)
      made_->drawer.draw_light_caps(made_->counter);
    glBindVertexArray(0);
  }

  /// What the device found stays there: the first request in memory computes it again.
  const Silhouette& silhouette() const override {
    if (is_on_device_only_) made_->adjacency.find_silhouette(homogeneous(light_), silhouette_);
    is_on_device_only_ = false;
    return silhouette_;
  }
  const Silhouette& glass_silhouette(std::size_t k) const {
    GroupFaces& glass = glass_[k];
    if (glass.found.is_on_device_only) own_->glass[k].adjacency.find_silhouette(homogeneous(light_), glass.silhouette);
    glass.found.is_on_device_only = false;
    return glass.silhouette;
  }
  /// Whether a triangle has a volume.
  bool takes_part(std::uint32_t triangle) const {
    if (silhouette().facing[triangle] != 0) return true;
    for (std::size_t k = 0; k < glass_.size(); ++k)
      if (glass_silhouette(k).facing[triangle] != 0) return true;
    return false;
  }
  std::vector<Line> outlines() const override {
    std::vector<Line> lines = VolumeTechnique::outlines();
    for (std::size_t k = 0; k < glass_.size(); ++k) {
      const std::vector<Line> glass = silhouette_lines(own_->glass[k].adjacency, glass_silhouette(k));
      lines.insert(lines.end(), glass.begin(), glass.end());
    }
    return lines;
  }

  struct Own {
    CutMasks cut;
    VolumeProgram triangle_sides, near_cap_program;
    GpuFinder gpu_finder;
    std::vector<GlassGroup> glass;
    bool has_unseen = false;              // casters
    std::unique_ptr<CasterTree> casters;  // made by the first `explain`
    EdgeAdjacency::Moved moved;           // by the last update
    std::uint64_t number = 0;             // of the geometry: 1 more with each update, 2 more with each build
  };
  Shared<Own> own_;
  mutable std::vector<GroupFaces> glass_;  // as own_->glass; read by `glass_silhouette`
  std::uint64_t number_ = 0;               // of the geometry of the last relight
  WantedFaces wanted_;                     // of the last relight
  std::int64_t depth_bound_ = 0;
  mutable bool is_on_device_only_ = false;  // the silhouette
  bool counts_wide_ = false;                // while setup warms the wide pass
  std::int64_t volumes_at_eye_ = 0;
};

}  // namespace

GNOMON_TECHNIQUE(stencil_volume, StencilVolume, about)
