// Shadow rays against a brute force in double without Embree, and against themselves.
#include <gnomon/kit/geometry/shapes.h>
#include <gnomon/kit/random.h>
#include <gnomon/kit/rays/rays.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <bit>
#include <cmath>
#include <random>

#include "hand_made.h"
#include "small_world.h"

namespace rays_test {

using namespace gnomon;

/// A soup over a ground with part of it receiving only, its G-buffer and lights of every hard kind.
struct World {
  Scene scene;
  GBuffer gbuffer;
  std::vector<Light> lights;
  World(unsigned seed, int width, int height) {
    std::mt19937 random(seed);
    scene.meshes = {small_world::ground(5), small_world::random_soup(random, 40, 3, 0.3f, 2.5f, 0.9f),
                    small_world::box({-4, 0, -1}, {-3, 1.5f, 1})};
    scene.meshes[2].receives = seed % 2;
    scene.meshes[0].casts = false;
    scene.views = {View{.eye = {1, 5, 8}, .target = {0, 0.5f, 0}}};
    gbuffer = small_world::make_gbuffer(scene, scene.views[0], width, height);
    std::uniform_real_distribution<float> along(-1, 1);
    // One number after the other: the arguments of a call are drawn in another order by each compiler.
    const float z = 4 * along(random), x = 4 * along(random), dz = along(random), dx = along(random);
    const glm::vec3 position(x, 6, z), direction(dx, -1.5f, dz);
    lights = {{.name = "point", .kind = PointLight{position}},
              {.name = "sun", .kind = DirectionalLight{direction}},
              {.name = "spot", .kind = SpotLight{position, -position, 10, 22}}};
  }
};

TEST(met, names_all_triangles_on_the_way_and_no_exact_shape) {
  // Straight up through a level square, a ball that stands for its tessellation, and another square: whatever is traced first.
  Scene scene;
  scene.meshes = {hand_made::square(2, -3), tessellate(Sphere{{0, 0, 0}, 1}, 24, "ball"), hand_made::square(2, 3)};
  for (const Truth truth : {Truth::shape, Truth::mesh}) {
    const RayScene rays(scene, truth, RayScene::Which::seen);
    int met[3] = {};
    for (const RayScene::Met& triangle : rays.met({0.3, -9, 0.1}, {0, 18, 0})) ++met[triangle.mesh];
    EXPECT_EQ(met[0], 1);
    EXPECT_EQ(met[1], truth == Truth::shape ? 0 : 2);
    EXPECT_EQ(met[2], 1);
    EXPECT_TRUE(rays.met({0.3, -2, 0.1}, {0, 0.5, 0}).empty());
  }
}

TEST(fill_packet, every_lane_follows_the_recipe_and_faces_the_light) {
  for (unsigned seed = 1; seed <= 6; ++seed) {
    const World world(seed, 45, 31);  // 1395 pixels: the last packet has three
    const GBuffer& g = world.gbuffer;
    for (const Light& light : world.lights) {
      const glm::dvec4 l = homogeneous(light);
      for (std::size_t first = 0; first < g.size(); first += 16) {
        alignas(64) ShadowPacket packet;
        const std::uint32_t valid = fill_packet(world.scene, g, light, first, packet);
        for (std::size_t k = 0; k < 16; ++k) {
          const std::size_t i = first + k;
          ASSERT_EQ(valid >> k & 1, i < g.size() && faces_light(world.scene, g, light, i)) << light.name << ' ' << i;
          if (!(valid >> k & 1)) continue;
          // Origin P + 8 * 2^-24 max|P| N; direction to the light, not normalized, so that the light is at t = 1. Each is
          // rounded to float32 a few times: 2^-22 of the largest number is room enough, the offset itself is twice that.
          const glm::dvec3 p = g.position(i), n = g.normal(i);
          const glm::dvec3 origin(packet.ox[k], packet.oy[k], packet.oz[k]);
          const glm::dvec3 direction(packet.dx[k], packet.dy[k], packet.dz[k]);
          const double largest = std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)});
          EXPECT_EQ(ray_offset(g.position(i)), 8 * 0x1p-24 * largest);
          EXPECT_NEAR(glm::distance(origin, p + 8 * 0x1p-24 * largest * n), 0, 0x1p-22 * largest);
          EXPECT_GT(glm::dot(origin - p, n), 0) << "lifted toward the eye";
          EXPECT_NEAR(glm::distance(direction, to_light(l, origin)), 0, 0x1p-22 * 8);
          EXPECT_EQ(packet.tnear[k], 0);
          EXPECT_EQ(packet.tfar[k], l.w != 0 ? 1 : INFINITY);
          EXPECT_EQ(packet.mask[k], 0xffffffffu);
          EXPECT_EQ(packet.id[k], k);
          EXPECT_EQ(packet.flags[k], 0u);
          EXPECT_EQ(packet.time[k], 0);
        }
      }
    }
  }
}

