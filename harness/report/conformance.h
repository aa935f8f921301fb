#pragma once
#include <span>
#include <string>

#include "measure/conformance/rule.h"
#include "measure/json.h"

// Rules and verdicts for the terminal, for programs and as a page.
namespace gnomon::conformance {

/// What one rule said of a technique.
struct Judged {
  const Rule& rule;
  Verdict verdict;
  std::string_view advice;  ///< for the author of this technique
  double seconds = 0;
};

/// A line for each rule; below it, for each that fails, its sentence, what was found first, and what to do.
std::string check_text(std::span<const Judged> judged, std::size_t width = 0);
Json check_json(const std::string& technique, std::span<const Judged> judged);

std::string list_text(std::span<const Rule> rules, std::size_t width = 0);
Json list_json(std::span<const Rule> rules);

/// docs/conformance.md.
std::string rules_page();

}  // namespace gnomon::conformance
