#include <gnomon/kit/geometry/exact_scene.h>
#include <gnomon/kit/gl/gl_pass.h>
#include <gnomon/kit/volumes/volume_faces.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>

#include "device/context.h"
#include "measure/conformance/gl_state.h"
#include "small_world.h"

namespace gl_test {
using namespace gnomon;

class Gl : public testing::Test {
 protected:
  Gl() { process_context(); }
  void TearDown() override { EXPECT_EQ(state_differences(), std::vector<std::string>{}); }
};

Scene box_on_ground() {
  Scene scene;
  scene.meshes = {small_world::ground(3), small_world::box({-1, 0, -1}, {1, 1.5f, 0.5f})};
  scene.meshes[0].receives = true;
  return scene;
}

const View view{.eye = {3, 4, 5}, .target = {0, 0.5f, 0}};

template <class T>
std::vector<T> read(const Texture& texture, GLenum format, GLenum type) {
  std::vector<T> texels(std::size_t(texture.width) * texture.height);
  glGetTextureImage(texture.name(), 0, format, type, static_cast<GLsizei>(texels.size() * sizeof(T)), texels.data());
  return texels;
}

TEST_F(Gl, context_says_what_draws) {
  const GlInfo& info = process_context().info();
  EXPECT_FALSE(info.renderer.empty());
  EXPECT_NE(info.version.find("4."), std::string::npos);
  EXPECT_EQ(info.is_software(), info.renderer.find("llvmpipe") != std::string::npos);
}

TEST_F(Gl, unknown_choice_of_device_is_an_error_that_names_the_choices) {
  const char* old = std::getenv("GNOMON_GL");
  const std::string kept = old ? old : "";
  setenv("GNOMON_GL", "fast", 1);
  try {
    gl_choice_from_environment();
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(), "GNOMON_GL = fast is none of auto | software | hardware | zink");
  }
  old ? setenv("GNOMON_GL", kept.c_str(), 1) : unsetenv("GNOMON_GL");
}

TEST(gl_driver, zink_over_the_processor_is_neither_software_nor_hardware) {
  EXPECT_EQ(driver_of("llvmpipe (LLVM 15.0.6, 256 bits)"), GlChoice::software);
  EXPECT_EQ(driver_of("zink (llvmpipe (LLVM 15.0.6, 256 bits))"), GlChoice::zink);
  EXPECT_EQ(driver_of("zink (NVIDIA H200)"), GlChoice::hardware);
  EXPECT_EQ(driver_of("AMD Radeon RX 6800 (navi21, LLVM 15.0.6)"), GlChoice::hardware);
}

TEST_F(Gl, state_differences_names_what_was_left_and_the_guard_puts_it_back) {
  const Texture texture(GL_R32F, 1, 1);
  {
    const StateGuard guard;
    glEnable(GL_BLEND);
    glDepthFunc(GL_GREATER);
    glStencilMask(1);
    glEnable(GL_CLIP_DISTANCE3);
    glBindTextureUnit(5, texture.name());
    glColorMask(GL_TRUE, GL_FALSE, GL_TRUE, GL_TRUE);
    EXPECT_EQ(state_differences().size(), 7u);  // the stencil mask counts front and back
  }
  EXPECT_TRUE(state_differences().empty());
}

TEST_F(Gl, a_shader_error_shows_the_log_and_the_numbered_line) {
  try {
    Program("broken", full_screen_vertex, "void main() {\n  nonsense;\n}\n");
    ADD_FAILURE();
  } catch (const Error& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("shader broken (fragment)"), std::string::npos) << text;
    EXPECT_NE(text.find("   3    nonsense;"), std::string::npos) << text;
  }
}

TEST_F(Gl, setting_a_uniform_that_does_not_exist_is_an_error) {
  const Program program("plain", full_screen_vertex, "void main() {}");
  EXPECT_THROW(program.set("missing", 1), Error);
}