TEST(fill_packet, decides_facing_in_double) {
  // Normals and directions of 24-bit numbers whose products cancel to some 1e-8: float32 products could not tell the sign.
  // Every fourth product is 0 to the last bit, (a, b, 0).(b, -a, 0), and does not face.
  Random random(11);
  Scene scene;
  scene.meshes = {hand_made::square(1, 0)};
  int facing = 0;
  for (int round = 0; round < 200; ++round) {
    const float a = float(random.uniform(0.1, 1)), b = float(random.uniform(0.1, 1));
    const Light sun = hand_made::sun({-b, a, 0});
    hand_made::Picture picture(16, 1);
    for (int i = 0; i < 16; ++i) {
      const float scale = i % 4 ? float(random.uniform(0.1, 1)) : 1;
      picture.set(i, {0, 0, 0}, {a * scale, b * scale, 0}, 0, 0);
    }
    alignas(64) ShadowPacket packet;
    const std::uint32_t valid = fill_packet(scene, picture.gbuffer, sun, 0, packet);
    for (std::size_t i = 0; i < 16; ++i) {
      ASSERT_EQ(valid >> i & 1, faces_light(scene, picture.gbuffer, sun, i));
      if (i % 4 == 0) {
        ASSERT_EQ(valid >> i & 1, 0u);
      }
    }
    facing += std::popcount(valid);
  }
  EXPECT_GT(facing, 200 * 3);
  EXPECT_LT(facing, 200 * 9);
}

TEST(occluded, a_rays_own_receiver_is_no_hit_and_lanes_that_are_off_answer_0) {
  // Sixteen rays up from below the unit square, all through its triangle 0 or 1, which alone can block them.
  Scene scene;
  scene.meshes = {hand_made::square(1, 0), hand_made::square(1, 5)};
  scene.meshes[1].casts = false;
  const RayScene casters(scene, Truth::mesh, RayScene::Which::casters);
  const auto ask = [&](std::uint32_t valid, std::uint32_t own_mesh, std::uint32_t own_triangle) {
    alignas(64) ShadowPacket packet{};
    std::array<std::uint32_t, 16> mesh, triangle;
    for (std::uint32_t k = 0; k < 16; ++k) {
      // Triangle 0 holds the corners (-1,-1) (-1,1) (1,1) in x and z, triangle 1 the rest: x < z and x > z.
      const float x = k % 2 ? 0.5f : -0.5f;
      packet.ox[k] = x;
      packet.oy[k] = -1;
      packet.oz[k] = -x;
      packet.dy[k] = 1;
      packet.tfar[k] = INFINITY;
      packet.mask[k] = 0xffffffffu;
      packet.id[k] = k;
      mesh[k] = own_mesh;
      triangle[k] = own_triangle;
    }
    return casters.occluded(valid, packet, {mesh.data(), triangle.data()});
  };
  EXPECT_EQ(ask(0xffff, 1, 0), 0xffffu) << "the upper square casts nothing; the lower blocks all";
  EXPECT_EQ(ask(0xffff, 0, 0), 0xaaaau) << "even rays go through their own triangle 0";
  EXPECT_EQ(ask(0xffff, 0, 1), 0x5555u) << "odd rays through triangle 1";
  EXPECT_EQ(ask(0x00f0, 1, 0), 0x00f0u);
  EXPECT_EQ(ask(0, 1, 0), 0u);
}

