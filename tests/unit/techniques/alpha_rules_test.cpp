// Parameter alpha of the techniques that draw maps: what decides about holes, and what it explains.
#include <gnomon/kit/maps/alpha_setting.h>
#include <gnomon/kit/maps/map_causes.h>
#include <gnomon/kit/rays/gbuffer_maker.h>
#include <gnomon/registry.h>
#include <gtest/gtest.h>

#include "device/context.h"
#include "masked.h"
#include "measure/cause/own_causes.h"
#include "measure/conformance/gl_state.h"
#include "small_world.h"

namespace alpha_rules_test {
using namespace gnomon;

constexpr const char* rules[] = {"texel", "mips", "mips_kept", "hashed"};
constexpr const char* hard_maps[] = {"shadow_map", "cascaded_map", "warped_map", "virtual_map"};
constexpr const char* maps[] = {"shadow_map",
                                "cascaded_map",
                                "warped_map",
                                "virtual_map",
                                "variance_map",
                                "moment_map",
                                "exponential_map",
                                "exponential_variance_map",
                                "percentage_closer_soft",
                                "backprojected_map"};

/// One of each home of the code that draws.
constexpr const char* homes[] = {"shadow_map", "virtual_map", "variance_map", "percentage_closer_soft"};

/// A card of 3 m over a ground, seen from straight above at its side, so that the eye sees most of the shadow.
Scene card_over_ground(std::shared_ptr<const AlphaMask> mask, float times) {
  Scene scene;
  scene.name = "card_over_ground";
  scene.meshes = {hand_made::square(4, 0), masked::card(1.5f, 1, std::move(mask), times)};
  for (Mesh& mesh : scene.meshes) finish(mesh);
  scene.views = {{.name = "view", .eye = {4.5f, 3.5f, 0}, .target = {1, 0, 0}}};
  return scene;
}
const Light sun{.name = "sun", .kind = DirectionalLight{{0.8f, -1, 0.1f}}};
const Light lamp{.name = "lamp", .kind = RectLight{.center = {-1.5f, 5, 0}, .half_u = {0.2f, 0, 0}, .half_v = {0, 0, 0.2f}}};

/// Alpha 77 / 255 = 0.302 with cutoff 1/2: a hole everywhere.
std::shared_ptr<const AlphaMask> faint() { return std::make_shared<const AlphaMask>(4, 4, std::vector<std::uint8_t>(16, 77)); }
/// Gray values that filters change and random thresholds divide.
std::shared_ptr<const AlphaMask> grays() {
  Random random(5);
  std::vector<std::uint8_t> alpha;
  for (int i = 0; i < 256; ++i) alpha.push_back(static_cast<std::uint8_t>(random.below(256)));
  return std::make_shared<const AlphaMask>(16, 16, alpha);
}

class AlphaRules : public testing::Test {
 protected:
  AlphaRules() { process_context(); }
  void TearDown() override {
    EXPECT_EQ(state_differences(), std::vector<std::string>{});
    release_inputs();
  }