// The ray through the center of pixel (x,y) goes to window position (x + 0.5, y + 0.5), at any distance; a point at infinity
// has depth 0, one at distance z along the axis has near_plane / z.
TEST_F(Gl, clip_from_world_sends_pixel_rays_to_their_pixel_centers) {
  const int width = 37, height = 23;
  const double near_plane = 0x1p-10;
  const glm::dmat4 clip = clip_from_world(view, width, height, near_plane);
  const Scene scene = box_on_ground();
  const GBuffer g = small_world::make_gbuffer(scene, view, width, height);
  const glm::dvec3 forward = glm::normalize(glm::dvec3(view.target) - glm::dvec3(view.eye));
  for (std::size_t i = 0; i < g.size(); ++i) {
    if (g.is_background(i)) continue;
    const glm::dvec4 p = clip * glm::dvec4(glm::dvec3(g.position(i)), 1);
    EXPECT_NEAR((p.x / p.w + 1) / 2 * width, i % width + 0.5, 1e-4);
    EXPECT_NEAR((1 - p.y / p.w) / 2 * height, i / width + 0.5, 1e-4);
    EXPECT_NEAR(p.z / p.w, near_plane / glm::dot(forward, glm::dvec3(g.position(i) - view.eye)), 1e-9);
  }
  EXPECT_EQ((clip * glm::dvec4(1, 2, 3, 0)).z, 0);
}

// A thousandth of the way to what the picture shows nearest, at a power of two, so that depths do not depend on the size of a
// scene.
TEST_F(Gl, near_plane_follows_the_nearest_point_that_is_seen) {
  for (const int exponent : {-40, -20, -10, -1, 0, 1, 10, 20}) {
    const float scale = std::ldexp(1.0f, exponent);
    Scene scene = box_on_ground();
    for (Mesh& mesh : scene.meshes)
      for (glm::vec3& p : mesh.positions) p *= scale;
    View scaled = view;
    scaled.eye *= scale, scaled.target *= scale;
    const GBuffer g = small_world::make_gbuffer(scene, scaled, 64, 48);
    const glm::dvec3 forward = glm::normalize(glm::dvec3(scaled.target) - glm::dvec3(scaled.eye));
    double nearest = INFINITY;
    for (std::size_t i = 0; i < g.size(); ++i)
      if (!g.is_background(i))
        nearest = std::min(nearest, glm::dot(forward, glm::dvec3(g.position(i)) - glm::dvec3(scaled.eye)));
    const double near_plane = gbuffer_textures(g, scene).near_plane;
    EXPECT_EQ(near_plane, std::exp2(std::floor(std::log2(nearest)) - 10)) << scale;
    EXPECT_EQ(clip_from_world(g, scene), clip_from_world(scaled, 64, 48, near_plane)) << scale;
  }
  // A view that shows nothing, 5 m up to its target.
  const Scene scene = box_on_ground();
  const GBuffer nothing = small_world::make_gbuffer(scene, {.eye = {0, 4, 0}, .target = {3, 8, 0}}, 16, 12);
  EXPECT_EQ(gbuffer_textures(nothing, scene).near_plane, 0x1p-8);
}

TEST_F(Gl, inputs_are_uploaded_once_and_found_again) {
  Scene scene = box_on_ground();
  const SceneBuffers* first = &scene_buffers(scene);
  EXPECT_EQ(first, &scene_buffers(scene));
  EXPECT_EQ(first->bytes, (4 + 8) * 12u + (2 + 12) * 12u);
  EXPECT_EQ(first->meshes[1].first_vertex, 4u);
  EXPECT_EQ(first->meshes[1].first_triangle, 2u);
  const GLuint name = first->positions.name();
  scene.meshes[1].positions[0].x += 1;  // the stamp reads the first vertex
  EXPECT_NE(scene_buffers(scene).positions.name(), name);
  release_inputs();
}

TEST_F(Gl, images_of_a_picture_stay_in_a_new_pose_and_depth_is_drawn_again) {
  Scene scene = box_on_ground();
  scene.motion = std::make_shared<const Motion>();
  const GBuffer g = small_world::make_gbuffer(scene, view, 64, 48);
  const GLuint image = gbuffer_textures(g, scene).position.name();
  const auto depth = [&] { return read<glm::vec2>(depth_stencil(scene, g).texture, GL_DEPTH_COMPONENT, GL_FLOAT); };
  const auto before = depth();
  for (glm::vec3& p : scene.meshes[1].positions) p.y += 20;  // behind the eye
  ++scene.pose_number;
  EXPECT_EQ(gbuffer_textures(g, scene).position.name(), image);
  const auto after = depth();
  Scene alone = scene;
  alone.meshes[1].triangles.clear();
  EXPECT_NE(before, after);
  EXPECT_EQ(after, read<glm::vec2>(depth_stencil(alone, g).texture, GL_DEPTH_COMPONENT, GL_FLOAT)) << "the ground";
  for (glm::vec3& p : scene.meshes[1].positions) p.y -= 20;
  ++scene.pose_number;
  EXPECT_EQ(depth(), before);
  release_inputs();
}