// A packet that few rays fill is made on the stack: the other lanes hold what was there before, no numbers or rays that never
// end, and names of receivers far beyond those that there are. Whatever number of rays the processor traces at once, none of
// it is traced.
TEST(occluded, lanes_that_are_off_may_hold_anything) {
  Scene scene;
  scene.meshes = {hand_made::square(1, 0)};
  const RayScene casters(scene, Truth::mesh, RayScene::Which::casters);
  std::array<std::uint32_t, 16> mesh, triangle;
  mesh.fill(no_mesh);
  triangle.fill(0);
  for (const float rest : {NAN, INFINITY, 1e30f, 0.0f, 0.25f})
    for (const std::uint32_t valid : {0u, 1u, 0x8000u, 0x1248u, 0x00ffu, 0xfffeu}) {
      alignas(64) ShadowPacket packet{};
      for (auto* lanes : {&packet.ox, &packet.oy, &packet.oz, &packet.dx, &packet.dy, &packet.dz, &packet.tnear, &packet.tfar})
        lanes->fill(rest);
      packet.mask.fill(0xffffffffu);
      packet.id.fill(0x7fffffffu);
      for (std::uint32_t k = 0; k < 16; ++k) {
        if (!(valid >> k & 1)) continue;
        packet.ox[k] = k % 2 ? 0.5f : 2.0f;  // below the square, or beside it
        packet.oy[k] = -1;
        packet.oz[k] = 0.25f;
        packet.dx[k] = packet.dz[k] = packet.tnear[k] = 0;
        packet.dy[k] = 1;
        packet.tfar[k] = INFINITY;
        packet.id[k] = k;
      }
      EXPECT_EQ(casters.occluded(valid, packet, {mesh.data(), triangle.data()}), valid & 0xaaaau) << rest << ", " << valid;
    }
}

TEST(closest, is_the_same_triangle_whatever_the_unit_of_length) {
  // Powers of two round nothing, so that the scene is the same one in another unit. Rays start at its middle.
  std::mt19937 engine(3);
  Scene scene;
  scene.meshes = {small_world::random_soup(engine, 200, 1, -1, 1, 0.5f)};
  const RayScene in_meters(scene, Truth::mesh, RayScene::Which::seen);
  for (const int power : {-60, -40, -12, 35, 50}) {
    Scene other = scene;
    for (glm::vec3& p : other.meshes[0].positions) p = std::ldexp(1.0f, power) * p;
    const RayScene rays(other, Truth::mesh, RayScene::Which::seen);
    Random random(4);
    int met = 0;
    for (int k = 0; k < 500; ++k) {
      const glm::dvec3 direction = small_world::direction_of(random);
      const RayScene::Hit one = in_meters.closest({0, 0, 0}, direction), two = rays.closest({0, 0, 0}, direction);
      ASSERT_EQ(one.mesh, two.mesh) << power;
      if (one.mesh == no_mesh) continue;
      ++met;
      EXPECT_EQ(one.triangle, two.triangle) << power;
      EXPECT_NEAR(two.t, std::ldexp(one.t, power), 1e-5 * two.t);
    }
    EXPECT_GT(met, 250);
  }
}

