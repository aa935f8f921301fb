// The rule about what a scene needs and a technique handles.
#include <gtest/gtest.h>

#include <cmath>

#include "faulty.h"
#include "measure/conformance/rule.h"
#include "measure/conformance/world.h"

namespace features_test {
using namespace gnomon;
using namespace gnomon::conformance;
using faulty::entry;
using faulty::Fault;
using Kind = Verdict::Kind;

About handling(About about) {
  about.handles = with_alpha_masks;
  return about;
}

TEST(features, of_a_scene_that_a_technique_does_not_handle_make_it_unsupported) {
  EXPECT_EQ(judge(rule("features"), entry<Fault::none>()).kind, Kind::holds);
  const Scene scene = checkered_card();
  const TechniqueEntry solid = entry<Fault::none>(), holes = entry<Fault::none>(handling(faulty::exact));
  for (const Light& light : scene.lights) {
    const Support refused = support_of(solid.about, *solid.make(), scene, light, scene.views[0]);
    EXPECT_EQ(refused.kind(), Support::Kind::unsupported);
    EXPECT_NE(refused.why().find("alpha_masks"), std::string::npos) << refused.why();
    EXPECT_TRUE(support_of(holes.about, *holes.make(), scene, light, scene.views[0]));
  }
}

TEST(features, of_a_scene_that_a_technique_handles_are_judged_by_its_promise) {
  if (is_sanitized) GTEST_SKIP() << "answers are not judged there";
  const About exact = handling(faulty::exact), sampled = handling(faulty::sampled());
  const auto kind = [](const TechniqueEntry& entry) { return judge(rule("features"), entry).kind; };
  EXPECT_EQ(kind(entry<Fault::none>(exact)), Kind::holds);
  EXPECT_EQ(kind(entry<Fault::none>(sampled)), Kind::holds);
  EXPECT_EQ(kind(entry<Fault::is_lit>(exact)), Kind::fails);
  EXPECT_EQ(kind(entry<Fault::is_lit>(sampled)), Kind::fails);
  EXPECT_EQ(kind(entry<Fault::promises_half>(sampled)), Kind::holds);
  EXPECT_EQ(kind(entry<Fault::promises_little>(sampled)), Kind::fails);
}

}  // namespace features_test