TEST_F(Gl, gbuffer_textures_hold_the_gbuffer) {
  Scene scene = box_on_ground();
  scene.meshes[1].receives = false;
  const GBuffer g = small_world::make_gbuffer(scene, view, 31, 17);
  const GBufferTextures& textures = gbuffer_textures(g, scene);
  const auto positions = read<glm::vec4>(textures.position, GL_RGBA, GL_FLOAT);
  const auto normals = read<glm::vec4>(textures.normal, GL_RGBA, GL_FLOAT);
  const auto ids = read<glm::uvec2>(textures.ids, GL_RG_INTEGER, GL_UNSIGNED_INT);
  for (std::size_t i = 0; i < g.size(); ++i) {
    const bool background = g.is_background(i);
    EXPECT_EQ(positions[i], glm::vec4(g.position(i), background ? 0 : 1));
    EXPECT_EQ(normals[i], glm::vec4(g.normal(i), !background && g.mesh[i] == 0 ? 1 : 0));
    EXPECT_EQ(ids[i], background ? glm::uvec2(0) : glm::uvec2(g.mesh[i] + 1, g.triangle[i]));
  }
  EXPECT_EQ(textures.bytes, g.size() * 40);
}

// Two G-buffers made one after the other may lie at one address: the look-up must tell them apart.
TEST_F(Gl, a_new_gbuffer_at_an_old_address_is_uploaded_again) {
  const Scene scene = box_on_ground();
  for (int turn = 0; turn < 8; ++turn) {
    View turned = view;
    turned.eye.x += static_cast<float>(turn) * 0.1f;
    const GBuffer g = small_world::make_gbuffer(scene, turned, 16, 16);
    const auto positions = read<glm::vec4>(gbuffer_textures(g, scene).position, GL_RGBA, GL_FLOAT);
    for (std::size_t i = 0; i < g.size(); ++i) ASSERT_EQ(glm::vec3(positions[i]), g.position(i));
  }
}

// On a surface at axis distance z the depth is near_plane / z; the background keeps 0. Pixels whose 3 x 3 neighborhood shows
// more than one triangle are left out: there the rasterizer's snapping may choose another surface than the ray.
TEST_F(Gl, depth_of_the_view_agrees_with_the_gbuffer) {
  const Scene scene = box_on_ground();
  const GBuffer g = small_world::make_gbuffer(scene, view, 64, 48);
  const auto texels = read<glm::vec2>(depth_stencil(scene, g).texture, GL_DEPTH_COMPONENT, GL_FLOAT);
  const float* depth = &texels[0].x;
  const glm::dvec3 forward = glm::normalize(glm::dvec3(view.target) - glm::dvec3(view.eye));
  int compared = 0;
  for (int y = 1; y + 1 < g.height; ++y)
    for (int x = 1; x + 1 < g.width; ++x) {
      const std::size_t i = std::size_t(y) * g.width + x;
      bool alone = true;
      for (int k = 0; k < 9; ++k) {
        const std::size_t j = i + (k / 3 - 1) * g.width + (k % 3 - 1);
        alone = alone && g.mesh[j] == g.mesh[i] && g.triangle[j] == g.triangle[i];
      }
      if (!alone) continue;
      ++compared;
      const double z = glm::dot(forward, glm::dvec3(g.position(i) - view.eye));
      const double expected = g.is_background(i) ? 0 : gbuffer_textures(g, scene).near_plane / z;
      EXPECT_NEAR(depth[i], expected, expected * 1e-4);
    }
  EXPECT_GT(compared, 1000);
}

