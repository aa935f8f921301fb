#include <gnomon/kit/geometry/shapes.h>
#include <gnomon/kit/maps/light_map.h>
#include <gtest/gtest.h>

#include "device/context.h"
#include "measure/conformance/gl_state.h"
#include "small_world.h"

namespace light_map_test {
using namespace gnomon;

class LightMap : public testing::Test {
 protected:
  LightMap() { process_context(); }
  void TearDown() override { EXPECT_EQ(state_differences(), std::vector<std::string>{}); }
};

const std::vector<Light> lights = {{.name = "point", .kind = PointLight{{1, 3, 0.5f}}},
                                   {.name = "inside", .kind = PointLight{{0.1f, 0.6f, 0.2f}}},
                                   {.name = "sun", .kind = DirectionalLight{{0.4f, -1, 0.2f}}},
                                   {.name = "up", .kind = DirectionalLight{{0.1f, 1, -0.3f}}},
                                   {.name = "spot", .kind = SpotLight{{1, 4, 1}, {-0.2f, -1, -0.2f}, 20, 35}}};

/// Closed casters all around, one mesh of two boxes, one box inside out, and open ones; the light "inside" is in the room.
Scene casters() {
  Scene scene;
  Mesh turned = small_world::box({-2.5f, 0.2f, -2.5f}, {-1.5f, 1, -1.2f});
  for (glm::uvec3& t : turned.triangles) std::swap(t.y, t.z);
  finish(turned);
  const Mesh pair[] = {small_world::box({1.2f, 0, 1.2f}, {2, 1, 2}), small_world::box({1.4f, 1.2f, -2}, {2, 2, -1})};
  scene.meshes = {small_world::ground(4),
                  tessellate(Sphere{{0, 1.2f, -1.6f}, 0.5f}, 24, "ball"),
                  turned,
                  merge(pair, "pair"),
                  small_world::box({-0.5f, 0.3f, -0.5f}, {0.6f, 0.9f, 0.7f}),
                  tessellate(Disc{{-1, 1.5f, 1.5f}, {0.3f, 1, 0}, 0.6f}, 16, "disc")};
  return scene;
}

/// The depth images of a camera, texel after texel.
std::vector<float> depths_of(DepthImages& images, const LightCamera& camera, DepthImages::Faces faces) {
  const StateGuard guard;
  Texture texture;
  images.draw(camera, texture, faces);
  return read_texels<float>(texture, GL_DEPTH_COMPONENT);
}

// Light from outside meets a solid first where its surface is turned to the light, so texels are equal to the bit, but a few at
// the outline: there a triangle of each side ends, both moved by up to 1/256 texel when their corners are snapped, and the far
// one is nearer by its slope times that.
TEST_F(LightMap, what_is_turned_away_from_the_light_need_not_be_drawn) {
  const Scene scene = casters();
  DepthImages images;
  images.setup();
  images.build(scene);
  for (const Light& light : lights) {
    const LightCamera camera = fit_to_scene(light, images.boxes(), 256, 2);
    const auto all = depths_of(images, camera, DepthImages::Faces::all),
               lit = depths_of(images, camera, DepthImages::Faces::lit);
    ASSERT_EQ(all.size(), lit.size());
    std::size_t stored = 0, different = 0;
    for (std::size_t i = 0; i < all.size(); ++i) {
      stored += all[i] > 0;
      ASSERT_EQ(all[i] > 0, lit[i] > 0) << light.name << ' ' << i;
      ASSERT_NEAR(all[i], lit[i], 0x1p-12 * all[i]) << light.name << ' ' << i;
      different += all[i] != lit[i];
    }
    EXPECT_LT(different, stored / 5000) << light.name;
    EXPECT_GT(stored, 10000u) << light.name;
  }
}

// What a shader looks up is what the camera says in double, up to float32: the axis distance to sixteen roundings of the
// scene's extent, the texel coordinates to 1/8 texel, since a texel is at least 2^-20 of them and rounding takes up to 2^-24 a
// few times.
TEST_F(LightMap, shaders_look_points_up_where_the_camera_says) {
  const Scene scene = casters();
  const GBuffer g = small_world::make_gbuffer(scene, {.eye = {3, 4, 5}, .target = {0, 0.5f, 0}}, 64, 48);
  const MeshBoxes boxes = mesh_boxes(scene);
  for (const Light& light : lights)
    for (const bool to_view : {false, true}) {
      const LightCamera camera = to_view ? fit_to_view(light, boxes, g, 512, 2) : fit_to_scene(light, boxes, 512, 2);
      const LightProjection projection = projection_of(camera);
      const Program program =
          pass_program("look up", light_map_constants(projection),
                       light_map_head(projection) + std::string(gbuffer_snippet) + std::string(light_map_snippet) + R"(
layout(location = 0) out vec4 found;
void main() {
  vec3 v = position_here().xyz - light_origin;
  choose_image(v);
  vec3 place = in_image(v);
#if PROJECTION != 0
  place.xy /= place.z;
#endif
  found = vec4(place, light_facts.x);
})");
      const Texture found(GL_RGBA32F, g.width, g.height);
      {
        const StateGuard guard;
        const Framebuffer framebuffer = make_framebuffer();
        glNamedFramebufferTexture(framebuffer.name(), GL_COLOR_ATTACHMENT0, found.name(), 0);
        glBindFramebuffer(GL_FRAMEBUFFER, framebuffer.name());
        glViewport(0, 0, g.width, g.height);
        bind_gbuffer(gbuffer_textures(g, scene));
        set_light_camera(program, light, camera);
        glUseProgram(program.name());
        draw_full_screen();
      }
      const auto pixels = read_texels<glm::vec4>(found, GL_RGBA);
      int compared = 0;
      for (std::size_t i = 0; i < g.size(); ++i) {
        if (!faces_light(scene, g, light, i)) continue;
        const auto [face, q] = camera.space.seen(g.position(i));
        const LightImage& image = camera.images[face];
        if (image.layer < 0) continue;
        ++compared;
        const glm::dvec2 place = image.place(q) * image.scale + image.offset;
        EXPECT_NEAR(pixels[i].x, place.x, 0.125) << light.name;
        EXPECT_NEAR(pixels[i].y, place.y, 0.125) << light.name;
        EXPECT_NEAR(pixels[i].z, q.z, camera.rounding) << light.name;
        EXPECT_EQ(pixels[i].w, image.layer) << light.name;
      }
      EXPECT_GT(compared, 200) << light.name;
    }
}

}  // namespace light_map_test
