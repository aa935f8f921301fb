#include "analysis/tune_space.h"

#include <gnomon/registry.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "analysis/analysis.h"
#include "measure/run/suite.h"

namespace gnomon {

namespace {

constexpr std::size_t most_levels = 9;

template <class T>
std::vector<std::string> levels_of(const Number<T>& number, const Parameter& row) {
  const Range<T>& range = number.range();
  const double base = number_from(row.default_text()).value_or(range.min);
  std::vector<std::string> texts;
  for (const double level : tune_levels(range.min, range.max, base, std::is_integral_v<T>, range.log))
    texts.push_back(fmt::format("{}", static_cast<T>(level)));
  return texts;
}

bool is_number(const Parameter& row) {
  return dynamic_cast<const Number<int>*>(&typed(row)) || dynamic_cast<const Number<double>*>(&typed(row));
}

/// What `*` stands for.
std::vector<std::string> all_levels(const Parameter& row) {
  if (const auto* whole = dynamic_cast<const Number<int>*>(&typed(row))) return levels_of(*whole, row);
  if (const auto* number = dynamic_cast<const Number<double>*>(&typed(row))) return levels_of(*number, row);
  return row.probes();
}

/// Whether `ID:*` tunes it.
bool is_tuned(const Parameter& row) {
  const std::string_view name = row.name().substr(row.name().rfind('.') + 1);  // without the object's
  return name != "seed" && name != "noise_frame" && !name.starts_with("pick_") && !dynamic_cast<const ObjectParameter*>(&row);
}

std::string_view word_at(std::string_view text, std::size_t at) {
  return text.substr(at, text.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_", at) - at);
}

/// Words that open or end the sentence of a parameter that acts on nothing else.
struct Subject {
  std::string_view words;
  bool TuneMatter::*is_there;
  std::string_view lack;
};
constexpr Subject subjects[] = {
    {"Casters with holes: ", &TuneMatter::has_holes, "no mesh has holes"},
    {"Casters that let a part of the light through: ", &TuneMatter::has_glass, "no caster lets light through"},
    {"Where some casters move and others do not: ", &TuneMatter::has_motion, "nothing moves"},
    {"Where frames follow one another: ", &TuneMatter::has_motion, "no frame follows another"},
    {" The mask is the same.", &TuneMatter::has_costs, "no cost counts"},
    {" it never changes the answer.", &TuneMatter::has_costs, "no cost counts"}};

/// Why the parameter acts on nothing that there is; empty: it may act.
std::string_view lack_of(const Parameter& row, const TuneMatter& matter) {
  const std::string_view sentence = row.sentence();
  for (const Subject& subject : subjects)
    if (!(matter.*subject.is_there) && (sentence.starts_with(subject.words) || sentence.ends_with(subject.words)))
      return subject.lack;
  return {};
}

struct Condition {
  std::string controller;
  std::vector<std::string> values;
};

/// What a sentence says of when a parameter has an effect: "...; for filter=pcf and disc." Nothing where it names no choice of
/// the technique, or says more than these words.
std::optional<Condition> condition_of(const Parameter& row, const Technique& technique) {
  const std::string_view sentence = row.sentence();
  for (const std::string_view lead : {"; for ", ", for "}) {
    std::size_t at = sentence.find(lead);
    if (at == sentence.npos) continue;
    at += lead.size();
    const std::string_view controller = word_at(sentence, at);
    at += controller.size();
    if (controller.empty() || at >= sentence.size() || sentence[at] != '=') continue;
    const std::string full = std::string(row.name().substr(0, row.name().rfind('.') + 1)).append(controller);
    const std::vector<Parameter*> rows = technique.parameters();
    const auto found = std::ranges::find(rows, full, &Parameter::name);
    if (found == rows.end() || is_number(**found)) continue;
    Condition condition{full, {}};
    const std::vector<std::string> choices = (*found)->probes();
    for (std::size_t gap = 1; gap > 0;) {
      const std::string_view value = word_at(sentence, at += gap);
      if (std::ranges::find(choices, value) == choices.end()) return std::nullopt;
      condition.values.emplace_back(value);
      at += value.size();
      gap = sentence.substr(at).starts_with(" and ") ? 5 : sentence.substr(at).starts_with(", ") ? 2 : 0;
    }
    return condition;
  }
  return std::nullopt;
}

/// Reads the items of a text into a space.
class Reader {
 public:
  Reader(const std::string& text, const TuneMatter& matter) : text_(text), matter_(matter) {
    refuse_several_techniques(text);
    const std::size_t colon = text.find(':');
    space_.technique = text.substr(0, colon);
    technique_ = registry().technique(space_.technique).make();
    read_items(colon == text.npos ? "*" : text.substr(colon + 1));
  }

  TuneSpace space() {
    technique_->apply(joined(fixed_, ","));
    space_.fixed = joined(fixed_, ",");
    for (const auto& [name, value] : swept_) technique_->parameter(name);  // Throws Error on a name that is none
    for (const Parameter* row : technique_->parameters()) add(*row);
    return std::move(space_);
  }

 private:
  void read_items(const std::string& settings) {
    std::set<std::string> names;
    for (const std::string& item : parts_outside_braces(settings)) {
      if (item == "*") {
        takes_all_ = true;
        continue;
      }
      const std::size_t equals = item.find('=');
      if (equals == item.npos) throw Error("{}: '{}' is neither * nor parameter=value", text_, item);
      const std::string name = item.substr(0, equals), value = item.substr(equals + 1);
      if (!names.insert(name).second) throw Error("{}: {} is given twice", text_, name);
      if (value == "*" || value.starts_with('{'))
        swept_.emplace_back(name, value);
      else
        fixed_.push_back(item);
    }
  }

  /// The values of `{a,b}` as the technique writes them, numbers rising. Throws Error on one out of range.
  std::vector<std::string> listed(const Parameter& row, const std::string& braces) {
    if (!braces.ends_with('}')) throw Error("{}: '{}' opens a brace that it does not close", text_, braces);
    std::vector<std::string> values;
    const std::string before = row.text();
    Parameter& changed = technique_->parameter(row.name());
    for (const std::string& value : parts_outside_braces(std::string_view(braces).substr(1, braces.size() - 2))) {
      changed.set(value);
      if (std::ranges::find(values, changed.text()) == values.end()) values.push_back(changed.text());
    }
    changed.set(before);
    if (is_number(row)) std::ranges::sort(values, {}, [](const std::string& text) { return number_from(text); });
    return values;
  }

  bool is_fixed(const std::string& name) const {
    return std::ranges::any_of(fixed_, [&](const std::string& item) { return item.starts_with(name + "="); });
  }

  /// Whether it is asked for, whatever it acts on.
  bool is_asked(const Parameter& row) const {
    const std::string name(row.name());
    const bool is_named = std::ranges::find(swept_, name, &std::pair<std::string, std::string>::first) != swept_.end();
    return is_named || (takes_all_ && !is_fixed(name) && is_tuned(row));
  }

  bool varies(const Parameter& row) const { return is_asked(row) && lack_of(row, matter_).empty(); }

  /// Adds the parameter where it varies.
  void add(const Parameter& row) {
    const std::string name(row.name());
    const auto given = std::ranges::find(swept_, name, &std::pair<std::string, std::string>::first);
    if (!is_asked(row)) {
      if (takes_all_ && !is_fixed(name)) space_.left_out.push_back(name);
      return;
    }
    TuneSpace::Parameter parameter{
        name, given != swept_.end() && given->second != "*" ? listed(row, given->second) : all_levels(row), row.default_text()};
    if (parameter.values.size() < 2) {  // a list of one value
      technique_->parameter(name).set(parameter.values.front());
      fixed_.push_back(fmt::format("{}={}", name, parameter.values.front()));
      space_.fixed = joined(fixed_, ",");
      return;
    }
    if (const std::string_view lack = lack_of(row, matter_); !lack.empty()) {
      space_.skipped.push_back(fmt::format("{} ({})", name, lack));
      return;
    }
    TuneGrid::Parameter grid{.levels = parameter.values.size(), .is_ordered = is_number(row)};
    const auto base = std::ranges::find(parameter.values, parameter.base);
    if (base != parameter.values.end()) grid.base = static_cast<std::size_t>(base - parameter.values.begin());
    if (const auto condition = condition_of(row, *technique_); condition && !put(*condition, parameter, grid)) {
      space_.skipped.push_back(fmt::format("{} (for {})", name, parameter.condition));
      return;
    }
    space_.parameters.push_back(std::move(parameter));
    space_.grid.parameters.push_back(std::move(grid));
  }

  /// Whose condition is a parameter that varies has it as its controller. False where one that does not vary refuses it.
  bool put(const Condition& condition, TuneSpace::Parameter& parameter, TuneGrid::Parameter& grid) {
    parameter.condition = fmt::format("{}={}", condition.controller, joined(condition.values, ","));
    const auto of = std::ranges::find(space_.parameters, condition.controller, &TuneSpace::Parameter::name);
    if (of == space_.parameters.end()) {
      const Parameter& controller = technique_->parameter(condition.controller);
      const bool holds = std::ranges::find(condition.values, controller.text()) != condition.values.end();
      return holds || varies(controller);  // one that varies comes later
    }
    grid.controller = static_cast<std::size_t>(of - space_.parameters.begin());
    for (std::size_t level = 0; level < of->values.size(); ++level)
      if (std::ranges::find(condition.values, of->values[level]) != condition.values.end())
        grid.controller_levels.push_back(level);
    return true;
  }

  const std::string& text_;
  const TuneMatter& matter_;
  std::unique_ptr<Technique> technique_;
  bool takes_all_ = false;
  std::vector<std::pair<std::string, std::string>> swept_;
  std::vector<std::string> fixed_;
  TuneSpace space_;
};

/// A whole number of octaves has a level for each, where these are few enough.
std::vector<double> equal_ratios(double least, double most) {
  const double octaves = std::log2(most / least);
  const bool is_binary = octaves == std::round(octaves) && octaves + 1 <= most_levels;
  const std::size_t steps = is_binary ? static_cast<std::size_t>(octaves) : most_levels - 1;
  std::vector<double> levels;
  for (std::size_t k = 0; k <= steps; ++k)
    levels.push_back(least * std::pow(most / least, static_cast<double>(k) / static_cast<double>(steps)));
  return levels;
}

}  // namespace

std::vector<double> tune_levels(double least, double most, double base, bool is_whole, bool is_log) {
  std::set<double> levels;
  // Whole, or of three digits: short to write.
  const auto add = [&](double value) {
    const double brief = is_whole ? std::round(value) : number_from(fmt::format("{:.3g}", value)).value_or(value);
    levels.insert(std::clamp(brief, least, most));
  };
  if (is_whole && most - least < most_levels) {
    for (double value = least; value <= most; ++value) add(value);
  } else if (is_log && least > 0) {
    std::ranges::for_each(equal_ratios(least, most), add);
  } else if (base > least && base - least <= (most - least) / 8) {
    add(least);
    for (double far = (base - least) / 4; levels.size() < most_levels && least + far <= most; far *= 2) add(least + far);
  } else {
    for (std::size_t k = 0; k < most_levels; ++k) add(least + (most - least) * static_cast<double>(k) / (most_levels - 1));
  }
  if (!levels.contains(base)) {  // in the place of the level nearest to it, unless that is an end
    const auto distance = [&](double level) { return std::abs(level - base); };
    const double nearest = *std::ranges::min_element(levels, {}, distance);
    if (nearest != *levels.begin() && nearest != *levels.rbegin()) levels.erase(nearest);
    levels.insert(base);
  }
  return {levels.begin(), levels.end()};
}

namespace {

std::string applied(const std::string& technique, const std::string& settings) {
  const std::unique_ptr<Technique> made = registry().technique(technique).make();
  made->apply(settings);
  return made->settings();
}

}  // namespace

std::string TuneSpace::defaults() const { return applied(technique, fixed); }

std::string TuneSpace::settings(const TuneSetting& setting) const {
  std::string text = fixed;
  for (std::size_t k = 0; k < parameters.size(); ++k)
    if (grid.has_effect(k, setting))
      text += fmt::format("{}{}={}", text.empty() ? "" : ",", parameters[k].name, parameters[k].values[setting[k]]);
  return applied(technique, text);
}

std::string TuneSpace::name(const TuneSetting& setting) const {
  const std::string text = settings(setting);
  return text.empty() ? technique : technique + ":" + text;
}

TuneSpace tune_space(const std::string& text, const TuneMatter& matter) { return Reader(text, matter).space(); }

void put_by_stages(const TuneSpace& space, std::vector<TuneQuestion>& questions) {
  const std::unique_ptr<Technique> technique = registry().technique(space.technique).make();
  technique->apply(space.fixed);
  std::vector<std::size_t> early_first(space.parameters.size());
  std::iota(early_first.begin(), early_first.end(), std::size_t{0});
  std::ranges::stable_sort(early_first, {},
                           [&](std::size_t k) { return technique->parameter(space.parameters[k].name).spoils(); });
  const auto early_levels_first = [&](const TuneQuestion& question) {
    TuneSetting levels;
    for (const std::size_t k : early_first) levels.push_back(question.setting[k]);
    return levels;
  };
  for (auto begin = questions.begin(); begin != questions.end();) {
    const auto end = std::find_if(begin, questions.end(), [&](const TuneQuestion& one) { return one.place != begin->place; });
    std::ranges::stable_sort(begin, end, {}, early_levels_first);
    begin = end;
  }
}

}  // namespace gnomon
