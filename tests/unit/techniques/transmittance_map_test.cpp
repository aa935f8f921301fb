// The transmittance map: exact on the ray of a texel where all nodes are kept, and what the others lose.
#include <gnomon/kit/gl/gl.h>
#include <gnomon/kit/pictures/layers.h>

#include <cmath>

#include "error_words.h"
#include "glass_stack.h"
#include "less_of_the_device.h"

namespace transmittance_map_test {
using namespace glass_maps_rig;
using namespace glass_stack;
using small_world::value;

constexpr const char* id = "transmittance_map";

class TransmittanceMap : public TestRig {
 protected:
  static double mean_error(const std::string& settings, const Scene& scene, const Light& light, const GBuffer& gbuffer) {
    const std::vector<float> truth = decided(scene, light, gbuffer), mask = run(id, settings, scene, light, gbuffer).mask;
    double sum = 0;
    int count = 0;
    for (std::size_t i = 0; i < mask.size(); ++i) {
      if (!faces_light(scene, gbuffer, light, i)) continue;
      sum += std::abs(mask[i] - truth[i]);
      ++count;
    }
    return sum / count;
  }
};

// Every ray sees the same cards, in every texel of every filter. Products are in double, and are rounded once.
TEST_F(TransmittanceMap, of_all_nodes_has_the_exact_product_of_constant_cards) {
  const Scene scene = stack();
  const GBuffer gbuffer = picture(scene);
  for (const Light& light : scene.lights) {
    const std::vector<float> truth = decided(scene, light, gbuffer);
    for (const char* settings : {"", "filter=bilinear,resolution=256"}) {
      const auto map = run(id, settings, scene, light, gbuffer);
      // Of four equal shares the filter makes the same one, but for rounding of its weights.
      const double steps = *settings ? 4 : 1;
      int wrong = 0;
      const int least = for_receivers(gbuffer, [&](std::size_t i, std::size_t k) {
        ASSERT_NEAR(truth[i], left[k], 1e-7);
        wrong += std::abs(map.mask[i] - truth[i]) > steps * (std::nextafter(truth[i], 1.0f) - truth[i]);
      });
      EXPECT_EQ(wrong, 0) << light.name << ' ' << settings;
      EXPECT_GT(least, 300);
      EXPECT_EQ(value(map.technique->counts(), "longest_list"), 3);
    }
  }
}

// Cards at 2, 5 and 7 below the light's end: .15 and .025 are the areas of the first two nodes. The second goes, and what is
// behind two cards has the light that is behind one.
TEST_F(TransmittanceMap, of_two_nodes_loses_the_second_card) {
  const Scene scene = stack();
  const GBuffer gbuffer = picture(scene);
  const auto map = run(id, "keep=nodes,nodes=2", scene, steep_sun, gbuffer);
  const float expected[] = {0.5f, 0.5f, 0.075f};
  int misnamed = 0;
  for_receivers(gbuffer, [&](std::size_t i, std::size_t k) {
    EXPECT_NEAR(map.mask[i], expected[k], 1e-7) << k;
    misnamed += cause(*map.technique, i) != (k == 1 ? "curve" : "");
  });
  EXPECT_EQ(misnamed, 0);
  const Counts two = map.technique->counts(), all = run(id, "", scene, steep_sun, gbuffer).technique->counts();
  EXPECT_EQ(value(two, "surfaces"), value(all, "surfaces"));
  EXPECT_EQ(3 * value(two, "nodes"), 2 * value(all, "nodes"));
  EXPECT_EQ(value(all, "bytes") - value(two, "bytes"), 8 * (value(all, "nodes") - value(two, "nodes")));
}

TEST_F(TransmittanceMap, of_lines_is_within_the_tolerance) {
  const Scene scene = stack();
  const GBuffer gbuffer = picture(scene);
  for (const double tolerance : {0.01, 0.08, 0.2}) {
    const auto map = run(id, fmt::format("keep=error,tolerance={}", tolerance), scene, steep_sun, gbuffer);
    for_receivers(gbuffer, [&](std::size_t i, std::size_t k) { EXPECT_NEAR(map.mask[i], left[k], tolerance + 1e-6); });
  }
}

// Edges of cards, of texels, of holes and of an opaque card, half a texel of some 4 mm off.
TEST_F(TransmittanceMap, errs_at_edges_alone) {
  const Scene scene = glass_over_ground();
  const GBuffer gbuffer = picture(scene);
  for (const Light& light : {sun, point})
    for (const char* settings : {"resolution=2048", "resolution=2048,filter=bilinear", "resolution=2048,keep=error"})
      EXPECT_LT(mean_error(settings, scene, light, gbuffer), 0.01) << light.name << ' ' << settings;
}

// Which fragment comes first is open from run to run, and the order of meshes is turned round.
TEST_F(TransmittanceMap, does_not_depend_on_the_order_of_arrival) {
  const Scene scene = glass_over_ground();
  Scene turned = scene;
  std::reverse(turned.meshes.begin(), turned.meshes.end());
  const GBuffer gbuffer = picture(scene), other = picture(turned);
  for (const char* settings : {"", "keep=nodes,nodes=2", "keep=error,tolerance=0.1"}) {
    const auto map = run(id, settings, scene, point, gbuffer);
    EXPECT_EQ(map.mask, run(id, settings, scene, point, gbuffer).mask) << settings;
    EXPECT_EQ(map.mask, run(id, settings, turned, point, other).mask) << settings;
  }
}

TEST_F(TransmittanceMap, frees_its_lists_where_a_scene_has_no_glass) {
  const Scene scene = stack();
  Scene clear_scene = scene;
  for (Mesh& mesh : clear_scene.meshes) {
    if (!mesh.transmission) continue;
    mesh.transmission = nullptr;
    mesh.casts = false;
  }
  const GBuffer gbuffer = picture(scene);
  auto map = run(id, "", scene, steep_sun, gbuffer);
  const double texels = value(map.technique->counts(), "texels"), nodes = value(map.technique->counts(), "nodes");
  EXPECT_GE(value(map.technique->counts(), "bytes"), 4 * texels + 4 * texels + 8 * nodes);  // depths, ends of lists, nodes
  map.technique->build(clear_scene);
  answer(map, steep_sun, gbuffer);
  for_receivers(gbuffer, [&](std::size_t i, std::size_t) { EXPECT_EQ(map.mask[i], 1); });
  EXPECT_EQ(value(map.technique->counts(), "nodes"), 0);
  EXPECT_EQ(value(map.technique->counts(), "surfaces"), 0);
}

// 64 x 64 texels take 16 KiB for the ends of their lists; of three cards that cover nearly all of them some 12,000 surfaces
// take nearly 96 KiB.
TEST_F(TransmittanceMap, fails_with_a_number_where_surfaces_do_not_fit) {
  const Scene scene = stack();
  const auto map = registry().technique(id).make();
  map->apply("resolution=64");
  map->setup();
  map->build(scene);
  {
    const LessOfTheDevice less("storage_block_bytes=50000");
    EXPECT_TRUE(support(id, "resolution=64", scene, steep_sun));
    error_words::expect_words(error_words::error_of([&] { map->relight(steep_sun); }),
                              {id, "surfaces of glass take", "bytes", "storage_block_bytes = 50000"});
  }
  map->relight(steep_sun);  // and goes on when there is room
  const LessOfTheDevice less("storage_block_bytes=10000");
  const Support none = support(id, "resolution=64", scene, steep_sun);
  EXPECT_FALSE(none);
  error_words::expect_words(none.why(), {"storage_block_bytes = 10000", "16384"});
}

TEST_F(TransmittanceMap, draws_how_many_nodes_a_texel_has) {
  const Scene scene = stack();
  const GBuffer gbuffer = picture(scene);
  const auto three = run(id, "", scene, steep_sun, gbuffer), one = run(id, "keep=nodes,nodes=1", scene, steep_sun, gbuffer);
  const std::vector<float> of_three = three.technique->draw_debug("nodes"), of_one = one.technique->draw_debug("nodes");
  const std::vector<Swatch> legend = three.technique->debug_layers().back().legend;
  ASSERT_EQ(three.technique->debug_layers().back().name, "nodes");
  for_receivers(gbuffer, [&](std::size_t i, std::size_t) {
    EXPECT_EQ(of_three[3 * i], static_cast<float>(legend[2].color.x));
    EXPECT_EQ(of_one[3 * i], static_cast<float>(legend[0].color.x));
  });
}

// Half of a sheet lets 1/2 through and half nothing. The map of opaque casters holds what is opaque: no curve differs there. At
// the border of the halves, and at the edges of the sheet, rounding may put a texel's center on either side.
TEST_F(TransmittanceMap, texels_that_let_nothing_through_are_no_part_of_its_curves) {
  Scene scene = sheet_over_ground(0.5f);
  scene.meshes[1] =
      of_glass(masked::card(1, 1, nullptr), std::make_shared<const Transmission>(2, 1, 1, std::vector<float>{0.5f, 0}), false);
  finish(scene.meshes[1]);
  const GBuffer gbuffer = picture(scene);
  const std::vector<float> truth = decided(scene, glass_maps_rig::sun, gbuffer), none(gbuffer.size(), 0);
  for (const char* settings : {"", "filter=bilinear"}) {
    const auto map = run(id, settings, scene, glass_maps_rig::sun, gbuffer);
    const std::vector<float> curve = map.technique->draw_debug("curve"), nothing = heat_layer(gbuffer, none);
    int dark = 0, differ = 0;
    for (std::size_t i = 0; i < gbuffer.size(); ++i) {
      dark += !gbuffer.is_background(i) && truth[i] == 0;
      differ += !std::equal(&curve[3 * i], &curve[3 * i] + 3, &nothing[3 * i]);
    }
    EXPECT_GT(dark, 200) << settings;
    EXPECT_LT(differ, dark / 4) << settings;
  }
}

}  // namespace transmittance_map_test