// Side quads and both caps of a box, counted behind what is seen, are its shadow but for what the rasterizer snaps at borders.
TEST_F(Gl, faces_of_a_shadow_volume_hold_what_is_in_shadow) {
  const Scene scene = box_on_ground();
  const GBuffer g = small_world::make_gbuffer(scene, view, 128, 96);
  const EdgeAdjacency adjacency(scene);
  for (const Light& light :
       {Light{.name = "point", .kind = PointLight{{2, 3, 1}}}, {.name = "sun", .kind = DirectionalLight{{1, -2, 0}}}}) {
    std::vector<float> exact(g.size());
    ExactScene(scene).decide(g, light, exact);
    Silhouette silhouette;
    adjacency.find_silhouette(homogeneous(light), silhouette);
    VisibilityMask mask(g.width, g.height);
    {
      const StateGuard guard;
      VolumeCounter counter;
      counter.setup();
      FaceDrawer drawer;
      drawer.setup("test");
      FaceBuffers faces;
      write_faces(adjacency, silhouette, {}, faces);
      counter.begin(depth_stencil(scene, g), gbuffer_textures(g, scene), VolumeCounter::Pass::stencil,
                    CountWhere::behind_surface);
      drawer.bind(scene_buffers(scene).positions, faces, glm::mat4(clip_from_world(g, scene)), homogeneous(light));
      drawer.draw_sides(counter);
      drawer.draw_caps(counter);
      counter.write_mask(gbuffer_textures(g, scene), light, mask);
    }
    const auto counted = mask.read();
    int differ = 0;
    for (std::size_t i = 0; i < g.size(); ++i) differ += counted[i] != exact[i];
    EXPECT_GT(std::ranges::count(exact, 0.0f), 100);
    EXPECT_LT(differ, 10) << light.name;
  }
}

// The shader decides as the C++ function does, for each kind of light, but within 2^-21 of the horizon and of the cone's edge
// it may say no. The light in the plane of the ground is the hard case: there everything hangs on the last bits of the point.
TEST_F(Gl, faces_light_in_glsl_is_faces_light) {
  Scene scene = box_on_ground();
  scene.meshes.push_back(small_world::box({1.5f, 0, 1}, {2, 0.7f, 2}));
  scene.meshes[2].receives = false;
  const GBuffer g = small_world::make_gbuffer(scene, view, 64, 48);
  const Program program =
      pass_program("facing", faces_light_constants, std::string(gbuffer_snippet) + std::string(faces_light_snippet) + R"(
layout(location = 0) out float visibility;
void main() { visibility = faces_light(position_here(), normal_here()) ? 1 : 0; })");
  const Light lights[] = {{.name = "point", .kind = PointLight{{2, 3, 1}}},
                          {.name = "low", .kind = PointLight{{2, 0, 1}}},
                          {.name = "sun", .kind = DirectionalLight{{1, -2, 0}}},
                          {.name = "level", .kind = DirectionalLight{{1, 0, 0.3f}}},
                          {.name = "spot", .kind = SpotLight{{0, 4, 0}, {0.1f, -1, 0.2f}, 10, 25}}};
  for (const Light& light : lights) {
    VisibilityMask mask(g.width, g.height);
    {
      const StateGuard guard;
      const Framebuffer framebuffer = make_framebuffer();
      glNamedFramebufferTexture(framebuffer.name(), GL_COLOR_ATTACHMENT0, mask.texture(), 0);
      glBindFramebuffer(GL_FRAMEBUFFER, framebuffer.name());
      glViewport(0, 0, g.width, g.height);
      bind_gbuffer(gbuffer_textures(g, scene));
      set_light(program, light);
      glUseProgram(program.name());
      draw_full_screen();
    }
    const auto pixels = mask.read();
    int wrong = 0;
    for (std::size_t i = 0; i < g.size(); ++i) {
      const bool here = pixels[i] == 1, there = faces_light(scene, g, light, i);
      const glm::dvec3 to = to_light(homogeneous(light), g.position(i));
      const bool at_horizon = glm::dot(glm::dvec3(g.normal(i)), to) < 0x1p-20 * glm::length(to);
      wrong += here != there && (here || !at_horizon);
    }
    EXPECT_EQ(wrong, 0) << light.name;
  }
}

}  // namespace gl_test
