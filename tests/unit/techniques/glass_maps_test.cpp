// Parameter glass of the techniques that draw depth maps: what casters that let light through are taken for.
#include <gnomon/kit/geometry/edges.h>

#include "glass_maps_rig.h"

namespace glass_maps_test {
using namespace glass_maps_rig;

class GlassMaps : public TestRig {};

struct Case {
  const char *id, *settings, *lights;
};

TEST_F(GlassMaps, every_map_answers_as_without_glass_or_as_with_opaque_casters) {
  const Case cases[] = {{"shadow_map", "", "sun point"},
                        {"shadow_map", "fit=view,filter=pcf", "sun point"},
                        {"shadow_map", "stored=second", "sun point"},
                        {"shadow_map", "stored=midpoint", "sun point"},
                        {"shadow_map", "stored=dual", "sun"},
                        {"shadow_map", "alpha=mips", "sun"},
                        {"cascaded_map", "", "sun"},
                        {"warped_map", "", "sun"},
                        {"virtual_map", "", "sun point"},
                        {"variance_map", "", "sun point"},
                        {"variance_map", "fit=view,prefilter=mips", "sun"},
                        {"moment_map", "", "sun"},
                        {"exponential_map", "", "sun"},
                        {"exponential_variance_map", "", "sun"},
                        {"percentage_closer_soft", "", "lamp"},
                        {"backprojected_map", "", "lamp"}};
  const Scene scenes[] = {glass_over_ground(false), glass_over_ground(true)};
  const GBuffer pictures[] = {picture(scenes[0]), picture(scenes[1])};
  for (const Case& one : cases) {
    small_world::Run map{registry().technique(one.id).make(), {}};
    map.technique->apply(one.settings);
    map.technique->setup();
    for (const Light& light : {sun, point, lamp}) {
      if (std::string_view(one.lights).find(light.name) == std::string_view::npos) continue;
      for (const bool is_seen : {false, true}) {
        const Scene& scene = scenes[is_seen];
        std::vector<float> masks[2];
        for (const Rule& rule : rules) {
          const Scene taken = taken_for(rule.as, scene);
          map.technique->parameter("glass").set(rule.value);
          map.technique->build(scene);
          answer(map, light, pictures[is_seen]);
          masks[static_cast<int>(rule.as)] = map.mask;
          map.technique->build(taken);
          answer(map, light, pictures[is_seen]);
          EXPECT_EQ(masks[static_cast<int>(rule.as)], map.mask)
              << one.id << ' ' << one.settings << ' ' << rule.value << ' ' << light.name << ' ' << is_seen;
        }
        EXPECT_NE(masks[0], masks[1]) << one.id << ' ' << one.settings << ' ' << light.name;
      }
    }
  }
}

// A body is drawn by the half that is turned to the light; glass has no inside, and its other half lets light through, too.
TEST_F(GlassMaps, glass_is_no_body) {
  const Mesh box = small_world::box({0, 0, 0}, {1, 1, 1});
  EXPECT_EQ(solid_parts(box).size(), 1u);
  EXPECT_TRUE(solid_parts(of_glass(box, clear(0.5f), false)).empty());
}

TEST_F(GlassMaps, support_is_approximate_and_says_why) {
  const Scene scene = glass_over_ground();
  for (const char* id : maps) {
    const Light& light = is_soft(id) ? lamp : sun;
    for (const Rule& rule : rules) {
      const Support with_glass = support(id, rule.setting(), scene, light);
      EXPECT_EQ(with_glass.kind(), Support::Kind::approximate) << id;
      EXPECT_EQ(with_glass.why(), rule.why) << id;
      EXPECT_EQ(support(id, rule.setting(), taken_for(rule.as, scene), light).kind(), Support::Kind::full) << id;
    }
    EXPECT_EQ(support(id, "", scene, light).why(), "glass is taken for opaque") << id;
  }
  const std::string both = support("backprojected_map", "glass=none", scene, disc_lamp).why();
  EXPECT_TRUE(both.starts_with("glass is left out, and a square")) << both;
}

TEST_F(GlassMaps, scenes_whose_glass_colors_light_are_unsupported) {
  Scene scene = sheet_over_ground(0.5f);
  scene.meshes[1].transmission = std::make_shared<const Transmission>(glm::vec3(0.5f, 0.4f, 0.5f));
  for (const char* id : maps) EXPECT_FALSE(support(id, "", scene, is_soft(id) ? lamp : sun)) << id;
}

}  // namespace glass_maps_test
