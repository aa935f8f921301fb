#include <gnomon/kit/gl/gl_pass.h>

#include <chrono>
#include <cmath>

#include "kit/gbuffer_texels.h"
#include "kit/gl/gl_masks.h"
#include "kit/gl/gl_scene_buffers.h"
#include "kit/gl/pixel_rectangles.h"

namespace gnomon {

namespace {

/// Milliseconds of `work`, the queue drained before and after.
template <class Work>
double drained_ms(const Work& work) {
  glFinish();
  const auto start = std::chrono::steady_clock::now();
  work();
  glFinish();
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

struct SceneSlot {
  SceneStamp stamp;
  SceneBuffers buffers;
  UploadedPositions positions;
};

/// A weak pointer keeps the control block of the G-buffer's storage, so that no later G-buffer can be taken for this one, and
/// none of its memory. G-buffers on borrowed arrays (null storage) differ by address, size and scene only. The images are of
/// the G-buffer's arrays and of flags of the scene, whatever pose that is in; depth is drawn from the pose.
struct GBufferSlot {
  std::weak_ptr<const void> storage;
  const float* data = nullptr;
  SceneStamp scene;
  GBufferTextures textures;
  SceneStamp drawn;  ///< of what both depths were drawn from
  DepthStencil depth, shape_depth;

  bool holds(const GBuffer& g, const SceneStamp& of_scene) const {
    const bool is_its_scene = g.storage ? scene.identity == of_scene.identity : scene == of_scene;
    return is_its_scene && data == g.px.data() && textures.position.width == g.width && textures.position.height == g.height &&
           !storage.owner_before(g.storage) && !g.storage.owner_before(storage);
  }
  void forget_depth() {
    depth = {};
    shape_depth = {};
  }
};

/// How many scenes and how many G-buffers are held; the least recently used goes first.
constexpr std::size_t slot_count = 4;

/// What is held for the one context; slots from most to least recently used.
struct Inputs {
  std::vector<std::unique_ptr<SceneSlot>> scenes;
  std::vector<std::unique_ptr<GBufferSlot>> gbuffers;
  CasterPrograms depth_programs;
  Program shape_depth_program;
};
std::uint64_t uploaded_bytes = 0;  // of triangles
bool is_depth_used[2] = {};        // by what is seen

// Not destroyed at exit: the context may be gone by then.
Inputs& inputs() {
  static Inputs* const inputs = new Inputs;
  return *inputs;
}

/// The slot that `is_wanted`, moved to the front; else a new one that `make` fills.
template <class Slot, class IsWanted, class Make>
Slot& find_or_make(std::vector<std::unique_ptr<Slot>>& slots, const IsWanted& is_wanted, const Make& make) {
  auto found = std::ranges::find_if(slots, [&](const auto& slot) { return is_wanted(*slot); });
  if (found == slots.end()) {
    if (slots.size() == slot_count) slots.pop_back();
    slots.push_back(std::make_unique<Slot>(make()));
    found = slots.end() - 1;
  }
  std::rotate(slots.begin(), found, found + 1);
  return *slots.front();
}

/// A view that shows nothing has its target for its nearest point.
double near_plane_of(const GBuffer& g) {
  const glm::dvec3 eye = g.view.eye, way = glm::dvec3(g.view.target) - eye, forward = glm::normalize(way);
  double nearest = INFINITY;
  for (std::size_t i = 0; i < g.size(); ++i) {
    if (g.is_background(i)) continue;
    const double distance = glm::dot(forward, glm::dvec3(g.position(i)) - eye);
    if (distance > 0) nearest = std::min(nearest, distance);  // else it is rounded behind the eye
  }
  return std::ldexp(GBufferTextures::near_share, std::ilogb(nearest < INFINITY ? nearest : glm::length(way)));
}

GBufferTextures upload(const GBuffer& g, const Scene& scene) {
  const GBufferTexels texels(g, scene);
  GBufferTextures textures;
  textures.near_plane = near_plane_of(g);
  textures.receivers = rectangles_around(g.width, g.height, [&](std::size_t i) { return texels.normals[i].w != 0; });
  textures.upload_ms = drained_ms([&] {
    const auto fill = [&](GLenum format, GLenum components, GLenum type, const void* data) {
      Texture texture(format, g.width, g.height);
      glTextureSubImage2D(texture.name(), 0, 0, 0, g.width, g.height, components, type, data);
      textures.bytes += texture.bytes;
      return texture;
    };
    textures.position = fill(GL_RGBA32F, GL_RGBA, GL_FLOAT, texels.positions.data());
    textures.normal = fill(GL_RGBA32F, GL_RGBA, GL_FLOAT, texels.normals.data());
    textures.ids = fill(GL_RG32UI, GL_RG_INTEGER, GL_UNSIGNED_INT, texels.ids.data());
  });
  return textures;
}

/// Depth of the G-buffer's points on curved shapes; w is summed as in place().
constexpr std::string_view shape_depth_fragment = R"(
layout(binding = 0) uniform sampler2D gbuffer_position;
layout(binding = 2) uniform usampler2D gbuffer_ids;
layout(std430, binding = 0) readonly buffer IsCurved { uint is_curved[]; };
uniform vec4 w_row;  // of clip_from_world
uniform float near_plane;
void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  uint mesh = texelFetch(gbuffer_ids, pixel, 0).x;  // plus one
  if (mesh == 0 || is_curved[mesh - 1] == 0) discard;
  vec3 point = texelFetch(gbuffer_position, pixel, 0).xyz;
  precise float w = ((w_row.x * point.x + w_row.y * point.y) + w_row.z * point.z) + w_row.w;
  gl_FragDepth = near_plane / w;
}
)";

GBufferSlot& gbuffer_slot(const GBuffer& gbuffer, const Scene& scene) {
  const SceneStamp wanted(scene);
  return find_or_make(
      inputs().gbuffers, [&](const GBufferSlot& slot) { return slot.holds(gbuffer, wanted); },
      [&] { return GBufferSlot{gbuffer.storage, gbuffer.px.data(), wanted, upload(gbuffer, scene), {}, {}, {}}; });
}

}  // namespace

