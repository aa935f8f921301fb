// Every rule of conformance for every technique that it is for: a test `technique.RULE/ID` each.
#include <gtest/gtest.h>

#include <algorithm>

#include "measure/conformance/rule.h"

namespace {

using namespace gnomon;
using namespace gnomon::conformance;

class Holds final : public testing::Test {
 public:
  Holds(const Rule& rule, const TechniqueEntry& entry) : rule_(rule), entry_(entry) {}

 private:
  void TestBody() override {
    const Verdict verdict = judge(rule_, entry_);
    for (const Finding& finding : verdict.findings) ADD_FAILURE() << finding.what << '\n' << place_text(finding);
    if (verdict.kind == Verdict::Kind::fails)
      ADD_FAILURE() << verdict.finding_count << " findings. " << rule_.sentence << ' ' << advice_for(rule_, entry_);
    if (verdict.kind == Verdict::Kind::does_not_apply) GTEST_SKIP() << verdict.why;
  }

  const Rule& rule_;
  const TechniqueEntry& entry_;
};

TEST(registered, exactly_one_technique_is_the_reference) {
  EXPECT_EQ(std::ranges::count(registry().techniques(), Role::reference, [](const auto& e) { return e.about.role; }), 1);
}

}  // namespace

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  for (const Rule& rule : rules()) {
    if (is_sanitized && rule.sanitized == Sanitized::nothing) continue;
    for (const TechniqueEntry& entry : registry().techniques())
      if (why_not_applied(rule, entry.about).empty())
        testing::RegisterTest("technique", fmt::format("{}/{}", rule.name, entry.id).c_str(), nullptr, nullptr, __FILE__,
                              __LINE__, [&]() -> testing::Test* { return new Holds(rule, entry); });
  }
  return RUN_ALL_TESTS();
}
