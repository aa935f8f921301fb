// Contact marches: where a ray is in the picture, what they darken and what not, and the mask with a partner.
#include <gnomon/kit/pictures/layers.h>

#include "contact_march_rig.h"
#include "measure/conformance/world.h"
#include "techniques/contact_march/picture.h"

namespace contact_march_test {
using namespace contact_march_rig;
using contact_march::End;
using contact_march::Way;
using contact_march::way_over;

Camera square_camera(int side) { return {View{.eye = {0, 0, 0}, .target = {0, 0, -1}, .fov_y_degrees = 90}, side, side}; }

// From z = 4 to 4 + 1 / sqrt 2 = 4.707107. Halfway across the picture 1 / z is the mean of both: 1 / 4.324841. Halfway along
// the ray z would be 4.353553. In a picture of 100 x 100 the ray goes from (50, 62.5) by 50 * 0.707107 / 4.707107 = 7.511
// pixels.
TEST(contact_march, one_over_z_is_linear_along_pixels) {
  const glm::dvec3 direction = glm::normalize(glm::dvec3(1, 0, -1));
  const Way way = way_over(square_camera(100), {0, -1, -4}, direction, 1, 64);
  EXPECT_EQ(way.count, 8);
  EXPECT_FALSE(way.leaves);
  EXPECT_NEAR(way.start.x, 50, 1e-9);
  EXPECT_NEAR(way.start.y, 62.5, 1e-9);
  EXPECT_NEAR(way.place(way.count).x, 57.511055, 1e-6);
  EXPECT_NEAR(way.z(0), 4, 1e-12);
  EXPECT_NEAR(way.z(way.count / 2.0), 4.324841, 1e-6);
  EXPECT_NEAR(way.z(way.count), 4 + std::sqrt(0.5), 1e-12);
  const Way few = way_over(square_camera(100), {0, -1, -4}, direction, 1, 4);
  EXPECT_EQ(few.count, 4);
  EXPECT_NEAR(few.step.x, 7.511055 / 4, 1e-6);
  EXPECT_NEAR(few.z(2), 4.324841, 1e-6);
}

// At z = 4 the picture ends at x = 4: of the ray from 3.9 a tenth is in it, 50 * (1 - 3.9 / 4) = 1.25 pixels. A ray toward the
// eye stays in its pixel, whether it ends before the eye or behind it.
TEST(contact_march, a_ray_is_followed_as_far_as_the_picture_shows_it) {
  const Way right = way_over(square_camera(100), {3.9, 0, -4}, {1, 0, 0}, 1, 64);
  EXPECT_TRUE(right.leaves);
  EXPECT_EQ(right.count, 2);
  EXPECT_NEAR(right.place(2).x, 100, 1e-9);
  EXPECT_NEAR(right.z(2), 4, 1e-12);
  for (const double length : {1.0, 8.0}) {
    const Way toward_eye = way_over(square_camera(100), {0, 0, -4}, {0, 0, 1}, length, 64);
    EXPECT_EQ(toward_eye.count, 0);
    EXPECT_EQ(toward_eye.leaves, length > 4);
  }
}

// A box of height 1 and a sun at 45 degrees from the left: the ray from the floor at 1 + d enters the box's right side, which
// the eye sees, after d sqrt 2. A march of 0.5 m finds it up to d = 0.354.
TEST(contact_march, a_box_on_a_plane_is_dark_at_its_foot) {
  Scene scene;
  scene.meshes = {small_world::ground(4), small_world::box({0, 0, -1}, {1, 1, 1})};
  scene.views = {{.name = "view", .eye = {4, 5, 0}, .target = {1, 0, 0}, .up = {0, 1, 0}}};
  const GBuffer g = small_world::make_gbuffer(scene, scene.views[0], 320, 240);
  const Answered march = alone(scene, hand_made::sun({1, -1, 0}), g, 0.5, 10);
  int dark = 0, beyond = 0, open = 0;
  for (std::size_t i = 0; i < g.size(); ++i) {
    if (g.mesh[i] != 0 || std::abs(g.pz[i]) > 0.8f) continue;
    if (g.px[i] > 1.02f && g.px[i] < 1.27f) {
      EXPECT_EQ(march.mask[i], 0) << g.px[i] << ' ' << g.pz[i];
      ++dark;
    } else if (g.px[i] > 1.4f && g.px[i] < 1.95f) {
      EXPECT_EQ(march.mask[i], 1) << g.px[i] << ' ' << g.pz[i];
      EXPECT_EQ(march.cause(i), "out_of_range");
      ++beyond;
    } else if (g.px[i] > 2.05f) {
      EXPECT_EQ(march.mask[i], 1) << "lit floor " << g.px[i] << ' ' << g.pz[i];
      ++open;
    }
  }
  EXPECT_GT(dark, 200);
  EXPECT_GT(beyond, 200);
  EXPECT_GT(open, 200);
}

// Both triangles of the floor, under light that grazes it: the ray rises above the other triangle's plane by less and less.
TEST(contact_march, a_plane_never_darkens_itself) {
  Scene scene;
  scene.meshes = {small_world::ground(4)};
  for (const glm::vec3& eye : {glm::vec3(0.5f, 0.2f, 6), glm::vec3(4, 5, 0.3f)}) {
    scene.views = {{.name = "view", .eye = eye, .target = {0.1f, 0, -0.2f}}};
    const GBuffer g = small_world::make_gbuffer(scene, scene.views[0], 160, 120);
    for (const float height : {1.0f, 1e-2f, 1e-5f})
      for (const glm::vec3& along : {glm::vec3(1, 0, 0.3f), glm::vec3(-0.2f, 0, 1), glm::vec3(-1, 0, -1)}) {
        const Answered march = alone(scene, hand_made::sun(along - glm::vec3(0, height, 0)), g, 3, 100);
        EXPECT_TRUE(std::ranges::all_of(march.mask, [](float v) { return v == 1; }))
            << eye.x << ' ' << height << ' ' << along.x;
      }
  }
}

// A card 1 m before the wall covers 0.3 .. 0.4 of the picture's half. The ray from x = 0.8 is there for a = 0.308 .. 0.571,
// which is 0.692 .. 0.429 m behind the card. It passes the card's depth at x = 1.8, beside it: the point is lit.
TEST(contact_march, a_thin_card_is_as_thick_as_the_parameter_says) {
  const Scene scene = before_a_wall({upright(0.9f, 1.2f, 1, -3)});
  const GBuffer g = picture_of(scene);
  const std::size_t i = pixel_at(g, 0, {0.8f, 0, -4});
  const Answered thin = alone(scene, from_the_right, g, 1, 0.35), thick = alone(scene, from_the_right, g, 1, 0.8);
  EXPECT_EQ(thin.mask[i], 1);
  EXPECT_EQ(thick.mask[i], 0);
  EXPECT_EQ(thick.cause(i), "thickness");
}

// The caster is out of the picture, where the ray from x = 3.8 has left it.
TEST(contact_march, a_ray_that_leaves_the_picture_is_lit) {
  const Scene scene = before_a_wall({upright(3.95f, 4.05f, 1, -3.8f)});
  const GBuffer g = picture_of(scene);
  const std::size_t i = pixel_at(g, 0, {3.8f, 0, -4});
  const Answered march = alone(scene, from_the_right, g, 1, 10);
  EXPECT_EQ(march.mask[i], 1);
  const std::vector<float> stops = march.technique->draw_debug("stops");
  const auto layers = march.technique->debug_layers();
  const Swatch& left = layers[1].legend[static_cast<std::size_t>(End::picture)];
  EXPECT_EQ(left.name, "picture");
  for (int c = 0; c < 3; ++c) EXPECT_EQ(stops[3 * i + static_cast<std::size_t>(c)], static_cast<float>(left.color[c]));
}

TEST(contact_march, layers_show_a_surface_where_it_is_dark_and_steps_everywhere) {
  const Scene scene = before_a_wall({upright(0.15f, 0.25f, 0.5f, -3.8f)});
  const GBuffer g = picture_of(scene);
  const Answered march = alone(scene, from_the_right, g, 1, 1);
  const std::vector<float> stops = march.technique->draw_debug("stops"), steps = march.technique->draw_debug("steps"),
                           gray = heat_layer(g, std::vector<float>(g.size(), 0));
  const glm::dvec3 surface = march.technique->debug_layers()[1].legend[0].color;
  int dark = 0;
  for (std::size_t i = 0; i < g.size(); ++i) {
    const bool is_surface = stops[3 * i] == static_cast<float>(surface.x) && stops[3 * i + 1] == static_cast<float>(surface.y);
    EXPECT_EQ(is_surface, march.mask[i] == 0) << i;
    dark += is_surface;
    if (g.mesh[i] == 0) {
      EXPECT_FALSE(std::equal(&steps[3 * i], &steps[3 * i] + 3, &gray[3 * i])) << i;
    }
  }
  EXPECT_GT(dark, 20);
  EXPECT_THROW(march.technique->draw_debug("map"), Error);
}

TEST_F(ContactMarch, with_a_partner_each_pixel_is_the_darker_of_the_two) {
  const conformance::World world(conformance::generated_scene("contact"), Truth::mesh);
  const GBuffer g = world.gbuffer(world.scene.views[0], 160, 90);
  for (const Light& light : {world.scene.lights[0], world.scene.lights[1]}) {
    const std::vector<float> march =
        answered("contact_march", "length=0.05,thickness=1,partner=unshadowed", world.scene, light, g).mask;
    EXPECT_GT(std::ranges::count(march, 0.0f), 20);
    for (const auto& [partner, settings] : {std::pair<std::string, std::string>{"shadow_map", "resolution=128,filter=pcf"},
                                            {"embree_rays", ""},
                                            {"svbsp", "order=bsp"}}) {
      const std::vector<float> other = answered(partner, settings, world.scene, light, g).mask;
      std::string text = "length=0.05,thickness=1,partner=" + partner;
      for (std::size_t at = 0; !settings.empty() && at < settings.size();) {
        const std::size_t comma = std::min(settings.find(',', at), settings.size());
        text += ",partner." + settings.substr(at, comma - at);
        at = comma + 1;
      }
      const std::vector<float> both = answered("contact_march", text, world.scene, light, g).mask;
      for (std::size_t i = 0; i < g.size(); ++i) ASSERT_EQ(both[i], std::min(march[i], other[i])) << text << ' ' << i;
    }
  }
}

TEST_F(ContactMarch, bytes_are_those_of_the_partner_and_of_the_picture) {
  const conformance::World world(conformance::generated_scene("sphere_over_plane:segments=12"), Truth::mesh);
  const Light& light = world.scene.lights[0];
  const GBuffer small = world.gbuffer(world.scene.views[0], 48, 32), large = world.gbuffer(world.scene.views[0], 96, 64);
  const auto bytes = [&](const std::string& partner, const GBuffer& g) {
    return small_world::value(answered("contact_march", "partner=" + partner, world.scene, light, g).technique->counts(),
                              "bytes");
  };
  const auto of_partner = [&](const std::string& partner) {
    return small_world::value(answered(partner, "", world.scene, light, small).technique->counts(), "bytes");
  };
  EXPECT_EQ(bytes("svbsp", small) - bytes("unshadowed", small), of_partner("svbsp"));
  EXPECT_GE(bytes("shadow_map", small) - bytes("unshadowed", small), of_partner("shadow_map"));
  EXPECT_GE(bytes("unshadowed", large), 3.9 * bytes("unshadowed", small) - 1024);
}

}  // namespace contact_march_test
