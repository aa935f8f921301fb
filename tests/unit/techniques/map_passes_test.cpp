// The look-up of compared maps as fragments and as a compute shader.
#include <algorithm>

#include "drawing_test.h"
#include "less_of_the_device.h"
#include "map_scenes.h"
#include "small_world.h"

extern "C" void gnomon_technique_cascaded_map(gnomon::Registry&);
extern "C" void gnomon_technique_shadow_map(gnomon::Registry&);
extern "C" void gnomon_technique_triangle_map(gnomon::Registry&);
extern "C" void gnomon_technique_warped_map(gnomon::Registry&);

namespace map_passes_test {
using namespace gnomon;
using map_scenes::all_kinds;
using map_scenes::soup_over_ground;

using Roll = void (*)(Registry&);

/// A view beside whose ground there is background, and one that is full of receivers. No group of a compute shader divides the
/// width or the height.
const View views[] = {{.eye = {3, 5, 6}, .target = {0, 0.3f, 0}}, {.eye = {0.4f, 2.4f, 0.4f}, .target = {0, 0, 0}}};
constexpr int width = 101, height = 75;

class MapPasses : public DrawingTest {
 protected:
  static std::unique_ptr<Technique> made(Roll roll, const std::string& settings) {
    Registry registry;
    roll(registry);
    auto technique = registry.techniques()[0].make();
    technique->apply(settings);
    return technique;
  }

  /// Both passes have the same mask, to the bit, under every light that the technique supports. Returns how many pixels of all
  /// masks are not lit.
  static std::size_t compare(Roll roll, const std::string& settings, unsigned seed) {
    const Scene scene = soup_over_ground(seed);
    const auto fragment = made(roll, settings + ",pass=fragment"), compute = made(roll, settings + ",pass=compute");
    for (Technique* const one : {fragment.get(), compute.get()}) {
      one->setup();
      one->build(scene);
    }
    std::size_t dark = 0;
    for (const View& view : views) {
      const GBuffer g = small_world::make_gbuffer(scene, view, width, height);
      for (const Light& light : all_kinds) {
        if (!fragment->supports(scene, light, view)) continue;
        fragment->relight(light);
        compute->relight(light);
        const std::vector<float> mask = small_world::mask_of(*fragment, g), other = small_world::mask_of(*compute, g);
        EXPECT_EQ(mask, other) << settings << ", " << light.name << ", seed " << seed << ", view from " << view.eye.y;
        dark += static_cast<std::size_t>(std::ranges::count_if(mask, [](float share) { return share < 1; }));
      }
    }
    return dark;
  }
};

TEST_F(MapPasses, masks_are_the_same_of_every_bias_and_filter) {
  unsigned seed = 0;
  for (const std::string bias : {"constant", "slope", "normal_offset", "receiver_plane"})
    for (const std::string filter : {"nearest", "pcf", "pcf,filter_radius=3", "disc,filter_radius=2", "bilinear"}) {
      const std::string settings = "resolution=128,bias=" + bias + ",filter=" + filter;
      EXPECT_GT(compare(gnomon_technique_shadow_map, settings, ++seed), 1000u) << settings;
    }
}

TEST_F(MapPasses, masks_are_the_same_of_whatever_images_hold) {
  unsigned seed = 100;
  for (const std::string settings : {"fit=view", "stored=second", "stored=midpoint", "stored=dual", "fit=view,stored=dual"})
    EXPECT_GT(compare(gnomon_technique_shadow_map, "resolution=128," + settings, ++seed), 100u) << settings;
}

TEST_F(MapPasses, masks_are_the_same_of_slices_warps_and_lists) {
  unsigned seed = 200;
  for (const std::string more : {"", ",bias=slope", ",bias=normal_offset,filter=pcf", ",filter=bilinear"}) {
    EXPECT_GT(compare(gnomon_technique_cascaded_map, "resolution=128,cascades=3" + more, ++seed), 100u) << more;
    EXPECT_GT(compare(gnomon_technique_warped_map, "resolution=128" + more, ++seed), 100u) << more;
    EXPECT_GT(compare(gnomon_technique_triangle_map, "resolution=128" + more, ++seed), 100u) << more;
  }
}

// What explains a pixel is drawn by fragments, whichever pass answered.
TEST_F(MapPasses, explanations_are_the_same) {
  const Scene scene = soup_over_ground(7);
  const GBuffer g = small_world::make_gbuffer(scene, views[0], width, height);
  for (const Light& light : all_kinds) {
    const auto fragment = small_world::run(gnomon_technique_shadow_map, "resolution=128,pass=fragment", scene, light, g);
    const auto compute = small_world::run(gnomon_technique_shadow_map, "resolution=128,pass=compute", scene, light, g);
    for (std::size_t i = 0; i < g.size(); i += 13) {
      const Explanation one = fragment.technique->explain(i).value(), other = compute.technique->explain(i).value();
      ASSERT_EQ(one.taps.size(), other.taps.size()) << light.name << ", pixel " << i;
      EXPECT_EQ(one.covered, other.covered) << light.name << ", pixel " << i;
      for (std::size_t k = 0; k < one.taps.size(); ++k)
        EXPECT_EQ(one.taps[k].stored, other.taps[k].stored) << light.name << ", pixel " << i;
    }
  }
}

// A group has 32 x 2 invocations and answers 8 rows: 16,384 pixels are 2,048 groups one below the other.
TEST_F(MapPasses, a_device_with_too_few_groups_supports_the_fragments_alone) {
  const Scene scene = soup_over_ground(1);
  const auto why = [&](const std::string& limit, const std::string& pass) {
    const LessOfTheDevice less(limit);
    return made(gnomon_technique_shadow_map, "pass=" + pass)->supports(scene, all_kinds[0], views[0]).why();
  };
  EXPECT_EQ(why("work_group_size=32", "compute"), "the OpenGL device has work_group_size = 32; 64 are needed");
  EXPECT_EQ(why("work_groups=1024", "compute"), "the OpenGL device has work_groups = 1024; 2048 are needed");
  EXPECT_EQ(why("work_group_size=64,work_groups=2048", "compute"), "");
  EXPECT_EQ(why("work_group_size=32,work_groups=1024", "fragment"), "");
}

TEST_F(MapPasses, another_pass_is_an_error_that_names_both) {
  try {
    made(gnomon_technique_shadow_map, "pass=mesh");
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("pass = mesh"), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find("fragment | compute"), std::string::npos) << error.what();
  }
}

}  // namespace map_passes_test
