// Every exact technique gives the same on one thread and on many: masks, counts, what shades a point, layers and polygons.
#include <tbb/global_control.h>

#include <thread>

#include "exact_oracle_rig.h"
#include "exact_techniques.h"

namespace gnomon::exact_oracle::exact_oracle_threads_test {

const std::size_t many = std::max(8u, std::thread::hardware_concurrency());

struct ThreadsChangeNothing : ExactOracle {
  static small_world::Run run_on(std::size_t threads, const std::string& settings, const Scene& scene, const Light& light,
                                 const GBuffer& gbuffer) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    return run(settings, scene, light, gbuffer);
  }
  static void expect_same(const small_world::Run& one, const small_world::Run& many) {
    EXPECT_EQ(one.mask, many.mask);
    const Counts counts = one.technique->counts(), others = many.technique->counts();
    ASSERT_EQ(counts.size(), others.size());
    for (std::size_t k = 0; k < counts.size(); ++k) EXPECT_EQ(counts[k].value, others[k].value) << counts[k].name;
    for (std::size_t i = 0; i < one.mask.size(); ++i) {
      const auto why = one.technique->explain(i), other = many.technique->explain(i);
      ASSERT_EQ(why.has_value(), other.has_value());
      if (!why) continue;
      ASSERT_EQ(why->element, other->element) << i;
    }
    const auto detail = one.technique->surface_detail(), other = many.technique->surface_detail();
    ASSERT_EQ(detail.has_value(), other.has_value());
    if (!detail) return;
    EXPECT_EQ(detail->corners, other->corners);
    EXPECT_EQ(detail->polygons.size(), other->polygons.size());
  }
  static void expect_same_layers(const small_world::Run& one, const small_world::Run& many) {
    for (const DebugLayer& layer : one.technique->debug_layers())
      EXPECT_EQ(one.technique->draw_debug(layer.name), many.technique->draw_debug(layer.name)) << layer.name;
  }
};

INSTANTIATE_TEST_SUITE_P(All, ThreadsChangeNothing, testing::ValuesIn(exact_techniques()),
                         [](const auto& info) { return info.param.id(); });

// So many triangles that threads share the first splits of a tree, and the rest.
TEST_P(ThreadsChangeNothing, in_large_scenes) {
  std::mt19937 engine(12);
  Scene scene;
  scene.meshes = {hand_made::square(3, 0), small_world::random_soup(engine, GetParam().many_triangles, 2, 0.1f, 2, 0.05f)};
  Random random(12);
  const Light light = hand_made::point_light({0.7f, 3, 1.1f});
  hand_made::Picture picture(200, 100);
  hard_scenes::scatter(scene, light, random, picture);
  Agreement sum;
  compare(GetParam().settings_at_size, scene, light, picture.gbuffer, sum);
  expect_agreement(sum, GetParam().many_triangles / 12, 1000);
  for (const std::string& settings : GetParam().settings_at_size) {
    SCOPED_TRACE(settings);
    expect_same(run_on(1, settings, scene, light, picture.gbuffer), run_on(many, settings, scene, light, picture.gbuffer));
  }
}

TEST_P(ThreadsChangeNothing, in_pictures) {
  std::mt19937 engine(7);
  Random random(7);
  for (int round = 0; round < 2; ++round) {
    SCOPED_TRACE(round);
    const auto [scene, gbuffer, lights] = hard_scenes::viewed(random, engine);
    for (const Light& light : lights) {
      const auto one = run_on(1, "", scene, light, gbuffer), others = run_on(many, "", scene, light, gbuffer);
      expect_same(one, others);
      expect_same_layers(one, others);
    }
  }
}

}  // namespace gnomon::exact_oracle::exact_oracle_threads_test
