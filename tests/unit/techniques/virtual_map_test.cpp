#include <gnomon/kit/maps/light_map.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "device/context.h"
#include "map_scenes.h"
#include "measure/conformance/gl_state.h"
#include "small_world.h"
#include "techniques/virtual_map/pages.h"

extern "C" void gnomon_technique_virtual_map(gnomon::Registry&);

namespace virtual_map_test {
using namespace gnomon;
using map_scenes::all_kinds;
using map_scenes::near_shadow_edge;
using map_scenes::soup_over_ground;
using small_world::value;

class VirtualMap : public testing::Test {
 protected:
  VirtualMap() { process_context(); }
  void TearDown() override { EXPECT_EQ(state_differences(), std::vector<std::string>{}); }

  static small_world::Run run(const std::string& settings, const Scene& scene, const Light& light, const GBuffer& g) {
    return small_world::run(gnomon_technique_virtual_map, settings, scene, light, g);
  }
  static int wrong(const small_world::Run& run, const Scene& scene, const Light& light, const GBuffer& g) {
    int wrong = 0;
    for (std::size_t i = 0; i < g.size(); ++i)
      if (faces_light(scene, g, light, i))
        wrong += (small_world::caster_distance(scene, light, g.position(i)) < INFINITY) != (run.mask[i] == 0);
    return wrong;
  }
};

const View view{.eye = {3, 5, 6}, .target = {0, 0.3f, 0}};

/// Straight down on the middle of a ground from height 5: a pixel's side there is 5 * 2 tan(fov / 2) / height, in meters.
GBuffer from_above(const Scene& scene, int height) {
  return small_world::make_gbuffer(
      scene, {.eye = {0, 5, 0}, .target = {0, 0, 0}, .up = {0, 0, -1}, .fov_y_degrees = 2 * 26.565051f}, height, height);
}

// With tan(fov / 2) = 1/2 a pixel's side on the ground is 5 / height meters. Across the rays of a light with the angle a to the
// ground's normal it is as long one way and cos a as long the other. Levels halve, so a texel is as wide as the side over
// texels_per_pixel, or down to half of that, where the shorter side counts; where the mean does, times sqrt(cos a).
TEST_F(VirtualMap, a_plane_is_seen_at_the_coarsest_level_that_has_texels_enough) {
  Scene scene;
  scene.meshes = {small_world::ground(4), small_world::box({-0.5f, 0.5f, -0.5f}, {0.5f, 1, 0.5f})};
  for (const double tangent : {0.0, 0.5, 2.0})
    for (const int height : {40, 61})
      for (const double wanted : {1.0, 3.0, 16.0})
        for (const std::string measure : {"shorter", "mean"}) {
          const Light light{.kind = DirectionalLight{{float(tangent), -1, 0}}};
          const GBuffer g = from_above(scene, height);
          const auto map = run(fmt::format("texels_per_pixel={},measure={}", wanted, measure), scene, light, g);
          const double cosine = 1 / std::sqrt(1 + tangent * tangent);
          const double side = 5.0 / height * (measure == "mean" ? std::sqrt(cosine) : cosine);
          int seen = 0;
          for (std::size_t i = 0; i < g.size(); ++i) {
            if (g.is_background(i) || g.mesh[i] != 0) continue;
            const Explanation why = *map.technique->explain(i);
            if (why.taps.empty()) continue;  // beside what casts
            ++seen;
            EXPECT_LE(why.texel_width, side / wanted * 1.001);
            EXPECT_GE(why.texel_width, side / wanted / 2 * 0.999);
          }
          EXPECT_GT(seen, 100);
        }
}

// Every tap is a texel that holds the pixel's point, and stores what one image of its whole level stores there. A texel whose
// center lies on an edge within rounding (2^-5 texel of a level 0, here levels of 2^7 and more) may go either way.
TEST_F(VirtualMap, pages_are_parts_of_one_big_map) {
  constexpr int most_side = 4096;
  const Scene scene = soup_over_ground(3);
  const GBuffer g = small_world::make_gbuffer(scene, view, 96, 72);
  DepthImages images;
  images.setup();
  images.build(scene);
  for (const Light& light : all_kinds)
    for (const char* settings : {"", "page_size=64", "page_size=256,measure=mean"}) {
      const auto map = run(settings, scene, light, g);
      const LightCamera finest = virtual_map::finest_camera(light, images.boxes());
      int compared = 0, different = 0;
      for (int level = 0; virtual_map::finest_side >> level >= 64; ++level) {
        LightCamera camera = finest;
        camera.resolution = virtual_map::finest_side >> level;
        if (camera.resolution > most_side) continue;
        for (LightImage& image : camera.images) image = virtual_map::at_level(image, level);
        std::vector<float> depths;
        for (std::size_t i = 0; i < g.size(); ++i) {
          const Explanation why = *map.technique->explain(i);
          if (why.taps.empty()) continue;
          const glm::dvec3 point = g.position(i);
          const LightImage& image = camera.images[camera.space.face_of(point)];
          if (std::abs(why.texel_width / image.largest_texel(image.seen(point)) - 1) > 1e-6) continue;
          if (depths.empty()) {
            const StateGuard guard;
            Texture texture;
            images.draw(camera, texture);
            depths = read_texels<float>(texture, GL_DEPTH_COMPONENT);
          }
          const Tap& tap = why.taps[0];
          const glm::dvec2 center = image.place_of(tap.origin + tap.direction) * image.scale + image.offset;
          const glm::dvec2 place = image.place_of(point) * image.scale + image.offset;
          EXPECT_LE(glm::distance(center, place), std::sqrt(0.5) + 0.05);
          const double stored = camera.tap(image, depths, glm::ivec2(glm::floor(center)), 1).stored;
          ++compared;
          different += std::abs(stored - tap.stored) > 1e-4 && stored != tap.stored;
        }
      }
      EXPECT_GT(compared, 1000) << light.name << " " << settings;
      EXPECT_LE(different, compared / 200) << light.name << " " << settings;
    }
}

// The mask follows from the taps: dark where the stored surface lies before the point where its ray cuts the tangent plane, by
// more than the bias. Where the two sides agree to rounding nothing is required.
TEST_F(VirtualMap, explain_reproduces_the_mask_from_its_taps) {
  const Scene scene = soup_over_ground(7);
  const GBuffer g = small_world::make_gbuffer(scene, view, 96, 72);
  for (const Light& light : all_kinds)
    for (const char* settings : {"", "pages=20,depth_bias=0"}) {
      const auto map = run(settings, scene, light, g);
      int compared = 0, different = 0;
      for (std::size_t i = 0; i < g.size(); ++i) {
        if (!faces_light(scene, g, light, i)) continue;
        const Explanation why = *map.technique->explain(i);
        EXPECT_TRUE(why.covered);
        bool is_dark = false, is_decided = true;
        for (const Tap& tap : why.taps) {
          const glm::dvec3 normal = g.normal(i), point = g.position(i);
          const double facing = -glm::dot(normal, tap.direction);
          const double expected = facing > 0 ? glm::dot(normal, tap.origin - point) / facing : INFINITY;
          is_decided = std::abs(tap.stored - (expected - why.bias)) > 0.02 * why.bias + 1e-5;
          is_dark = tap.stored < expected - why.bias;
        }
        compared += is_decided;
        different += is_decided && is_dark != (map.mask[i] == 0);
      }
      EXPECT_GT(compared, 1000) << light.name;
      EXPECT_EQ(different, 0) << light.name << " " << settings;
    }
}

// Against brute-force rays: a pixel may be wrong only within 1.5 texel diagonals of a shadow edge, or where a caster is nearer
// than the bias. A page or a triangle of a page that were missing would show here.
TEST_F(VirtualMap, loses_no_shadow) {
  for (unsigned seed = 1; seed <= 4; ++seed) {
    const Scene scene = soup_over_ground(seed);
    const GBuffer g = small_world::make_gbuffer(scene, view, 96, 72);
    for (const Light& light : all_kinds) {
      const auto map = run(seed % 2 ? "" : "texels_per_pixel=4,page_size=64", scene, light, g);
      int dark = 0, unexplained = 0;
      for (std::size_t i = 0; i < g.size(); ++i) {
        if (!faces_light(scene, g, light, i)) {
          EXPECT_EQ(map.mask[i], 1);
          continue;
        }
        const double distance = small_world::caster_distance(scene, light, g.position(i));
        dark += distance < INFINITY;
        if ((distance < INFINITY) == (map.mask[i] == 0)) continue;
        const Explanation why = *map.technique->explain(i);
        const double reach = 1.5 * std::sqrt(2.0) * why.texel_width;
        unexplained += !near_shadow_edge(scene, light, g.position(i), g.normal(i), reach, distance < INFINITY) &&
                       distance > why.bias + 2 * std::sqrt(2.0) * why.texel_width;
      }
      EXPECT_GT(dark, 10) << light.name;
      EXPECT_EQ(unexplained, 0) << light.name << " seed " << seed;
    }
  }
}

// Errors are as wide as a texel, so four times the texels leave about a quarter of them; summed over scenes and lights.
TEST_F(VirtualMap, wrong_pixels_get_fewer_as_texels_per_pixel_grows) {
  int sums[3] = {};
  for (unsigned seed = 1; seed <= 3; ++seed) {
    const Scene scene = soup_over_ground(seed);
    const GBuffer g = small_world::make_gbuffer(scene, view, 128, 96);
    for (const Light& light : all_kinds)
      for (int k = 0; k < 3; ++k)
        sums[k] += wrong(run(fmt::format("texels_per_pixel={}", 1 << 2 * k), scene, light, g), scene, light, g);
  }
  EXPECT_GT(sums[0], 200);
  EXPECT_LT(sums[1], 0.5 * sums[0]);
  EXPECT_LT(sums[2], 0.5 * sums[1]);
}

// Without room for what is needed, every texel is 2^levels_raised times as wide, or its level is one page; and the counts
// say so.
TEST_F(VirtualMap, more_pages_than_there_is_room_for_raise_all_levels) {
  const Scene scene = soup_over_ground(2);
  const GBuffer g = small_world::make_gbuffer(scene, view, 96, 72);
  int tight_wrong = 0, roomy_wrong = 0;
  for (const Light& light : all_kinds) {
    const auto roomy = run("texels_per_pixel=8", scene, light, g);
    const Counts counts = roomy.technique->counts();
    EXPECT_EQ(value(counts, "levels_raised"), 0);
    EXPECT_EQ(value(counts, "pages"), value(counts, "pages_asked_for"));
    for (const int room : {6, 30}) {
      const auto tight = run(fmt::format("texels_per_pixel=8,pages={}", room), scene, light, g);
      const Counts less = tight.technique->counts();
      EXPECT_EQ(value(less, "pages_asked_for"), value(counts, "pages"));
      EXPECT_LE(value(less, "pages"), room);
      EXPECT_LT(value(less, "bytes"), value(counts, "bytes"));
      ASSERT_GT(value(less, "levels_raised"), 0);
      const double times = std::exp2(value(less, "levels_raised"));
      for (std::size_t i = 0; i < g.size(); ++i) {
        const Explanation fine = *roomy.technique->explain(i), coarse = *tight.technique->explain(i);
        ASSERT_EQ(fine.taps.size(), coarse.taps.size());
        if (!fine.taps.empty()) {
          EXPECT_LE(coarse.texel_width, fine.texel_width * times * 1.000001);
        }
      }
      tight_wrong += wrong(tight, scene, light, g);
      roomy_wrong += wrong(roomy, scene, light, g);
    }
  }
  EXPECT_GT(tight_wrong, 4 * roomy_wrong);
}

TEST_F(VirtualMap, nothing_that_casts_asks_for_no_page_and_is_lit) {
  Scene scene;
  scene.meshes = {small_world::ground(3, 0, false)};
  const GBuffer g = small_world::make_gbuffer(scene, view, 32, 24);
  for (const Light& light : all_kinds) {
    const auto map = run("", scene, light, g);
    EXPECT_EQ(value(map.technique->counts(), "pages_asked_for"), 0);
    for (const float visibility : map.mask) EXPECT_EQ(visibility, 1);
    for (const DebugLayer& layer : map.technique->debug_layers())
      EXPECT_EQ(map.technique->draw_debug(layer.name).size(), 3 * g.size());
  }
}

// The legend names a level by the texels along its side; a texel of it is 2^level times as wide as one of level 0. Colors are
// darkened, not changed.
TEST_F(VirtualMap, the_layer_of_pages_shows_the_level_that_was_looked_up) {
  const Scene scene = soup_over_ground(4);
  const GBuffer g = small_world::make_gbuffer(scene, view, 96, 72);
  const MeshBoxes boxes = mesh_boxes(scene);
  for (const Light& light : all_kinds) {
    const auto map = run("pages=60", scene, light, g);
    const LightCamera finest = virtual_map::finest_camera(light, boxes);
    const std::vector<float> picture = map.technique->draw_debug("pages");
    const std::vector<DebugLayer> layers = map.technique->debug_layers();
    const std::vector<Swatch>& legend = std::ranges::find(layers, "pages", &DebugLayer::name)->legend;
    int seen = 0;
    for (std::size_t i = 0; i < g.size(); ++i) {
      const Explanation why = *map.technique->explain(i);
      if (why.taps.empty()) continue;
      const LightImage& image = finest.images[finest.image_of(g.position(i))];
      const double times = why.texel_width / image.largest_texel(image.seen(g.position(i)));
      const std::string name = fmt::format("{}", std::lround(virtual_map::finest_side / times));
      const auto swatch = std::ranges::find(legend, name, &Swatch::name);
      ASSERT_NE(swatch, legend.end()) << name;
      const glm::dvec3 color(picture[3 * i], picture[3 * i + 1], picture[3 * i + 2]);
      EXPECT_LT(glm::distance(glm::normalize(color), glm::normalize(swatch->color)), 1e-5);
      ++seen;
    }
    EXPECT_GT(seen, 1000);
  }
}

TEST_F(VirtualMap, light_with_area_is_unsupported_with_a_reason) {
  Registry registry;
  gnomon_technique_virtual_map(registry);
  const Support support = registry.techniques()[0].make()->supports({}, {.kind = SphereLight{}}, {});
  EXPECT_EQ(support.kind(), Support::Kind::unsupported);
  EXPECT_FALSE(support.why().empty());
}

}  // namespace virtual_map_test