GlLimits inputs_need(const Scene& scene, int width, int height) {
  GlLimits needed{.texture_size = std::max(width, height)};
  for (const std::size_t bytes : {mask_bytes(scene), transmission_bytes(scene)}) {
    if (bytes == 0) continue;
    needed.fragment_storage_blocks += 1;
    needed.storage_bindings = 8;
    needed.storage_block_bytes = std::max(needed.storage_block_bytes, static_cast<std::int64_t>(bytes));
  }
  if (!scene.has_curved_shapes()) return needed;
  const GlLimits shapes{.fragment_storage_blocks = 1,
                        .storage_bindings = 1,
                        .storage_block_bytes = static_cast<std::int64_t>(scene.meshes.size() * sizeof(std::uint32_t))};
  return most_of(needed, shapes);
}

const SceneBuffers& scene_buffers(const Scene& scene) {
  const SceneStamp wanted(scene);
  const auto is_wanted = [&](const SceneSlot& slot) {
    return slot.stamp == wanted || (wanted.is_later_pose_of(slot.stamp) && can_take_positions(scene, slot.positions));
  };
  SceneSlot& slot = find_or_make(inputs().scenes, is_wanted, [&] {
    SceneSlot made{wanted, {}, {}};
    made.buffers = upload_scene(scene, made.positions);
    uploaded_bytes += made.buffers.bytes;
    return made;
  });
  if (slot.stamp != wanted) {
    uploaded_bytes += upload_positions(scene, slot.buffers, slot.positions);
    slot.stamp = wanted;
  }
  return slot.buffers;
}

const SceneBuffers* uploaded_scene(const Scene& scene) {
  const SceneStamp wanted(scene);
  const auto found = std::ranges::find(inputs().scenes, wanted, [](const auto& slot) { return slot->stamp; });
  return found == inputs().scenes.end() ? nullptr : &(*found)->buffers;
}

void forget_scene(const Scene& scene) {
  const std::uint64_t wanted = SceneStamp(scene).identity;
  std::erase_if(inputs().scenes, [&](const auto& slot) { return slot->stamp.identity == wanted; });
  for (const auto& slot : inputs().gbuffers)
    if (slot->scene.identity == wanted) slot->forget_depth();
}