TEST(trace_shadows, equals_one_ray_at_a_time_in_double_away_from_edges) {
  // The brute force tests five times, at the point and at four points 1e-4 m around it in the receiver's plane. Where they
  // agree no edge is near and the answers must be equal; 2 mm of edge in 10 m leaves nearly all pixels.
  std::size_t compared = 0, facing = 0;
  for (unsigned seed = 1; seed <= 8; ++seed) {
    const World world(seed, 37, 29);  // 1073 = 67 * 16 + 1: a tail of one
    const RayScene casters(world.scene, Truth::mesh, RayScene::Which::casters);
    for (const Light& light : world.lights) {
      std::vector<float> mask(world.gbuffer.size(), -1);
      const std::size_t rays = trace_shadows(casters, world.scene, world.gbuffer, light, mask);
      std::size_t light_facing = 0;
      for (std::size_t i = 0; i < mask.size(); ++i) {
        if (!faces_light(world.scene, world.gbuffer, light, i)) {
          ASSERT_EQ(mask[i], 1) << "not facing is 1";
          continue;
        }
        ++light_facing;
        const glm::dvec3 p = world.gbuffer.position(i), n = world.gbuffer.normal(i);
        const glm::dvec3 u = glm::normalize(glm::cross(n, std::abs(n.x) < 0.7 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0)));
        int dark = 0;
        for (const glm::dvec3& shift : {glm::dvec3(0), u, -u, glm::cross(n, u), -glm::cross(n, u)})
          dark += std::isfinite(small_world::caster_distance(world.scene, light, p + 1e-4 * shift));
        if (dark % 5 != 0) continue;
        ++compared;
        ASSERT_EQ(mask[i], dark ? 0 : 1) << light.name << " seed " << seed << " pixel " << i;
      }
      EXPECT_EQ(rays, light_facing);
      facing += light_facing;
    }
  }
  EXPECT_GT(facing, 5000u);
  EXPECT_GT(compared, 0.97 * facing);
}

TEST(trace_shadows, length_of_a_direction_does_not_matter) {
  const World world(3, 40, 30);
  const RayScene casters(world.scene, Truth::mesh, RayScene::Which::casters);
  const glm::vec3 direction = std::get<DirectionalLight>(world.lights[1].kind).direction;
  std::vector<float> unit(world.gbuffer.size()), scaled(unit.size());
  trace_shadows(casters, world.scene, world.gbuffer, world.lights[1], unit);
  ASSERT_GT(std::ranges::count(unit, 0.0f), 50);
  // Powers of two scale without rounding: bit for bit the same.
  for (const float length : {0x1p-80f, 0x1p-31f, 0x1p-20f, 0.25f, 0x1p20f, 0x1p50f}) {
    trace_shadows(casters, world.scene, world.gbuffer, {.name = "sun", .kind = DirectionalLight{direction * length}}, scaled);
    EXPECT_EQ(scaled, unit) << length;
  }
}

TEST(trace_shadows, pixels_outside_the_spot_cone_are_1_and_inside_as_for_a_point_light) {
  const World world(2, 48, 32);
  const RayScene casters(world.scene, Truth::mesh, RayScene::Which::casters);
  const Light& spot = world.lights[2];
  std::vector<float> narrow(world.gbuffer.size()), everywhere(narrow.size());
  trace_shadows(casters, world.scene, world.gbuffer, spot, narrow);
  trace_shadows(casters, world.scene, world.gbuffer, world.lights[0], everywhere);
  std::size_t inside = 0, cut = 0;
  for (std::size_t i = 0; i < narrow.size(); ++i) {
    const bool in_cone = in_spot_cone(spot, world.gbuffer.position(i));
    ASSERT_EQ(narrow[i], in_cone ? everywhere[i] : 1) << i;
    inside += in_cone && everywhere[i] == 0;
    cut += !in_cone && everywhere[i] == 0;
  }
  EXPECT_GT(inside, 20u);
  EXPECT_GT(cut, 20u);
}

TEST(trace_shadows, thread_count_changes_nothing) {
  const World world(5, 203, 101);
  const RayScene casters(world.scene, Truth::mesh, RayScene::Which::casters);
  for (const Light& light : world.lights) {
    std::vector<std::vector<float>> masks;
    std::vector<std::size_t> rays;
    for (const std::size_t threads : {1, 2, 5}) {
      const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
      masks.emplace_back(world.gbuffer.size(), -1);
      rays.push_back(trace_shadows(casters, world.scene, world.gbuffer, light, masks.back()));
    }
    EXPECT_TRUE(masks[0] == masks[1] && masks[0] == masks[2]) << light.name;
    EXPECT_TRUE(rays[0] == rays[1] && rays[0] == rays[2]) << light.name;
  }
}

}  // namespace rays_test
