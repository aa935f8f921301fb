// The rules about sequences of frames find what a technique remembers that it must not, and hold of one that does it right.
#include <gnomon/kit/shared.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "faulty.h"
#include "measure/conformance/rule.h"
#include "verdicts.h"

namespace sequence_rules_test {

using namespace gnomon;
using namespace gnomon::conformance;
using Kind = Verdict::Kind;

enum class Fault {
  none,
  keeps_history,    ///< forget does nothing
  keeps_number,     ///< forget leaves the number of the frame, and with it the noise
  counts_together,  ///< the number of the frame is that of all objects
  shares_history,   ///< objects that share what build makes share the history
  drifts,           ///< the noise becomes larger
  grows,            ///< it keeps all frames
  loses_part,       ///< one error term is half of what it is
  names_other,      ///< explain names the smaller term
  has_no_such,      ///< a term is of no cause of its own
  is_short,         ///< a term has one value
  learns,           ///< error_terms changes the history
};

constexpr OwnCause own_causes[] = {{"noise", "Noise is left.", {10, 20, 200}}, {"stale", "History is stale.", {200, 20, 10}}};

/// Up to one half.
float noise(std::uint32_t number, std::size_t pixel) {
  std::uint32_t x = (number * 0x9e3779b9u) ^ (static_cast<std::uint32_t>(pixel) * 0x85ebca6bu);
  x = (x ^ (x >> 15)) * 0x2c1b3c6du;
  x = (x ^ (x >> 12)) * 0x297a2d39u;
  return 0.5f * static_cast<float>((x ^ (x >> 15)) >> 8) * 0x1p-24f;
}

/// Shadow rays with noise, averaged over eight frames.
template <Fault fault>
class Remembering final : public Technique {
 public:
  Support supports(const Scene&, const Light& light, const View&) const override {
    return hard_lights_only(light, "it has no penumbra");
  }
  void setup() override {}
  void build(const Scene& scene) override {
    made_->scene = &scene;
    made_->casters.emplace(scene, Truth::mesh, RayScene::Which::casters);
  }
  void relight(const Light& light) override { light_ = light; }
  void forget() override {
    if (fault == Fault::keeps_history) return;
    const std::uint32_t number = memory().number;
    memory() = {};
    if (fault == Fault::keeps_number) memory().number = number;
  }
  void resolve(const GBuffer& gbuffer, VisibilityMask& mask) override {
    Memory& m = memory();
    if (m.mean.size() != gbuffer.size()) {
      m.length = 0;
      m.mean.assign(gbuffer.size(), 0);
    }
    const std::uint32_t number = fault == Fault::counts_together ? number_of_all_++ : m.number;
    ++m.number;
    m.length = std::min(m.length + 1, 8);
    out_.assign(gbuffer.size(), 1);
    trace_shadows(*made_->casters, *made_->scene, gbuffer, light_, out_);
    const float scale = fault == Fault::drifts ? 0.2f + 0.0125f * static_cast<float>(std::min(number, 64u)) : 1;
    for (std::size_t i = 0; i < out_.size(); ++i) {
      if (!faces_light(*made_->scene, gbuffer, light_, i)) continue;
      const float fresh = std::abs(out_[i] - scale * noise(number, i));
      m.mean[i] += (fresh - m.mean[i]) / static_cast<float>(m.length);
      out_[i] = std::clamp(m.mean[i], 0.0f, 1.0f);
    }
    std::ranges::copy(out_, mask.pixels().begin());
    terms_.clear();
  }
  Counts counts() const override {
    const double frames = fault == Fault::grows ? memory().number : 1;
    const double held = frames * 4 * static_cast<double>(memory().mean.size());
    return {{.name = "bytes", .value = held + made_.own(static_cast<double>(made_->casters->bytes())), .unit = "byte"}};
  }
  std::unique_ptr<Technique> for_another_light() const override { return another(*this, &Remembering::made_); }
  std::vector<ErrorTerm> error_terms(std::span<const float> exact) override {
    Memory& m = memory();
    if (m.length == 1 || m.twin.size() != out_.size()) m.twin.assign(out_.size(), 0);
    terms_ = {{fault == Fault::has_no_such ? "weather" : "noise", {}}, {"stale", {}}};
    for (std::size_t i = 0; i < out_.size(); ++i) {
      m.twin[i] += (exact[i] - m.twin[i]) / static_cast<float>(m.length);
      terms_[0].values.push_back((out_[i] - m.twin[i]) * (fault == Fault::loses_part ? 0.5f : 1.0f));
      terms_[1].values.push_back(m.twin[i] - exact[i]);
    }
    if (fault == Fault::is_short) terms_[1].values.resize(1);
    if (fault == Fault::learns)
      for (float& value : m.mean) value = 0.5f * value + 0.25f;
    return terms_;
  }
  std::optional<Explanation> explain(std::size_t index) const override {
    Explanation why;
    if (terms_.empty()) return why;
    const float first = terms_[0].values[index], second = terms_[1].values[index];
    const bool is_first = first + second > 0 ? first > second : first < second;
    why.cause = terms_[is_first == (fault != Fault::names_other) ? 0 : 1].cause;
    return why;
  }