std::uint64_t uploaded_scene_bytes() { return uploaded_bytes; }

bool uses_depth_stencil(Truth sees) { return is_depth_used[static_cast<std::size_t>(sees)]; }

UploadCost picture_uploads(const Scene& scene, const GBuffer& gbuffer) {
  UploadCost cost;
  const SceneStamp wanted(scene);
  for (const auto& slot : inputs().gbuffers)
    if (slot->holds(gbuffer, wanted))
      cost = {slot->textures.bytes + slot->depth.bytes + slot->shape_depth.bytes,
              slot->textures.upload_ms + slot->depth.upload_ms + slot->shape_depth.upload_ms};
  return cost;
}

const GBufferTextures& gbuffer_textures(const GBuffer& gbuffer, const Scene& scene) {
  return gbuffer_slot(gbuffer, scene).textures;
}

glm::dmat4 clip_from_world(const GBuffer& gbuffer, const Scene& scene) {
  return clip_from_world(gbuffer.view, gbuffer.width, gbuffer.height, gbuffer_textures(gbuffer, scene).near_plane);
}

const DepthStencil& depth_stencil(const Scene& scene, const GBuffer& gbuffer, Truth sees) {
  is_depth_used[static_cast<std::size_t>(sees)] = true;
  const bool shows_shapes = sees == Truth::shape && gbuffer.truth == Truth::shape && scene.has_curved_shapes();
  GBufferSlot& slot = gbuffer_slot(gbuffer, scene);
  if (const SceneStamp now(scene); slot.drawn != now) {
    slot.forget_depth();
    slot.drawn = now;
  }
  DepthStencil& depth = shows_shapes ? slot.shape_depth : slot.depth;
  if (depth.texture) return depth;
  CasterPrograms& programs = inputs().depth_programs;
  Program& shape_program = inputs().shape_depth_program;
  const SceneBuffers& buffers = scene_buffers(scene);
  if (!programs.solid()) programs = CasterPrograms("depth of the view", depth_vertex, depth_fragment);
  programs.fit(scene);
  if (shows_shapes && !shape_program)
    shape_program = Program("depth of the shapes in view", full_screen_vertex, shape_depth_fragment);
  std::vector<std::uint32_t> drawn, is_curved;
  for (std::uint32_t i = 0; i < scene.meshes.size(); ++i) {
    is_curved.push_back(scene.meshes[i].has_curved_shape());
    if (scene.meshes[i].seen && (!shows_shapes || !is_curved[i])) drawn.push_back(i);
  }
  depth.upload_ms = drained_ms([&] {
    const StateGuard guard;
    depth.texture = Texture(GL_DEPTH32F_STENCIL8, gbuffer.width, gbuffer.height);
    const Framebuffer framebuffer = make_framebuffer();
    glNamedFramebufferTexture(framebuffer.name(), GL_DEPTH_STENCIL_ATTACHMENT, depth.texture.name(), 0);
    glClearNamedFramebufferfi(framebuffer.name(), GL_DEPTH_STENCIL, 0, 0.0f, 0);
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer.name());
    glViewport(0, 0, gbuffer.width, gbuffer.height);
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_GREATER);
    const glm::mat4 clip(clip_from_world(gbuffer, scene));
    programs.set("clip_from_world", clip);
    buffers.draw(drawn, programs);
    if (!shows_shapes) return;
    const Buffer curved(is_curved.data(), is_curved.size() * 4);
    glDepthFunc(GL_ALWAYS);
    bind_gbuffer(slot.textures);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, curved.name());
    shape_program.set("w_row", glm::vec4(clip[0].w, clip[1].w, clip[2].w, clip[3].w));
    shape_program.set("near_plane", static_cast<float>(slot.textures.near_plane));
    glUseProgram(shape_program.name());
    draw_full_screen();
  });
  depth.bytes = depth.texture.bytes;
  return depth;
}

void release_inputs() {
  inputs() = {};
  release_passes();
}

}  // namespace gnomon
