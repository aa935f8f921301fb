// Every rule finds the fault that it is there for, and a technique without faults keeps them all.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "faulty.h"
#include "measure/conformance/rule.h"
#include "measure/scene/load.h"
#include "verdicts.h"

namespace rules_test {

using namespace gnomon;
using namespace gnomon::conformance;
using faulty::entry;
using faulty::Fault;
using Kind = Verdict::Kind;

/// How places name the size of pictures. Under a sanitizer they have half of it, and some rules check less.
constexpr const char* size = is_sanitized ? "48 x 27" : "96 x 54";

/// The rule fails, and says so.
void expect_found(std::string_view name, const TechniqueEntry& entry, std::string_view says, std::string_view where) {
  const Verdict verdict = judge(rule(name), entry);
  EXPECT_EQ(verdict.kind, Kind::fails) << name;
  EXPECT_NE(findings(verdict).find(says), std::string::npos) << name << ": " << findings(verdict);
  EXPECT_NE(findings(verdict).find(where), std::string::npos) << name << ": " << findings(verdict);
}

TEST(rules, have_a_plain_name_of_their_own_and_sentences) {
  std::set<std::string_view> names;
  for (const Rule& rule : rules()) {
    EXPECT_TRUE(is_plain_name(rule.name) && names.insert(rule.name).second) << rule.name;
    for (const std::string_view text : {rule.sentence, rule.advice}) {
      EXPECT_FALSE(text.empty()) << rule.name;
      EXPECT_EQ(text.back(), '.') << rule.name;
      EXPECT_FALSE(std::islower(static_cast<unsigned char>(text.front()))) << rule.name;
    }
    EXPECT_EQ(&conformance::rule(rule.name), &rule);
  }
  EXPECT_THROW(
      {
        try {
          rule("same_masc");
        } catch (const Error& error) {
          EXPECT_NE(std::string_view(error.what()).find("did you mean same_mask?"), std::string_view::npos) << error.what();
          throw;
        }
      },
      Error);
}

// A program has no object, no header and no OpenGL of ours: rules that can fail for one give advice that speaks of requests,
// answers and keys of the description.
TEST(rules, advise_the_author_of_a_program_in_its_words) {
  TechniqueEntry program;
  program.origin = "techniques/mine.toml";
  TechniqueEntry plugin;
  plugin.origin = "mine.so";
  for (const Rule& rule : rules()) {
    EXPECT_EQ(advice_for(rule, {}), rule.advice);
    EXPECT_EQ(advice_for(rule, plugin), rule.advice);
    const std::string_view advice = advice_for(rule, program);
    EXPECT_EQ(advice.back(), '.') << rule.name;
    if (rule.applies_to == AppliesTo::drawing) continue;  // no program is asked
    for (const std::string_view of_sources : {"()", "::", ".h", "static", "OpenGL", "constructor", "object"})
      EXPECT_EQ(advice.find(of_sources), std::string_view::npos) << rule.name << ": " << advice;
  }
}

TEST(rules, hold_of_a_technique_without_faults) {
  for (const Rule& rule : rules()) {
    const Verdict verdict = judge(rule, entry<Fault::none>());
    EXPECT_NE(verdict.kind, Kind::fails) << rule.name << ": " << findings(verdict);
    EXPECT_EQ(verdict.why.empty(), verdict.kind == Kind::holds) << rule.name;
    if (rule.name == "named_causes") {
      EXPECT_EQ(verdict.why, "no pixel of these scenes is wrong");
    } else if (rule.applies_to == AppliesTo::all && !(is_sanitized && rule.sanitized == Sanitized::nothing)) {
      EXPECT_EQ(verdict.kind, Kind::holds) << rule.name;
    }
  }
}

TEST(rules, find_the_faults_of_masks) {
  expect_found("same_mask", entry<Fault::is_nan>(), "the mask is nan, outside 0 .. 1",
               fmt::format("in sphere_over_plane:segments=24, light point (point), pixel 7, 0 of {}", size));
  expect_found("same_mask", entry<Fault::writes_half>(), "the pixel was not written",
               is_sanitized ? "pixel 24, 13 of 48 x 27" : "pixel 0, 27 of 96 x 54");
  expect_found("same_mask", entry<Fault::differs>(),
               fmt::format("resolve again: 1 of {} values differ", is_sanitized ? 48 * 27 : 96 * 54),
               is_sanitized ? "pixel 5, 4 of 48 x 27" : "pixel 5, 2 of 96 x 54");
  expect_found("lit_without_casters", entry<Fault::casts_all>(), "its mask, and one of ones",
               "in box_city:count=12, of which no mesh casts");
  expect_found("lit_below_no_caster", entry<Fault::casts_all>(), "tested pixels are dark; 0 may be",
               "light point (point), pixel ");
  expect_found("counts", entry<Fault::says_no_bytes>(), "0 counts are named bytes, not 1", "box_city:count=12");
  expect_found("explanations", entry<Fault::weighs_half>(), "the weights of its taps sum to 0.5, not 1",
               fmt::format("pixel 0, 0 of {}", size));
  expect_found("debug_layers", entry<Fault::draws_beyond>(), "layer gray has colors outside 0 .. 1", "light point (point)");
  expect_found("global_picture", entry<Fault::sends_no_number>(), "the global picture has a radiance of nan",
               "light point (point)");
}

TEST(rules, find_what_an_object_keeps_from_its_earlier_life) {
  expect_found("change_of_light", entry<Fault::keeps_light>(), "relit after other lights, and fresh",
               "light sun (directional), pixel ");
  expect_found("change_of_scene", entry<Fault::keeps_scene>(), "after another scene, and fresh",
               "in sphere_over_plane:segments=12");
  expect_found("two_objects", entry<Fault::shares_light>(), "alone and beside the other", "pixel ");
  if (!is_sanitized)  // it checks one end there
    expect_found("parameter_ends", entry<Fault::spoils_later>(), "set on a used object, from resolve on", "with is_open=true");
}

TEST(rules, find_lengths_that_are_special) {
  if (is_sanitized) GTEST_SKIP() << "the rule is not checked there";
  expect_found("scale", entry<Fault::has_near_plane>(), "pixels differ",
               "in sphere_over_plane:segments=16, lengths times 2^-20, directions times 2^8, light point (point)");
}

TEST(rules, find_what_a_technique_says_that_is_not_so) {
  expect_found("support_answered", entry<Fault::gives_no_reason>(), "the support is unsupported with the reason ''",
               "light rect (rect)");
  expect_found("supports_a_light", entry<Fault::refuses_all>(), "it supports no light at all", "in box_city:count=12");
  if (!is_sanitized)  // nor is memory counted there
    expect_found("reported_bytes", entry<Fault::says_many_bytes>(), "it reports more than it holds: 1024.0 MiB reported",
                 "sphere_over_plane");
  About nameless = faulty::exact;
  nameless.fails = "always";
  expect_found("data_sheet", entry<Fault::none>(nameless), "fails is no sentence: 'always'", "");
}

TEST(rules, find_broken_promises) {
  expect_found("exact", entry<Fault::is_inverted>(), "tested pixels are wrong; the mask is ",
               "in fence, light sun (directional), pixel ");
  expect_found("named_causes", entry<Fault::is_inverted>(), "wrong pixels have no cause that explains them",
               "in contact, light point (point), pixel ");
  EXPECT_EQ(judge(rule("named_causes"), entry<Fault::is_lit>()).why,
            "it explains no wrong pixel: causes are told from where they are alone");
  expect_found("better_than_nothing", entry<Fault::is_lit>(faulty::sampled()), "without shadows",
               "in sphere_over_plane, light point (point)");
}

// Half of all pixels is more than there are shadows: kept, and worth nothing. A thousandth is less: worth something, and
// broken.
TEST(rules, judge_an_approximate_technique_by_its_promise) {
  const auto faults = [](const Verdict& verdict, std::string_view part) {
    return std::ranges::count_if(verdict.findings, [&](const Finding& f) { return f.what.find(part) != std::string::npos; });
  };
  const Verdict half = judge(rule("better_than_nothing"), entry<Fault::promises_half>(faulty::sampled()));
  EXPECT_EQ(half.kind, Kind::fails);
  EXPECT_EQ(faults(half, "it promises at most 50 %, which is no better than no shadows at all: "), 2) << findings(half);
  EXPECT_EQ(half.finding_count, 2u) << findings(half);
  const Verdict little = judge(rule("better_than_nothing"), entry<Fault::promises_little>(faulty::sampled()));
  EXPECT_EQ(faults(little, "; it promises at most 0.1 %"), static_cast<std::ptrdiff_t>(little.finding_count))
      << findings(little);
  EXPECT_EQ(little.finding_count, 8u) << findings(little);  // four scenes, two lights
}

TEST(support, tells_its_promise_in_the_reason) {
  const Support promised = Support::approximate("casters are balls", {.most_wrong = 0.25});
  EXPECT_EQ(promised.why(), "casters are balls; promises at most 25 % wrong");
  EXPECT_EQ(promised.most_wrong(), 0.25);
  EXPECT_EQ(Support::approximate("casters are balls").why(), "casters are balls");
  EXPECT_EQ(Support::approximate("casters are balls").most_wrong(), std::nullopt);
  EXPECT_EQ(Support::full().most_wrong(), std::nullopt);
  for (const double share : {-0.1, 1.1, std::nan("")})
    EXPECT_THROW(Support::approximate("never", {.most_wrong = share}), Error);
}

TEST(rules, find_what_is_not_left_alone) {
  expect_found("inputs", entry<Fault::writes_inputs>(), "scene or G-buffer were written to",
               "in box_city:count=12, light point (point)");
  expect_found("gl_state", entry<Fault::leaves_state>(faulty::drawing()), "after resolve: blend is on", "light point (point)");
  glDisable(GL_BLEND);
}

TEST(rules, tell_an_exception_with_its_place) {
  expect_found("change_of_view", entry<Fault::throws>(), "it threw: the tree has no root",
               "in box_city:count=12, light point (point)");
}

TEST(rules, are_not_asked_of_whom_they_are_not_for) {
  const Verdict verdict = judge(rule("gl_state"), entry<Fault::none>());
  EXPECT_EQ(verdict.kind, Kind::does_not_apply);
  EXPECT_EQ(verdict.why, "it does not draw");
  About baseline = faulty::sampled();
  baseline.role = Role::baseline;
  EXPECT_EQ(why_not_applied(rule("better_than_nothing"), baseline), "it is a baseline");
  EXPECT_EQ(why_not_applied(rule("exact"), faulty::sampled()), "it does not promise to be exact");
}

}  // namespace rules_test