 private:
  struct Memory {
    std::vector<float> mean, twin;
    int length = 0;
    std::uint32_t number = 0;
  };
  struct Made {
    const Scene* scene = nullptr;
    std::optional<RayScene> casters;
    Memory memory;
  };
  Memory& memory() { return fault == Fault::shares_history ? made_->memory : own_; }
  const Memory& memory() const { return fault == Fault::shares_history ? made_->memory : own_; }

  static inline std::uint32_t number_of_all_ = 0;
  Shared<Made> made_;
  Memory own_;
  Light light_;
  std::vector<float> out_;
  std::vector<ErrorTerm> terms_;
};

template <Fault fault>
Verdict verdict_of(std::string_view name, bool remembers = true) {
  TechniqueEntry entry;
  entry.id = "remembering";
  entry.about = faulty::sampled();
  entry.about.causes = own_causes;
  entry.about.remembers = remembers;
  entry.make = [] { return made<Technique, Remembering<fault>>("remembering"); };
  return judge(rule(name), entry);
}

TEST(sequence_rules, hold_of_a_technique_that_remembers_as_it_may) {
  for (const Rule& rule : rules()) {
    if (rule.applies_to != AppliesTo::remembering || (is_sanitized && rule.sanitized == Sanitized::nothing)) continue;
    const Verdict verdict = verdict_of<Fault::none>(rule.name);
    EXPECT_EQ(verdict.kind, Kind::holds) << rule.name << ": " << verdict.why << findings(verdict);
  }
}

// The first frame after forget is what these compare.
TEST(sequence_rules, leave_all_other_rules_to_cold_answers) {
  for (const char* const name : {"same_mask", "change_of_light", "change_of_view", "counts_of_now", "further_lights",
                                 "update_equals_build", "explanations"}) {
    const Verdict verdict = verdict_of<Fault::none>(name);
    EXPECT_EQ(verdict.kind, Kind::holds) << name << ": " << verdict.why << findings(verdict);
  }
  EXPECT_EQ(verdict_of<Fault::none>("same_mask", false).kind, Kind::fails);
}

TEST(sequence_rules, apply_to_techniques_that_remember_or_do_not) {
  for (const Rule& rule : rules()) {
    if (rule.applies_to == AppliesTo::remembering) {
      EXPECT_EQ(verdict_of<Fault::none>(rule.name, false).why, "it does not remember frames") << rule.name;
    }
  }
  EXPECT_EQ(verdict_of<Fault::none>("no_memory_undeclared").why, "it remembers frames");
  EXPECT_EQ(judge(rule("no_memory_undeclared"), faulty::entry<faulty::Fault::none>()).kind, Kind::holds);
  EXPECT_EQ(judge(rule("no_memory_undeclared"), faulty::entry<faulty::Fault::refuses_all>()).why,
            "it supports no light of the scenes that move");
}

TEST(forget_begins_anew, finds_what_forget_leaves) {
  expect_found(verdict_of<Fault::keeps_history>("forget_begins_anew"), "frame 0 after forget, and of a fresh object: ");
  expect_found(verdict_of<Fault::keeps_number>("forget_begins_anew"), "frame 0 after forget, and of a fresh object: ");
  expect_found(verdict_of<Fault::keeps_number>("forget_begins_anew"), "in moving_things, light point (point), pixel ");
}

TEST(frames_before_decide, finds_what_comes_from_other_sequences) {
  expect_found(verdict_of<Fault::counts_together>("frames_before_decide"),
               "frame 0 of two sequences that are equal up to frame 2");
  expect_found(verdict_of<Fault::counts_together>("frames_before_decide"), ", alone and beside another sequence: ");
  expect_found(verdict_of<Fault::shares_history>("frames_before_decide"),
               "of an object that shares with another one, and of a whole one: ");
}

TEST(still_frames_settle, finds_an_error_that_grows) {
  if (is_sanitized) GTEST_SKIP() << "the rule is not checked there";
  expect_found(verdict_of<Fault::drifts>("still_frames_settle"), "% in the last; at most 1.05 times as much may be");
}

TEST(bytes_of_frames, finds_memory_that_grows) {
  const Verdict verdict = verdict_of<Fault::grows>("bytes_of_frames");
  expect_found(verdict, " bytes after frame 2 and ");
  expect_found(verdict, " after frame 12, which shows the same");
}

TEST(error_terms_add_up, finds_terms_that_are_none) {
  expect_found(verdict_of<Fault::loses_part>("error_terms_add_up"), "frame 0: its error terms add up to ");
  expect_found(verdict_of<Fault::names_other>("error_terms_add_up"), "explain names 'stale', whose error term is ");
  expect_found(verdict_of<Fault::has_no_such>("error_terms_add_up"), "an error term is of 'weather', which is no cause of ");
  expect_found(verdict_of<Fault::is_short>("error_terms_add_up"), "the error term stale has 1 values for ");
  expect_found(verdict_of<Fault::learns>("error_terms_add_up"),
               "with error_terms and explain called in each frame and without: ");
}

TEST(error_terms_add_up, does_not_apply_where_there_are_none) {
  TechniqueEntry silent = faulty::entry<faulty::Fault::none>();
  silent.about.remembers = true;
  EXPECT_EQ(judge(rule("error_terms_add_up"), silent).why, "it gives no error terms");
}

/// Shadow rays. Under a light of the kind and in the view of the frame before, which has moved, half of each answer is that of
/// the frame before.
class Reuses final : public Technique {
 public:
  Support supports(const Scene&, const Light& light, const View&) const override {
    return hard_lights_only(light, "it has no penumbra");
  }
  void setup() override {}
  void build(const Scene& scene) override {
    scene_ = &scene;
    casters_.emplace(scene, Truth::mesh, RayScene::Which::casters);
    before_.clear();
  }
  void relight(const Light& light) override {
    const auto place = [](const Light& l) { return homogeneous(l); };
    is_near_ = light_ && light_->kind.index() == light.kind.index() && place(*light_) != place(light);
    light_ = light;
  }
  void resolve(const GBuffer& gbuffer, VisibilityMask& mask) override {
    std::vector<float> answer(gbuffer.size(), 1);
    trace_shadows(*casters_, *scene_, gbuffer, *light_, answer);
    if (is_near_ && before_.size() == answer.size())
      for (std::size_t i = 0; i < answer.size(); ++i)
        if (faces_light(*scene_, gbuffer, *light_, i)) answer[i] = (answer[i] + before_[i]) / 2;
    std::ranges::copy(answer, mask.pixels().begin());
    before_ = answer;
  }
  Counts counts() const override { return {{"bytes", static_cast<double>(casters_->bytes() + 4 * before_.size()), "byte"}}; }

 private:
  const Scene* scene_ = nullptr;
  std::optional<RayScene> casters_;
  std::optional<Light> light_;
  std::vector<float> before_;
  bool is_near_ = false;
};

TEST(no_memory_undeclared, finds_what_is_kept_while_a_light_is_near_where_other_rules_do_not) {
  TechniqueEntry entry = faulty::entry<faulty::Fault::none>();
  entry.make = [] { return made<Technique, Reuses>("reuses"); };
  for (const char* const name : {"same_mask", "change_of_light", "change_of_view"}) {
    const Verdict verdict = judge(rule(name), entry);
    EXPECT_EQ(verdict.kind, Kind::holds) << name << ": " << findings(verdict);
  }
  expect_found(judge(rule("no_memory_undeclared"), entry), " of a sequence, and alone: ");
}

}  // namespace sequence_rules_test