  static GBuffer picture(const Scene& scene, int width = 160, int height = 120) {
    return make_gbuffer(scene, RayScene(scene, Truth::mesh, RayScene::Which::seen), scene.views[0], width, height, Truth::mesh);
  }
  static const Light& light_of(std::string_view id) {
    return id == "percentage_closer_soft" || id == "backprojected_map" ? lamp : sun;
  }
  static small_world::Run run(const char* id, const std::string& settings, const Scene& scene, const GBuffer& gbuffer) {
    const TechniqueEntry& entry = registry().technique(id);
    small_world::Run run{entry.make(), {}};
    run.technique->apply(settings);
    EXPECT_TRUE(support_of(entry.about, *run.technique, scene, light_of(id), scene.views[0])) << id;
    run.technique->setup();
    run.technique->build(scene);
    run.technique->relight(light_of(id));
    resolve(run, gbuffer);
    return run;
  }
  static void resolve(small_world::Run& run, const GBuffer& gbuffer) {
    VisibilityMask mask(gbuffer.width, gbuffer.height);
    run.technique->resolve(gbuffer, mask);
    const auto pixels = mask.read();
    run.mask.assign(pixels.begin(), pixels.end());
  }
  static std::string alpha(const char* rule) { return fmt::format("alpha={}", rule); }
};

TEST_F(AlphaRules, without_masks_all_answer_alike) {
  Scene scene = card_over_ground(nullptr, 1);
  scene.meshes[1].uv.clear();
  const GBuffer gbuffer = picture(scene);
  for (const char* id : homes) {
    const auto plain = run(id, "", scene, gbuffer);
    for (const char* rule : rules) {
      const auto other = run(id, alpha(rule), scene, gbuffer);
      EXPECT_EQ(plain.mask, other.mask) << id << ' ' << rule;
      EXPECT_EQ(small_world::value(plain.technique->counts(), "bytes"), small_world::value(other.technique->counts(), "bytes"))
          << id << ' ' << rule;
    }
  }
}

// The truth of an alpha of 0.302 below the cutoff is light. A random threshold over (0, 1] is passed by 0.302 of the texels of
// the map, so that 0.698 of the light is left.
TEST_F(AlphaRules, hashed_keeps_the_mean_where_the_bit_says_hole) {
  const Scene scene = card_over_ground(faint(), 1);
  Scene filled = scene;
  filled.meshes[1].alpha_mask = nullptr;
  const GBuffer gbuffer = picture(scene, 480, 360);
  for (const char* id : hard_maps) {
    const auto solid = run(id, "", filled, gbuffer), texel = run(id, "", scene, gbuffer),
               hashed = run(id, "alpha=hashed", scene, gbuffer);
    int count = 0;
    double sum = 0;
    for (std::size_t i = 0; i < gbuffer.size(); ++i) {
      EXPECT_EQ(texel.mask[i], 1) << id << ' ' << i;
      if (solid.mask[i] != 0) continue;
      ++count;
      sum += hashed.mask[i];
    }
    ASSERT_GT(count, 10000) << id;
    EXPECT_NEAR(sum / count, 0.698, 0.02) << id;
  }
}

// What explain names is what the mask by the texel's rule tells: under the sun the other side of one half, under the lamp a
// difference of more than 1/16.
TEST_F(AlphaRules, the_cause_is_named_where_the_bit_would_answer_otherwise) {
  const Scene scene = card_over_ground(grays(), 6);
  const GBuffer gbuffer = picture(scene);
  for (const char* id : homes) {
    const bool is_soft = has_area(light_of(id));
    const auto by_texel = run(id, "", scene, gbuffer);
    for (const char* rule : rules) {
      const auto by_rule = run(id, alpha(rule), scene, gbuffer);
      const std::string_view name = alpha_causes[rule == std::string_view("hashed") ? 1 : 0].id;
      int named = 0, wrong = 0;
      for (std::size_t i = 0; i < gbuffer.size(); ++i) {
        const float a = by_rule.mask[i], b = by_texel.mask[i];
        const bool differs = is_soft ? std::abs(a - b) > 1.0f / 16 : (a > 0.5f) != (b > 0.5f);
        const auto why = by_rule.technique->explain(i);
        const std::string cause = why ? why->cause : "";
        named += differs;
        // Soft filters look nothing up where the light's center is below the horizon.
        wrong += cause != (differs ? name : "");
      }
      EXPECT_EQ(wrong, 0) << id << ' ' << rule;
      if (rule == std::string_view("texel"))
        EXPECT_EQ(named, 0) << id;
      else
        EXPECT_GT(named, 20) << id << ' ' << rule;
    }
  }
}

// Set on a used object, the rule counts from the stage on that it spoils, as in a fresh object; and what it reads is counted.
TEST_F(AlphaRules, another_rule_between_two_pictures) {
  const Scene scene = card_over_ground(grays(), 6);
  const GBuffer gbuffer = picture(scene);
  for (const char* id : homes) {
    auto used = run(id, "", scene, gbuffer);
    const double plain = small_world::value(used.technique->counts(), "bytes");
    for (const char* rule : {"hashed", "mips_kept", "mips", "texel", "mips"}) {
      const auto fresh = run(id, alpha(rule), scene, gbuffer);
      used.technique->parameter("alpha").set(rule);
      used.technique->relight(light_of(id));
      resolve(used, gbuffer);
      EXPECT_EQ(used.mask, fresh.mask) << id << ' ' << rule;
      const double bytes = small_world::value(used.technique->counts(), "bytes");
      const auto position = std::ranges::find(rules, std::string_view(rule)) - std::begin(rules);
      EXPECT_EQ(bytes, plain + double(alpha_bytes(scene, AlphaRule(position)))) << id << ' ' << rule;
      EXPECT_EQ(bytes, small_world::value(fresh.technique->counts(), "bytes")) << id << ' ' << rule;
    }
  }
}

// A picture after questions, which draw by the texel's rule, is as before them.
TEST_F(AlphaRules, questions_leave_the_rule_as_it_is) {
  const Scene scene = card_over_ground(grays(), 6);
  const GBuffer gbuffer = picture(scene);
  for (const char* id : homes) {
    auto map = run(id, "alpha=hashed", scene, gbuffer);
    const std::vector<float> before = map.mask;
    for (std::size_t i = 0; i < gbuffer.size(); i += 97) map.technique->explain(i);
    resolve(map, gbuffer);
    EXPECT_EQ(map.mask, before) << id;
  }
}

TEST_F(AlphaRules, both_causes_are_allowed_in_every_data_sheet) {
  EXPECT_NO_THROW(check_own_causes(registry().techniques()));
  for (const char* id : maps) EXPECT_EQ(registry().technique(id).about.causes.size(), std::size(map_causes)) << id;
}

}  // namespace alpha_rules_test
