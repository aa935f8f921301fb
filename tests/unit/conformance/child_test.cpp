// A rule in a process of its own: what the process does to itself is a finding, and verdicts come back as they were.
#include "measure/conformance/child.h"

#include <gtest/gtest.h>

#include "places.h"

namespace child_test {

using namespace gnomon;
using namespace gnomon::conformance;
using Kind = Verdict::Kind;

TEST(check_child, verdicts_survive_the_way_through_json) {
  Verdict verdict{
      .kind = Kind::fails, .findings = {{"a", {"scene", "light", "b=1"}, PlacedPixel{1, 2, 3, 4}}, {"c"}}, .finding_count = 7};
  const Verdict back = verdict_of(verdict_json(verdict));
  EXPECT_EQ(json_text(verdict_json(back)), json_text(verdict_json(verdict)));
  EXPECT_EQ(back.kind, Kind::fails);
  EXPECT_EQ(place_text(back.findings[0]), "in scene, light light, with b=1, pixel 1, 2 of 3 x 4");
  EXPECT_EQ(place_text(back.findings[1]), "");
  EXPECT_EQ(verdict_of(verdict_json({.kind = Kind::does_not_apply, .why = "no"})).why, "no");
}

TEST(check_child, a_crash_and_a_hang_are_findings_with_their_places) {
  const TechniqueEntry crashes{.id = "crashes", .about = {}, .make = nullptr},
      hangs{.id = "hangs", .about = {}, .make = nullptr};
  const WorkerOptions options{.threads = 0, .plugins = {faults_plugin()}, .program = tested_program()};
  const Verdict crash = judge_in_child(rule("same_mask"), crashes, options, 60);
  ASSERT_EQ(crash.kind, Kind::fails);
  EXPECT_EQ(crash.findings[0].what, "it crashed in same_mask: Segmentation fault (signal 11)");
  EXPECT_EQ(place_text(crash.findings[0]), "in sphere_over_plane:segments=24, light point (point)");
  const Verdict hang = judge_in_child(rule("change_of_light"), hangs, options, 3);
  ASSERT_EQ(hang.kind, Kind::fails);
  EXPECT_EQ(hang.findings[0].what, "it hung in change_of_light: no answer within 3 s");
  EXPECT_EQ(place_text(hang.findings[0]), "in box_city:count=12, light point (point)");
  EXPECT_EQ(judge_in_child(rule("data_sheet"), crashes, options, 60).kind, Kind::holds);
}

}  // namespace child_test
