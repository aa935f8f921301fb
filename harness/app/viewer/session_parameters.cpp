// Which parameter the keys change, and what scripts set.
#include <algorithm>
#include <cmath>
#include <iterator>

#include "app/viewer/parameter_steps.h"
#include "app/viewer/session.h"

namespace gnomon::viewer {

namespace {

constexpr std::string_view scene_prefix = "scene.";

std::string side_prefix(int side) { return std::string(side_name(side)) + "."; }

/// Whether a key changes which parameters there are, or one of them.
bool concerns_parameters(const KeyEffect& effect) {
  constexpr Action which[] = {Action::technique_before, Action::technique_after, Action::swap_sides};
  return std::holds_alternative<SceneSetting>(effect) || std::holds_alternative<ParameterSteps>(effect) ||
         std::ranges::any_of(which, [&](Action action) { return effect == KeyEffect(action); });
}

}  // namespace

std::vector<std::string> Session::parameter_names() const {
  std::vector<std::string> names;
  const auto add = [&](const std::string& prefix, const Parametrized& object) {
    for (const Parameter* const row : object.parameters()) names.push_back(prefix + std::string(row->name()));
  };
  for (int side = 0; side < 2; ++side) add(side_prefix(side), technique(side));
  if (generator_) add(std::string(scene_prefix), *generator_);
  return names;
}

Parameter& Session::parameter(const std::string& name) const {
  for (int side = 0; side < 2; ++side)
    if (name.starts_with(side_prefix(side))) return technique(side).parameter(name.substr(side_prefix(side).size()));
  if (!name.starts_with(scene_prefix))
    throw Error("there is no parameter {}; names begin with left., right. or {}", name, scene_prefix);
  if (!generator_) throw Error("there is no parameter {}: scene {} is a file", name, scene_id(selection_.scene));
  return generator_->parameter(name.substr(scene_prefix.size()));
}

void Session::set_parameter(const ParameterSetting& to) {
  parameter(to.name).set(to.value);
  for (int side = 0; side < 2; ++side)
    if (to.name.starts_with(side_prefix(side))) return technique_changed(side);
  generator_changed();
}

void Session::step_parameters(const ParameterSteps& steps, double count) {
  const std::vector<std::string> names = parameter_names();
  if (names.empty()) return say("neither sides nor scene have parameters", true);
  const auto all = std::ssize(names);
  const auto found = std::ranges::find(names, chosen_parameter_) - names.begin();
  // The first press shows which parameter it is; what was chosen may have gone with its technique.
  if (steps.rows != 0 || found == all) {
    const auto next = found == all ? (steps.rows < 0 ? all - 1 : 0) : (found + steps.rows + all) % all;
    chosen_parameter_ = names[static_cast<std::size_t>(next)];
    value_rest_ = 0;
  } else {
    // A key that is held makes parts of a step. A whole one is a key that was pressed.
    const double wanted = count * steps.values;
    value_rest_ = std::abs(wanted) >= 1 ? wanted : value_rest_ + wanted;
    const int whole = static_cast<int>(std::trunc(value_rest_));
    value_rest_ -= whole;
    if (whole == 0) return;
    const std::string value = value_after(parameter(chosen_parameter_), whole);
    if (value == parameter(chosen_parameter_).text()) return;
    set_parameter({chosen_parameter_, value});
    mark_moving();
  }
  const Parameter& row = parameter(chosen_parameter_);
  say(fmt::format("{} = {} ({})", chosen_parameter_, row.text(), row.allowed()));
}

void Session::follow(const ScriptStep& step) {
  if (const auto* const setting = std::get_if<ParameterSetting>(&step)) return set_parameter(*setting);
  const KeyRow& key = *std::get<const KeyRow*>(step);
  act(key_table().find(key.key, key.modifiers, scene_id(selection_.scene))->effect);
}

void check_script(std::span<const ScriptStep> script, const Selection& selection, std::shared_ptr<const LoadedScene> loaded) {
  Session trial(selection, std::move(loaded));
  for (const ScriptStep& step : script) {
    const auto* const setting = std::get_if<ParameterSetting>(&step);
    if (!setting && !concerns_parameters(std::get<const KeyRow*>(step)->effect)) continue;
    try {
      trial.follow(step);
    } catch (const Error& error) {
      if (!setting) throw;
      throw Error("{}={}: {}", setting->name, setting->value, error.what());
    }
  }
}

}  // namespace gnomon::viewer
