// Stencil shadow volumes: faces of the casters' shadow volumes, counted per pixel by the rasterizer.
//
// Source: Crow 1977; Heidmann 1991 (zpass); Everitt and Kilgard 2002 (zfail, infinite far plane, caps); Hornus, Hoberock,
//         Lefebvre and Hart 2005 (zpass_plus); Bergeron 1986 and Kim, Kim and Jung 2008 (open and non-manifold meshes: edges
//         with multiplicity); Lengyel 2011, Table 10.1 (winding of side quads).
// Error:  exact up to the rasterizer's snapping of vertices to 1/256 pixel: the share of pixels that a shift by half of that
//         would flip is the row's snapping_floor. Light caps and lit surfaces tie bit for bit, so there is no bias.
// Fails:  zpass with the eye in a shadow volume (every pixel is off by the volumes around the eye), and says so. An edge that
//         meets the middle of another one (T-junction) is a crack of the input: single pixels along its side quad may be wrong.
//         A closed mesh that winds around some region the wrong way (self-intersecting) lights receivers inside that region.
#include <gnomon/kit/box_tree.h>
#include <gnomon/kit/camera.h>
#include <gnomon/kit/depth_bound.h>
#include <gnomon/kit/gl_volumes.h>
#include <gnomon/kit/lines.h>
#include <gnomon/registry.h>

#include <memory>

#include "stencil_volume/eye_place.h"
#include "stencil_volume/faces.h"
#include "stencil_volume/gpu_finder.h"
#include "stencil_volume/shaders.h"

namespace {
using namespace gnomon;
using stencil_volume::Commands;

class StencilVolume final : public Technique {
  Choice count{this,           "count",
               "zfail",        {"zpass", "zfail", "zpass_plus"},
               Stage::relight, "Faces before the surface, behind it, or before it with the volumes around the eye added."};
  Choice extrusion{this,           "extrusion",
                   "silhouette",   {"silhouette", "per_triangle"},
                   Stage::relight, "One side quad for every edge of the outline, or for every edge of every triangle."};
  Choice finder{this,         "finder",
                "cpu",        {"cpu", "gpu"},
                Stage::setup, "Who finds the outline and caps that a light sees: the processor's threads, or compute shaders."};
  Choice near_cap{this,
                  "near_cap",
                  "eye",
                  {"eye", "rectangle"},
                  Stage::relight,
                  "For zpass_plus: the volumes around the eye, or the casters thrown onto the near rectangle as published."};
  Choice counter{this,
                 "counter",
                 "auto",
                 {"auto", "wide"},
                 Stage::relight,
                 "Eight stencil bits where no more than 255 volumes can overlap and 32 bits elsewhere, or always 32 bits."};

 public:
  Support supports(const Scene& scene, const Light& light, const View& view) const override;
  void setup() override;
  void build(const Scene& scene) override;
  void relight(const Light& light) override;
  void resolve(const GBuffer& gbuffer, VisibilityMask& mask) override;
  Counts counts() const override;
  std::optional<Explanation> explain(std::size_t index) const override;
  std::vector<DebugLayer> debug_layers() const override {
    std::vector<DebugLayer> layers = volume_layers();
    layers.push_back(silhouette_layer());
    return layers;
  }
  std::vector<float> draw_debug(std::string_view layer) const override;

 private:
  CountWhere where() const { return count.is("zfail") ? CountWhere::behind_surface : CountWhere::before_surface; }
  bool near_rectangle() const { return count.is("zpass_plus") && near_cap.is("rectangle"); }
  /// The near rectangle of a view as the light sees it, unless the light lies in its plane.
  bool uses_near_rectangle(const View& view) const {
    return near_rectangle() && !stencil_volume::is_in_near_plane(homogeneous(light_), view);
  }
  /// The mask of `gbuffer_`.
  void answer(VisibilityMask& mask) const;
  /// Begins a pass, draws every face, and leaves the pass open.
  void draw(VolumeCounter::Pass pass) const;
  void draw_near_cap() const;
  void draw_faces() const;

  VolumeProgram sides_, triangle_sides_, fan_, far_triangles_, caps_, near_cap_program_;
  mutable VolumeCounter counter_;
  VertexArray vertex_array_;

