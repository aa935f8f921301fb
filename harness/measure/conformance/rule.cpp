#include "measure/conformance/rule.h"

#include <algorithm>
#include <new>

#include "device/context.h"
#include "measure/conformance/trial.h"
#include "measure/program/description.h"

namespace gnomon::conformance {

std::string place_text(const Finding& finding) {
  std::vector<std::string> parts;
  if (!finding.place.scene.empty()) parts.push_back("in " + finding.place.scene);
  if (!finding.place.light.empty()) parts.push_back("light " + finding.place.light);
  if (!finding.place.settings.empty()) parts.push_back("with " + finding.place.settings);
  if (const auto& p = finding.pixel) parts.push_back(fmt::format("pixel {}, {} of {} x {}", p->x, p->y, p->width, p->height));
  return joined(parts);
}

std::string_view name(Verdict::Kind kind) {
  return kind == Verdict::Kind::holds ? "holds" : kind == Verdict::Kind::fails ? "fails" : "does not apply";
}

std::string_view name(AppliesTo applies_to) {
  static constexpr std::string_view names[] = {"every technique",
                                               "techniques that draw with OpenGL",
                                               "techniques that promise to be exact",
                                               "sampled techniques, without baselines",
                                               "techniques that remember frames",
                                               "techniques that do not remember frames"};
  return names[static_cast<int>(applies_to)];
}

std::span<const Rule> rules() {
  static const std::vector<Rule> all = [] {
    std::vector<Rule> rules;
    for (auto* of_file :
         {about_rules, answer_rules, promise_rules, cause_rules, life_rules, light_rules, neighbor_rules, limit_rules,
          scale_rules, memory_rules, motion_rules, combined_rules, sequence_rules, sequence_error_rules})
      std::ranges::copy(of_file(), std::back_inserter(rules));
    return rules;
  }();
  return all;
}

const Rule& rule(std::string_view name) {
  std::vector<std::string> names;
  for (const Rule& rule : rules()) {
    if (rule.name == name) return rule;
    names.emplace_back(rule.name);
  }
  throw Error("there is no rule {}; did you mean {}? There are: {}", name, nearest_word(name, names), joined(names));
}

std::string_view why_not_applied(const Rule& rule, const About& about) {
  const bool is_exact = about.promise == Promise::exact, is_of_sampled = rule.applies_to == AppliesTo::sampled;
  if (rule.applies_to == AppliesTo::drawing && !draws(about)) return "it does not draw";
  if (rule.applies_to == AppliesTo::drawing && about.device != Device::opengl) return "it does not draw with OpenGL";
  if (rule.applies_to == AppliesTo::exact && !is_exact) return "it does not promise to be exact";
  if (rule.applies_to == AppliesTo::remembering && !about.remembers) return "it does not remember frames";
  if (rule.applies_to == AppliesTo::not_remembering && about.remembers) return "it remembers frames";
  if (is_of_sampled && is_exact) return "it promises to be exact";
  return is_of_sampled && about.role == Role::baseline ? "it is a baseline" : "";
}

std::string_view advice_for(const Rule& rule, const TechniqueEntry& entry) {
  return is_program(entry) && !rule.program_advice.empty() ? rule.program_advice : rule.advice;
}

Verdict judge(const Rule& rule, const TechniqueEntry& entry, const std::function<void(const Place&)>& moves) {
  if (const std::string_view why = why_not_applied(rule, entry.about); !why.empty())
    return {.kind = Verdict::Kind::does_not_apply, .why = std::string(why)};
  Trial trial(rule, entry, moves);
  if (std::string why = trial.device().missing(); !why.empty())
    return {.kind = Verdict::Kind::does_not_apply, .why = std::move(why)};
  try {
    rule.check(trial);
  } catch (const CannotAsk&) {
    throw;
  } catch (const std::bad_alloc&) {
    trial.found("it ran out of memory");
  } catch (const std::exception& error) {
    trial.found(fmt::format("it threw: {}", error.what()));
  } catch (...) {
    trial.found("it threw what is no std::exception");
  }
  return trial.verdict();
}

}  // namespace gnomon::conformance
