#include "report/conformance.h"

#include <algorithm>

#include "measure/conformance/child.h"
#include "measure/counted.h"
#include "report/pages.h"
#include "report/table/layout.h"
#include "report/table/text_table.h"

namespace gnomon::conformance {

namespace {

constexpr std::size_t most_shown = 5;

std::size_t count_of(std::span<const Judged> judged, Verdict::Kind kind) {
  return static_cast<std::size_t>(std::ranges::count(judged, kind, [](const Judged& j) { return j.verdict.kind; }));
}

std::string verdict_text(const Verdict& verdict) {
  const std::string kind(name(verdict.kind));
  if (verdict.kind == Verdict::Kind::does_not_apply) return kind + ": " + verdict.why;
  if (verdict.kind == Verdict::Kind::fails) return fmt::format("{}: {}", kind, counted(verdict.finding_count, "finding{s}"));
  return kind;
}

/// Lines of at most `width` columns, the first after `first`, the others indented as far.
std::string paragraph(std::string_view first, std::string_view text, std::size_t width) {
  const std::string indent(first.size(), ' ');
  std::string result;
  for (const std::string& line : wrap(text, std::max<std::size_t>(40, width) - first.size()))
    result += fmt::format("{}{}\n", result.empty() ? std::string(first) : indent, line);
  return result;
}

std::string failure_text(const Judged& judged, std::size_t width) {
  std::string text = fmt::format("\n{}\n", judged.rule.name);
  text += paragraph("  must:  ", judged.rule.sentence, width);
  for (std::size_t k = 0; k < std::min(most_shown, judged.verdict.findings.size()); ++k) {
    const Finding& finding = judged.verdict.findings[k];
    const std::string where = place_text(finding);
    text += paragraph(k == 0 ? "  found: " : "         ",
                      where.empty() ? finding.what : fmt::format("{}; {}", finding.what, where), width);
  }
  if (judged.verdict.finding_count > most_shown)
    text += fmt::format("         and {} more\n", judged.verdict.finding_count - most_shown);
  return text + paragraph("  do:    ", judged.advice, width);
}

}  // namespace

std::string check_text(std::span<const Judged> judged, std::size_t width) {
  TextTable table({{"rule", ""}, {"verdict", ""}});
  for (const Judged& j : judged) table.add_row({std::string(j.rule.name), verdict_text(j.verdict)});
  std::string text = table.text(width);
  for (const Judged& j : judged)
    if (j.verdict.kind == Verdict::Kind::fails) text += failure_text(j, width == 0 ? 120 : width);
  return text + fmt::format("\n{}: {} hold, {} do not apply, {} fail\n", counted(judged.size(), "rule{s}"),
                            count_of(judged, Verdict::Kind::holds), count_of(judged, Verdict::Kind::does_not_apply),
                            count_of(judged, Verdict::Kind::fails));
}

Json check_json(const std::string& technique, std::span<const Judged> judged) {
  Json list = Json::array();
  for (const Judged& j : judged) {
    Json rule = json_object({{"name", j.rule.name}});
    rule.update(verdict_json(j.verdict));
    rule["sentence"] = j.rule.sentence;
    rule["advice"] = j.advice;
    rule["seconds"] = j.seconds;
    list.push_back(std::move(rule));
  }
  return json_object({{"technique", technique},
                      {"holds", count_of(judged, Verdict::Kind::holds)},
                      {"does_not_apply", count_of(judged, Verdict::Kind::does_not_apply)},
                      {"fails", count_of(judged, Verdict::Kind::fails)},
                      {"rules", std::move(list)}});
}

std::string list_text(std::span<const Rule> rules, std::size_t width) {
  TextTable table({{"rule", ""}, {"applies to", ""}, {"what a technique must do", ""}});
  for (const Rule& rule : rules)
    table.add_row({std::string(rule.name), std::string(name(rule.applies_to)), std::string(rule.sentence)});
  return table.text(width);
}

Json list_json(std::span<const Rule> rules) {
  Json list = Json::array();
  for (const Rule& rule : rules)
    list.push_back(json_object({{"name", rule.name},
                                {"asked_of", name(rule.applies_to)},
                                {"sentence", rule.sentence},
                                {"advice", rule.advice},
                                {"program_advice", rule.program_advice.empty() ? rule.advice : rule.program_advice}}));
  return list;
}

std::string rules_page() {
  std::string page = generated_header("harness/measure/conformance/rules_*.cpp");
  page += "# Conformance\n\n";
  page += fmt::format(
      R"(What every technique must do, wherever it lives: {} rules. `gnomon check ID` tests a technique by all of them, each in a
process of its own, so that a crash or a hang costs one rule. `gnomon --plugin ./mine.so check ID` tests one of a plugin.
`--rule NAME` chooses rules, `--timeout S` gives each so many seconds, `--json` is for programs. The exit status is 0 when all
rules hold that apply, 1 when one fails. `ctest -L conformance` tests every technique of this tree by every rule.

Scenes and lights are small and always the same. A finding names scene, light, settings and the first pixel, counted from the
upper left, with the size of its picture.

)",
      rules().size());
  page += "| rule | applies to | what a technique must do |\n| --- | --- | --- |\n";
  for (const Rule& rule : rules())
    page += fmt::format("| [{0}](#{0}) | {1} | {2} |\n", rule.name, name(rule.applies_to), markdown_text(rule.sentence));
  page += "\n## When a rule fails\n";
  for (const Rule& rule : rules()) {
    page += fmt::format("\n### {}\n\n{}\n", rule.name, markdown_text(rule.advice));
    if (!rule.program_advice.empty()) page += fmt::format("\nIn a program: {}\n", markdown_text(rule.program_advice));
  }
  return page;
}

}  // namespace gnomon::conformance
