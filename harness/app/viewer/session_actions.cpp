// What each key does.
#include <algorithm>

#include "app/viewer/key_moves.h"
#include "app/viewer/session.h"

namespace gnomon::viewer {

void Session::object_of_composite(const char* object) {
  if (!generator_ || generator_->id() != "composite") choose_scene(fmt::format("composite:object={}", object));
  generator_->parameter("object").set(object);
  const bool is_new = !loaded_ || loaded_->reference.substr(0, loaded_->reference.find(':')) != "composite";
  generator_changed();
  keeps_moved_ = !is_new;
}

void Session::step_technique(int step) {
  const auto& all = registry().techniques();
  const auto found = std::ranges::find(all, wish_.sides[0].technique, &TechniqueEntry::id);
  const auto count = static_cast<std::ptrdiff_t>(all.size());
  choose_technique(0, all[(found - all.begin() + step + count) % count].id);
}

void Session::next_layer() {
  const std::vector<DebugLayer> layers = technique(0).debug_layers();
  if (layers.empty()) return say(fmt::format("{} has no debug layers", technique(0).id()), true);
  const auto found = std::ranges::find(layers, wish_.sides[0].layer, &DebugLayer::name);
  if (found == layers.end())
    choose_layer(0, layers.front().name);
  else
    choose_layer(0, found + 1 == layers.end() ? "" : (found + 1)->name);
}

void Session::act(Action action, double steps) {
  if (scene()) {
    const std::optional<View> view = moved_by_key(wish_.view, *scene(), action, steps);
    const std::optional<Light> light = moved_by_key(wish_.light, *scene(), action, steps);
    if (view) set_view(*view);
    if (light) set_light(*light);
    if (view || light) return mark_moving();
  }
  switch (action) {
    case Action::object_circle:
      return object_of_composite("circle");
    case Action::object_triangle:
      return object_of_composite("triangle");
    case Action::object_sphere:
      return object_of_composite("sphere");
    case Action::object_cone:
      return object_of_composite("cone");
    case Action::layout_left:
      layout = Layout::left;
      return;
    case Action::layout_right:
      layout = Layout::right;
      return;
    case Action::layout_split:
      layout = Layout::split;
      return;
    case Action::layout_flicker:
      layout = Layout::flicker;
      return;
    case Action::paint_shaded:
      paint = Paint::shaded;
      return;
    case Action::paint_mask:
      paint = Paint::mask;
      return;
    case Action::paint_difference:
      paint = Paint::difference;
      return;
    case Action::paint_kinds:
      paint = Paint::kinds;
      return;
    case Action::paint_causes:
      paint = Paint::causes;
      return;
    case Action::paint_classes:
      paint = Paint::classes;
      return;
    case Action::technique_before:
      return step_technique(-1);
    case Action::technique_after:
      return step_technique(1);
    case Action::swap_sides:
      return swap_sides();
    case Action::layer_after:
      return next_layer();
    case Action::silhouettes:
      shows_silhouettes = !shows_silhouettes;
      return;
    case Action::magnifier:
      shows_magnifier = !shows_magnifier;
      return;
    case Action::panels:
      shows_panels = !shows_panels;
      return;
    case Action::reset_view:
      return reset_view();
    case Action::reset_light:
      return reset_light();
    case Action::save:
      requests.save = true;
      return;
    case Action::copy_command:
      requests.copy_command = true;
      return;
    case Action::screenshot:
      requests.screenshot = true;
      return;
    case Action::help:
      shows_help = !shows_help;
      return;
    case Action::quit:
      requests.quit = true;
      return;
    case Action::cancel:
      if (shows_help)
        shows_help = false;
      else
        pick({});
      return;
    default:
      return;
  }
}

}  // namespace gnomon::viewer
