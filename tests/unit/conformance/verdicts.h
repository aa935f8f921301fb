#pragma once
#include <gtest/gtest.h>

#include "measure/conformance/rule.h"

namespace gnomon::conformance {

/// What was found, one line each, with the places.
inline std::string findings(const Verdict& verdict) {
  std::string text;
  for (const Finding& finding : verdict.findings) text += fmt::format("{} | {}\n", finding.what, place_text(finding));
  return text;
}

/// The rule fails, and says so.
inline void expect_found(const Verdict& verdict, std::string_view says) {
  EXPECT_EQ(verdict.kind, Verdict::Kind::fails);
  EXPECT_NE(findings(verdict).find(says), std::string::npos) << says << "\n" << findings(verdict);
}

}  // namespace gnomon::conformance