  const Scene* scene_ = nullptr;
  EdgeAdjacency adjacency_;
  Silhouette silhouette_;
  stencil_volume::Faces faces_;
  stencil_volume::GpuFinder gpu_finder_;
  Commands commands_;
  Light light_;
  std::int64_t depth_bound_ = 0;
  bool wide_ = false;
  bool counts_wide_ = false;  // while setup warms the wide pass
  const GBuffer* gbuffer_ = nullptr;
  std::int64_t volumes_at_eye_ = 0;
  mutable std::unique_ptr<BoxTree> casters_;  // for questions only
};

Support StencilVolume::supports(const Scene& scene, const Light& light, const View& view) const {
  if (has_area(light)) return Support::unsupported("a shadow volume has one apex: lights with area have none");
  if (count.is("zfail")) return Support::full();
  const stencil_volume::EyePlace eye = stencil_volume::EyePlaceFinder(scene, light, view)();
  if (eye.boundary) return Support::approximate("the eye lies on the boundary of a shadow volume, within rounding");
  if (eye.inside && count.is("zpass"))
    return Support::approximate("the eye is inside a shadow volume, which zpass does not count");
  if (eye.near_plane && count.is("zpass")) return Support::approximate("the near plane cuts a shadow volume next to the eye");
  if (near_rectangle() && stencil_volume::is_in_near_plane(homogeneous(light), view))
    return Support::approximate("the light lies in the near plane: the volumes around the eye are counted instead");
  if (eye.near_plane && near_rectangle())
    return Support::approximate("a shadow volume cuts the near rectangle, where near cap and sides do not meet in every pixel");
  return Support::full();
}

void StencilVolume::setup() {
  const auto program = [](std::string_view title, std::string_view body) {
    std::string vertex(position_snippet);
    vertex += stencil_volume::fetch_head, vertex += stencil_volume::quad_head, vertex += body;
    return VolumeProgram(title, vertex);
  };
  sides_ = program("stencil_volume sides", stencil_volume::sides_body);
  triangle_sides_ = program("stencil_volume triangle sides", stencil_volume::triangle_sides_body);
  fan_ = program("stencil_volume fan", stencil_volume::fan_body);
  far_triangles_ = program("stencil_volume far triangles", stencil_volume::far_triangles_body);
  caps_ = VolumeProgram("stencil_volume caps", std::string(position_snippet) + std::string(stencil_volume::caps_body));
  near_cap_program_ =
      VolumeProgram("stencil_volume near cap", std::string(position_snippet) + std::string(stencil_volume::near_cap_body));
  counter_.setup();
  if (finder.is("gpu")) gpu_finder_.setup();
  vertex_array_ = make_vertex_array();
  glVertexArrayAttribFormat(vertex_array_.name(), 0, 3, GL_FLOAT, GL_FALSE, 0);
  glVertexArrayAttribBinding(vertex_array_.name(), 0, 0);
  glEnableVertexArrayAttrib(vertex_array_.name(), 0);
  counts_wide_ = true;  // the pass of deep scenes, and of counts()
  warm_up(*this);
  counter_.drop_pictures();
  counts_wide_ = false;
  warm_up(*this);
}

void StencilVolume::build(const Scene& scene) {
  scene_ = &scene;
  casters_.reset();
  scene_buffers(scene);
  adjacency_ = EdgeAdjacency(scene);
  if (finder.is("gpu")) gpu_finder_.build(adjacency_);
}

void StencilVolume::relight(const Light& light) {
  const StateGuard guard;
  light_ = light;
  const glm::dvec4 l = homogeneous(light);
  const bool behind = where() == CountWhere::behind_surface;
  const stencil_volume::Wanted wanted{
      .outline = extrusion.is("silhouette"), .light_caps = behind || near_rectangle(), .dark_caps = behind && l.w != 0};
  if (finder.is("gpu")) {
    gpu_finder_.use_positions(scene_buffers(*scene_));
    commands_ = gpu_finder_.find(adjacency_, l, wanted, faces_, silhouette_);
  } else {
    adjacency_.find_silhouette(l, silhouette_);
    commands_ = write_faces(adjacency_, silhouette_, wanted, faces_);
  }
  depth_bound_ = bound_depth(adjacency_, silhouette_, VolumeCounter::stencil_limit);
  wide_ = counts_wide_ || counter.is("wide") || depth_bound_ > VolumeCounter::stencil_limit;
  glFinish();
}

void StencilVolume::resolve(const GBuffer& gbuffer, VisibilityMask& mask) {
  const StateGuard guard;
  gbuffer_ = &gbuffer;
  volumes_at_eye_ = 0;
  if (count.is("zpass_plus") && !uses_near_rectangle(gbuffer.view))
    volumes_at_eye_ = stencil_volume::volumes_at(adjacency_, gbuffer.view.eye, silhouette_);
  answer(mask);
}

void StencilVolume::answer(VisibilityMask& mask) const {
  draw(wide_ ? VolumeCounter::Pass::wide : VolumeCounter::Pass::stencil);
  counter_.write_mask(gbuffer_textures(*gbuffer_, *scene_), light_, mask);
  glFinish();
}

void StencilVolume::draw(VolumeCounter::Pass pass) const {
  counter_.begin(depth_stencil(*scene_, *gbuffer_), pass, where(), static_cast<int>(volumes_at_eye_));
  const SceneBuffers& buffers = scene_buffers(*scene_);
  glVertexArrayVertexBuffer(vertex_array_.name(), 0, buffers.positions.name(), 0, sizeof(glm::vec3));
  if (faces_.caps.name()) glVertexArrayElementBuffer(vertex_array_.name(), faces_.caps.name());
  glBindVertexArray(vertex_array_.name());
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, buffers.positions.name());
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 1, faces_.sides.name());
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 2, faces_.triangles.name());
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 3, faces_.hubs.name());
  glBindBuffer(GL_DRAW_INDIRECT_BUFFER, faces_.commands.name());
  if (uses_near_rectangle(gbuffer_->view) && pass != VolumeCounter::Pass::layer) {
    draw_near_cap();
    glDisable(GL_DEPTH_CLAMP);  // what lies before the near plane is in the near cap
  }
  draw_faces();
  glBindVertexArray(0);
}

