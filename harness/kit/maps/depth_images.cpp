#include <gnomon/kit/maps/light_map.h>

#include <cassert>

namespace gnomon {

namespace {

const std::string second_fragment = R"(
layout(binding = 3) uniform sampler2DArray first_depth;
uniform int layer;
void main() {
#ifdef MASKED
  if (in_hole()) discard;
#endif
  if (gl_FragCoord.z >= texelFetch(first_depth, ivec3(gl_FragCoord.xy, layer), 0).r) discard;
}
)";

}  // namespace

bool is_seen_from_outside(std::span<const Bounds> solid_parts, const LightSpaceFace& face) {
  const auto holds_light = [&](const Bounds& part) { return part.holds(face.origin); };  // a part's box holds its border, too
  return !solid_parts.empty() && !(face.is_perspective && std::ranges::any_of(solid_parts, holds_light));
}

void DepthImages::setup() {
  first_ = CasterPrograms("depth from the light", depth_vertex, depth_fragment);
  second_ = CasterPrograms("second depth from the light", depth_vertex, second_fragment);
  framebuffer_ = make_framebuffer();
}

void DepthImages::build(const Scene& scene, AlphaRule rule, GlassAs glass) {
  scene_ = &scene;
  boxes_ = mesh_boxes(scene, glass);
  moving_.build(scene);
  solid_parts_ = solid_parts(scene);
  scene_buffers(scene);
  alpha_levels_ = {};
  use_alpha(rule);
}

bool DepthImages::update(const Scene& scene, const Changes& changes) {
  assert(&scene == scene_);
  if (!moving_.update(scene, changes)) return false;
  for (std::size_t m = 0; m < scene.meshes.size(); ++m)
    if (changes.meshes[m].kind != MeshChange::Kind::still) solid_parts_[m] = solid_parts(scene.meshes[m]);
  scene_buffers(scene);
  return true;
}

void DepthImages::use_alpha(AlphaRule rule) {
  alpha_levels_.use(*scene_, rule);
  first_.fit(*scene_, rule);
  second_.fit(*scene_, rule);
}

void DepthImages::StillLayer::start_relight(const MovingMeshes& moving, const UpdateSetting& wanted) {
  is_wanted_ = wanted.keeps_layers();
  may_be_kept_ = moving.number().is_update_of(relit_);
  relit_ = moving.number();
}

std::size_t DepthImages::draw(const LightCamera& camera, Texture& target, Faces faces, const HoleTest& test) {
  return draw(first_, camera, target, faces, test, Which::all);
}

std::size_t DepthImages::draw(const LightCamera& camera, Texture& target, StillLayer& still, Faces faces,
                              const HoleTest& test) {
  const bool is_kept = still.may_be_kept_ && moving_.number().is_update_of(still.drawn_) && still.faces_ == faces &&
                       still.rule_ == test.rule && still.image_.format == format_ && still.camera_ == camera;
  still.drawn_ = {};  // until all is drawn
  still.was_kept_ = false;
  if (!still.is_wanted_ || !moving_.divide(boxes_)) {
    still.image_ = {};
    return draw(camera, target, faces, test);
  }
  std::size_t triangles = 0;
  if (!is_kept) triangles += draw(first_, camera, still.image_, faces, test, Which::still);
  copy_layer(camera, still.image_, target, is_kept && !still.is_drawn_over);
  triangles += draw(first_, camera, target, faces, test, Which::moving);
  still.camera_ = camera;
  still.rule_ = test.rule;
  still.faces_ = faces;
  still.drawn_ = moving_.number();
  still.was_kept_ = is_kept;
  return triangles;
}

void DepthImages::copy_layer(const LightCamera& camera, const Texture& layer, Texture& target,
                             bool only_where_casters_move) const {
  target.fit(layer.format, layer.width, layer.height, layer.layers);
  const auto moves = [&](std::uint32_t m) { return moving_.moves(m); };
  for (const LightImage& image : camera.images) {
    if (image.layer < 0 || (only_where_casters_move && std::ranges::none_of(image.casters, moves))) continue;
    glCopyImageSubData(layer.name(), GL_TEXTURE_2D_ARRAY, 0, 0, 0, image.layer, target.name(), GL_TEXTURE_2D_ARRAY, 0, 0, 0,
                       image.layer, layer.width, layer.height, 1);
  }
}

std::size_t DepthImages::draw_second(const LightCamera& camera, const Texture& first, Texture& target, const HoleTest& test) {
  glBindTextureUnit(3, first.name());
  return draw(second_, camera, target, Faces::all, test, Which::all);
}

std::size_t DepthImages::draw(CasterPrograms& programs, const LightCamera& camera, Texture& target, Faces faces,
                              const HoleTest& test, Which which) {
  if (test.rule != hole_test().rule) programs.fit(*scene_, test.rule);
  target.fit(format_, camera.resolution, camera.resolution, std::max(camera.layer_count, 1));
  const SceneBuffers& buffers = scene_buffers(*scene_);
  const GLuint framebuffer = framebuffer_.name();
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
  glViewport(0, 0, camera.resolution, camera.resolution);
  glEnable(GL_DEPTH_TEST);
  glEnable(GL_DEPTH_CLAMP);
  // The same clip coordinates: what differs is where the window's transform rounds.
  const bool is_forward = order_ == DepthOrder::forward;
  glDepthFunc(is_forward ? GL_LESS : GL_GREATER);
  if (is_forward) glDepthRange(1, 0);
  std::size_t triangles = 0;
  std::vector<std::uint32_t> solid, all;
  for (const LightImage& image : camera.images) {
    if (image.layer < 0) continue;
    solid.clear();
    all.clear();
    for (const std::uint32_t m : image.casters) {
      if (!is_drawn(which, m)) continue;
      (faces != Faces::all && is_seen_from_outside(solid_parts_[m], image) ? solid : all).push_back(m);
      triangles += buffers.meshes[m].triangle_count;
    }
    if (which == Which::moving && solid.empty() && all.empty()) continue;
    glNamedFramebufferTextureLayer(framebuffer, GL_DEPTH_ATTACHMENT, target.name(), 0, image.layer);
    const float infinitely_far = is_forward ? 1 : 0;
    if (which != Which::moving) glClearNamedFramebufferfv(framebuffer, GL_DEPTH, 0, &infinitely_far);
    programs.set("clip_from_world", glm::mat4(image.clip_from_world(camera.resolution, camera.shift)));
    programs.set_if_used("shift", camera.shift);
    programs.set_if_used("layer", image.layer);
    buffers.draw(all, programs, test);
    if (solid.empty()) continue;
    glEnable(GL_CULL_FACE);
    const bool is_mirrored = glm::determinant(image.light_from_world) < 0;  // then triangles are turned about
    glFrontFace(is_mirrored == (faces == Faces::lit) ? GL_CW : GL_CCW);
    buffers.draw(solid);  // bodies: none has holes
    glDisable(GL_CULL_FACE);
  }
  glFrontFace(GL_CCW);
  glDepthRange(0, 1);
  glDisable(GL_DEPTH_CLAMP);
  glDisable(GL_DEPTH_TEST);
  glNamedFramebufferTexture(framebuffer, GL_DEPTH_ATTACHMENT, 0, 0);
  return triangles;
}

double half_depth_step(int bits, const LightImage& image, double z) {
  if (bits == 32) return 0;
  const double half = std::ldexp(0.5, -bits);
  return half * (image.is_perspective ? z * z / image.near : image.far - image.near);
}

}  // namespace gnomon
