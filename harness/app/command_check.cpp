// gnomon check: whether a technique keeps the rules, each tested in a process of its own.
#include <gnomon/registry.h>

#include <chrono>

#include "app/app.h"
#include "app/table_options.h"
#include "measure/conformance/child.h"
#include "measure/progress.h"
#include "report/conformance.h"

namespace gnomon::app {

namespace {

struct CheckOptions {
  std::string technique;
  std::vector<std::string> rules;
  double timeout = 120;
  bool json = false;
  TableWidth width;
};

/// In the order of the list, whatever the order of the names; all where none is named. Throws Error on a name that is no
/// rule's.
std::vector<const conformance::Rule*> chosen_rules(const std::vector<std::string>& names) {
  for (const std::string& name : names) conformance::rule(name);
  std::vector<const conformance::Rule*> chosen;
  for (const conformance::Rule& rule : conformance::rules())
    if (names.empty() || std::ranges::find(names, rule.name) != names.end()) chosen.push_back(&rule);
  return chosen;
}

int check(const CheckOptions& options, const Program& program) {
  const TechniqueEntry& entry = registry().technique(options.technique);
  const std::vector<const conformance::Rule*> rules = chosen_rules(options.rules);
  std::vector<conformance::Judged> judged;
  bool has_failed = false;
  {
    Progress progress;
    progress.expect(static_cast<double>(rules.size()));
    for (const conformance::Rule* rule : rules) {
      progress.step(fmt::format("{}, rule {}", entry.id, rule->name));
      const auto start = std::chrono::steady_clock::now();
      conformance::Verdict verdict = conformance::judge_in_child(*rule, entry, worker_options(program, 0), options.timeout);
      has_failed = has_failed || verdict.kind == conformance::Verdict::Kind::fails;
      judged.push_back({*rule, std::move(verdict), advice_for(*rule, entry), seconds_since(start)});
      progress.advance(1);
    }
  }
  fmt::print("{}", options.json ? json_text(conformance::check_json(entry.id, judged), 2) + "\n"
                                : conformance::check_text(judged, options.width.columns()));
  return has_failed ? 1 : 0;
}

}  // namespace

void add_check(Program& program) {
  auto [command, options] =
      program.line.command<CheckOptions>("check", "Check a technique against the rules that every technique must keep",
                                         [&program](const CheckOptions& read) { return check(read, program); });
  command.option("technique", &options.technique, "Technique id", {.is_required = true});
  command.option("--rule", &options.rules, "Only these rules; `gnomon list rules` has them");
  command.option("--timeout", &options.timeout, "Seconds that one rule may take", {.check = seconds()});
  command.flag("--json", &options.json, "As JSON");
  add_width_options(command, options.width);
}

}  // namespace gnomon::app