/// Triangles between light and near plane, thrown onto the plane: M = (P.L) I - L P^T, as for planar projected shadows.
void StencilVolume::draw_near_cap() const {
  const Camera camera(gbuffer_->view, gbuffer_->width, gbuffer_->height);
  const glm::dvec4 light = homogeneous(light_);
  glm::dvec4 plane(camera.forward, -glm::dot(camera.forward, camera.eye) - double(near_plane));
  const bool behind = glm::dot(plane, light) < 0;  // the light looks the eye's way
  if (behind) plane = -plane;
  const double height = glm::dot(plane, light);
  const glm::dmat4 projected = height * glm::dmat4(1) - glm::outerProduct(light, plane);
  const glm::dmat4 clip = clip_from_world(gbuffer_->view, gbuffer_->width, gbuffer_->height) * projected;
  near_cap_program_.each([&](const Program& p) {
    p.set("clip_from_world", glm::mat4(clip));
    p.set("plane", glm::vec4(plane));
    p.set("light_height", static_cast<float>(height));
    p.set("light_w", static_cast<float>(light.w));
  });
  glEnable(GL_CLIP_DISTANCE0);
  glEnable(GL_CLIP_DISTANCE1);
  // Seen with the light they keep their turn, seen against it they change it.
  counter_.use(near_cap_program_, VolumeFace::light_cap, !behind);
  glDrawElementsIndirect(GL_TRIANGLES, GL_UNSIGNED_INT, reinterpret_cast<const void*>(offsetof(Commands, caps)));
  counter_.use(near_cap_program_, VolumeFace::light_cap, behind);
  glDrawElementsIndirect(GL_TRIANGLES, GL_UNSIGNED_INT, reinterpret_cast<const void*>(offsetof(Commands, reversed_caps)));
  glDisable(GL_CLIP_DISTANCE0);
  glDisable(GL_CLIP_DISTANCE1);
}

void StencilVolume::draw_faces() const {
  const glm::mat4 clip(clip_from_world(gbuffer_->view, gbuffer_->width, gbuffer_->height));
  const glm::vec4 light(homogeneous(light_));
  const auto prepare = [&](const VolumeProgram& program, VolumeFace face, bool reversed = false) {
    program.each([&](const Program& p) {
      p.set("clip_from_world", clip);
      if (p.uses("light")) p.set("light", light);
      if (p.uses("directional")) p.set("directional", light.w == 0);
    });
    counter_.use(program, face, reversed);
  };
  const auto arrays = [&](const VolumeProgram& program, VolumeFace face, std::size_t command) {
    prepare(program, face);
    glDrawArraysIndirect(GL_TRIANGLES, reinterpret_cast<const void*>(command));
  };
  const auto elements = [&](bool reversed, std::size_t command) {
    prepare(caps_, VolumeFace::light_cap, reversed);
    glDrawElementsIndirect(GL_TRIANGLES, GL_UNSIGNED_INT, reinterpret_cast<const void*>(command));
  };
  if (extrusion.is("silhouette"))
    arrays(sides_, VolumeFace::side, offsetof(Commands, sides));
  else
    arrays(triangle_sides_, VolumeFace::side, offsetof(Commands, triangle_sides));
  if (where() == CountWhere::before_surface) return;
  elements(false, offsetof(Commands, caps));
  elements(true, offsetof(Commands, reversed_caps));
  if (light.w == 0) return;  // the volume of a directional light ends in one point
  arrays(fan_, VolumeFace::dark_cap, offsetof(Commands, fan));
  arrays(far_triangles_, VolumeFace::dark_cap, offsetof(Commands, far_triangles));
}

