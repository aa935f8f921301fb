// Whether a technique keeps its promise, on the pixels of class T and against the truth of the geometry that it sees.
#include "measure/frame/certify_soft.h"
#include "measure/statistics/statistics.h"
#include "stage.h"

namespace conformance {
namespace {

class Exact : public Every {};
INSTANTIATE_TEST_SUITE_P(technique, Exact,
                         testing::ValuesIn(ids_where([](const About& about) { return about.promise == Promise::exact; })),
                         id_of);

class Sampled : public Every {};
INSTANTIATE_TEST_SUITE_P(technique, Sampled, testing::ValuesIn(ids_where([](const About& about) {
                           return about.promise == Promise::sampled && about.role != Role::baseline;
                         })),
                         id_of);

/// Pixels of class T that the technique covers, and what is wrong about them.
struct Tally {
  std::size_t tested = 0, dark = 0, wrong = 0, first_wrong = 0;
};

Tally tally(const std::vector<float>& mask, const World::Truthful& truth, const Technique& technique) {
  Tally t;
  for (std::size_t i = 0; i < mask.size(); ++i) {
    if (truth.classes[i] != PixelClass::T) continue;
    const auto why = technique.explain(i);
    if (why && !why->covered) continue;
    ++t.tested;
    t.dark += truth.mask[i] < 0.5f;
    const bool wrong = std::abs(mask[i] - truth.mask[i]) >= 0.5f;
    if (wrong && t.wrong++ == 0) t.first_wrong = i;
  }
  return t;
}

// Zero wrong pixels on every generated scene, both lights; and what is not covered must not hide behind the promise.
TEST_P(Exact, is_wrong_at_no_tested_pixel) {
  std::size_t tested = 0, dark = 0;
  for (const char* reference : {"sphere_over_plane", "box_city:count=30", "soup:count=200", "fence", "contact"}) {
    const auto w = world(reference);
    const GBuffer gbuffer = w->gbuffer(w->scene.views[0], 160, 90);
    for (const Light& light : w->scene.lights) {
      const Support support = this->support(w->scene, light);
      if (!support || has_area(light)) continue;
      SCOPED_TRACE(fmt::format("{}, {}", reference, title(light)));
      const auto technique = set_up();
      const std::vector<float> mask = answer(*technique, w->scene, light, gbuffer);
      const World::Truthful truth = w->reference(gbuffer, light);
      const Tally t = tally(mask, truth, *technique);
      EXPECT_EQ(t.wrong, 0u) << "of " << t.tested << ", first at x = " << t.first_wrong % gbuffer.width
                             << ", y = " << t.first_wrong / gbuffer.width;
      if (support.kind() == Support::Kind::full) {
        EXPECT_EQ(t.tested, count_classes(truth.classes)[static_cast<std::size_t>(PixelClass::T)]) << "not covered";
      }
      tested += t.tested, dark += t.dark;
    }
  }
  if (tested == 0) GTEST_SKIP() << "supports no light without area on these scenes";
  EXPECT_GT(dark, 1000u);  // the scenes do have shadows
}

// Under lights with area exact means: within 4 standard errors of the reference, but for as many pixels as these errors are
// themselves uncertain by, and nowhere beyond 12.
TEST_P(Exact, is_within_four_errors_under_lights_with_area) {
  std::size_t penumbra = 0, tested = 0;
  for (const char* reference : {"sphere_over_plane:segments=24", "box_city:count=12", "soup:count=60"}) {
    const auto w = world(reference);
    const GBuffer gbuffer = w->gbuffer();
    for (const Light& light : supported_lights(w->scene)) {
      if (!has_area(light)) continue;
      SCOPED_TRACE(fmt::format("{}, {}", reference, title(light)));
      const std::vector<float> mask = fresh_answer(w->scene, light, gbuffer);
      const World::Truthful truth = w->reference(gbuffer, light, entry().about.estimates);
      std::size_t soft = 0, beyond_4 = 0;
      for (std::size_t i = 0; i < mask.size(); ++i) {
        if (truth.classes[i] != PixelClass::T) continue;
        ++tested;
        soft += truth.mask[i] > 0 && truth.mask[i] < 1;
        const float off = std::abs(mask[i] - truth.mask[i]);
        beyond_4 += off > 4 * truth.error[i];
        ASSERT_LE(off, 12 * truth.error[i]) << "x = " << i % gbuffer.width << ", y = " << i / gbuffer.width << ": " << mask[i]
                                            << ", reference " << truth.mask[i];
      }
      EXPECT_LE(beyond_4, most_by_chance(soft, 2 * student_tail(4, 7), 1e-6)) << "of " << soft << " in penumbrae";
      penumbra += soft;
    }
  }
  if (tested == 0) GTEST_SKIP() << "supports no light with area on these scenes";
  EXPECT_GT(penumbra, 1000u);
}

// At its defaults a technique of samples errs on less than a quarter of what the absence of shadows errs on.
TEST_P(Sampled, is_far_better_than_no_shadows) {
  const auto w = world("sphere_over_plane");
  const GBuffer gbuffer = w->gbuffer(w->scene.views[0], 320, 180);
  std::size_t tested = 0;
  for (const Light& light : w->scene.lights) {
    if (!support(w->scene, light)) continue;
    SCOPED_TRACE(title(light));
    const auto technique = set_up();
    const std::vector<float> mask = answer(*technique, w->scene, light, gbuffer);
    const Tally t = tally(mask, w->reference(gbuffer, light), *technique);
    EXPECT_LT(t.wrong, t.dark / 4) << "of " << t.tested << " tested, " << t.dark << " dark";
    tested += t.tested;
  }
  if (tested == 0) GTEST_SKIP() << "supports no light without area on this scene";
}

TEST_P(Sampled, is_far_better_than_no_shadows_under_lights_with_area) {
  const auto w = world("sphere_over_plane");
  const GBuffer gbuffer = w->gbuffer(w->scene.views[0], 160, 90);
  std::size_t asked = 0;
  for (const Light& light : supported_lights(w->scene)) {
    if (!has_area(light)) continue;
    SCOPED_TRACE(title(light));
    const std::vector<float> mask = fresh_answer(w->scene, light, gbuffer);
    const World::Truthful truth = w->reference(gbuffer, light, entry().about.estimates);
    double error = 0, without = 0;
    for (std::size_t i = 0; i < mask.size(); ++i) {
      if (truth.classes[i] != PixelClass::T) continue;
      error += std::abs(mask[i] - truth.mask[i]);
      without += 1 - truth.mask[i];
    }
    EXPECT_LT(error, without / 4);
    ++asked;
  }
  if (asked == 0) GTEST_SKIP() << "supports no light with area on this scene";
}

}  // namespace
}  // namespace conformance
