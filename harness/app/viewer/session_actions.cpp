// What each key does.
#include <algorithm>

#include "app/viewer/session.h"

namespace gnomon::viewer {

void Session::set_scene_parameter(const SceneSetting& to) {
  if (!generator_ || generator_->id() != to.scene) choose_scene(to.scene);
  generator_->parameter(to.parameter).set(to.value);
  generator_changed();
  // From another scene, its light and view come along.
  keeps_moved_ = loaded_ && scene_id(loaded_->reference) == to.scene;
}

void Session::step_technique(int step) {
  const auto& all = registry().techniques();
  const auto found = std::ranges::find(all, selection_.sides[0].technique, &TechniqueEntry::id);
  const auto count = static_cast<std::ptrdiff_t>(all.size());
  choose_technique(0, all[(found - all.begin() + step + count) % count].id);
}

void Session::next_layer() {
  const std::vector<DebugLayer> layers = technique(0).debug_layers();
  if (layers.empty()) return say(fmt::format("{} has no debug layers", technique(0).id()), true);
  const auto found = std::ranges::find(layers, selection_.sides[0].layer, &DebugLayer::name);
  if (found == layers.end())
    choose_layer(0, layers.front().name);
  else
    choose_layer(0, found + 1 == layers.end() ? "" : (found + 1)->name);
}

void Session::act(const KeyEffect& effect, double count) {
  if (scene()) {
    const std::optional<View> view = moved_by_key(selection_.view, *scene(), effect, count);
    const std::optional<Light> light = moved_by_key(selection_.light, *scene(), effect, count);
    if (view) set_view(*view);
    if (light) set_light(*light);
    if (view || light) return mark_moving();
  }
  if (const auto* setting = std::get_if<SceneSetting>(&effect)) return set_scene_parameter(*setting);
  if (const auto* chosen = std::get_if<Layout>(&effect)) layout = *chosen;
  if (const auto* chosen = std::get_if<Paint>(&effect)) paint = *chosen;
  if (const auto* action = std::get_if<Action>(&effect)) carry_out(*action);
}

void Session::carry_out(Action action) {
  const auto flip = [](bool& shown) { shown = !shown; };
  const auto request = [](bool& wanted) { wanted = true; };
  switch (action) {
    case Action::technique_before:
      return step_technique(-1);
    case Action::technique_after:
      return step_technique(1);
    case Action::swap_sides:
      return swap_sides();
    case Action::layer_after:
      return next_layer();
    case Action::silhouettes:
      return flip(shows_silhouettes);
    case Action::magnifier:
      return flip(shows_magnifier);
    case Action::panels:
      return flip(shows_panels);
    case Action::reset_view:
      return reset_view();
    case Action::reset_light:
      return reset_light();
    case Action::save:
      return request(requests.save);
    case Action::copy_command:
      return request(requests.copy_command);
    case Action::screenshot:
      return request(requests.screenshot);
    case Action::quit:
      return request(requests.quit);
    case Action::help:
      return flip(shows_help);
    case Action::cancel:
      return shows_help ? flip(shows_help) : pick({});
  }
}

}  // namespace gnomon::viewer