Counts StencilVolume::counts() const {
  std::size_t closed = 0;
  for (const EdgeAdjacency::Part& part : adjacency_.parts()) closed += part.closed;
  const double corners = commands_.sides.count + commands_.fan.count + commands_.triangle_sides.count +
                         commands_.far_triangles.count + commands_.caps.count + commands_.reversed_caps.count;
  double edges = 0;  // with multiplicity
  for (const SilhouetteEdge& edge : silhouette_.edges) edges += std::abs(edge.count);
  Counts counts{{"closed_parts", double(closed), ""},
                {"open_parts", double(adjacency_.parts().size() - closed), ""},
                {"silhouette_edges", edges, ""},
                {"triangles", corners / 3, ""},
                {"depth_bound", double(depth_bound_), ""}};
  counts.push_back({"bytes",
                    double(adjacency_.bytes() + silhouette_.bytes() + faces_.bytes() + gpu_finder_.bytes() + counter_.bytes()),
                    "byte"});
  if (!gbuffer_) return counts;

  // What the stencil cannot tell, by a pass in 32 bits that is thrown away.
  const StateGuard guard;
  draw(VolumeCounter::Pass::wide);
  const auto [fill, deepest] = counter_.work();
  counter_.end();
  if (!wide_) counter_.drop_pictures();
  counts.push_back({"fill", fill, "pixel"});
  counts.push_back({"deepest", deepest, "volume"});
  counts.push_back({"volumes_at_eye", double(volumes_at_eye_), "volume"});
  counts.push_back({"counter_bits", wide_ ? 32.0 : 8.0, "bit"});
  return counts;
}

/// The element is the first triangle of the scene, by number, between the point and the light: its volume holds the point.
std::optional<Explanation> StencilVolume::explain(std::size_t index) const {
  Explanation why;
  if (!faces_light(*scene_, *gbuffer_, light_, index)) return why;
  const auto corners = [&](std::size_t t) {
    const glm::uvec3& v = adjacency_.triangles()[t];
    return Triangle{{adjacency_.positions()[v.x], adjacency_.positions()[v.y], adjacency_.positions()[v.z]}};
  };
  if (!casters_) {
    std::vector<Bounds> bounds(adjacency_.triangles().size());
    for (std::size_t t = 0; t < bounds.size(); ++t)
      for (const glm::vec3& p : corners(t).points) bounds[t].add(p);
    casters_ = std::make_unique<BoxTree>(bounds);
  }
  const Segment way{gbuffer_->position(index), homogeneous(light_)};
  std::uint64_t first = adjacency_.triangles().size();
  casters_->any(SegmentSlabs(way), 0, [&](std::uint32_t place) {
    const std::uint32_t t = casters_->order()[place];
    if (silhouette_.facing[t] != 0 && crosses(way, corners(t)) != Crossing::none) first = std::min<std::uint64_t>(first, t);
    return false;
  });
  if (first < adjacency_.triangles().size()) why.element = first;
  return why;
}

std::vector<float> StencilVolume::draw_debug(std::string_view layer) const {
  if (layer != "volumes" && layer != "counts" && layer != "silhouette") return Technique::draw_debug(layer);
  std::vector<float> picture;
  if (layer == "counts") {
    const StateGuard guard;
    draw(VolumeCounter::Pass::wide);
    std::vector<float> counts;
    for (const VolumeCounter::WideCount& pixel : counter_.wide_counts()) counts.push_back(pixel.count);
    picture = heat_layer(*gbuffer_, counts);
    counter_.end();
  } else {
    VisibilityMask mask(gbuffer_->width, gbuffer_->height);
    {
      const StateGuard guard;
      answer(mask);
    }
    picture = shaded_layer(*scene_, *gbuffer_, light_, mask.read());
    if (layer == "silhouette") {
      draw_lines(silhouette_lines(adjacency_, silhouette_), *gbuffer_, picture);
    } else {
      const StateGuard guard;
      draw(VolumeCounter::Pass::layer);
      paint_volumes(counter_.layer_faces(), gbuffer_->width, picture);
      counter_.end();
    }
  }
  if (!wide_) counter_.drop_pictures();
  return picture;
}

}  // namespace

GNOMON_TECHNIQUE(
    stencil_volume, StencilVolume,
    {.title = "Stencil shadow volumes",
     .summary = "Faces of the casters' shadow volumes, counted per pixel by the rasterizer.",
     .source = "Crow 1977; Heidmann 1991; Everitt and Kilgard 2002; Hornus et al. 2005",
     .error = "Exact up to the rasterizer's snapping of vertices to 1/256 pixel; no bias.",
     .fails = "The count zpass with the eye in a shadow volume; single pixels at T-junctions of the mesh; receivers inside a "
              "closed mesh that is turned inside out there.",
     .needs_gl = true})
