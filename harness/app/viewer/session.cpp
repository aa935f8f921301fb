// What the person has chosen, and how keys and panels change it.
#include "app/viewer/session.h"

#include <algorithm>

#include "app/viewer/window.h"
#include "measure/run/light_selection.h"
#include "measure/scene/load.h"
#include "measure/scene/time_reference.h"

namespace gnomon::viewer {

namespace {

constexpr double motion_rest = 0.25;  // seconds without a step until a motion is over

/// A generator with the settings of a reference; null when it is a file.
std::unique_ptr<SceneGenerator> generator_of(const std::string& reference) {
  const std::string scene = without_time(reference);
  const std::size_t colon = scene.find(':');
  const SceneEntry* const entry = registry().find_scene(scene_id(scene));
  if (!entry) return nullptr;
  auto generator = entry->make();
  generator->apply(colon == std::string::npos ? "" : scene.substr(colon + 1));
  return generator;
}

}  // namespace

std::string scene_id(const std::string& reference) {
  const std::string scene = without_time(reference);
  return scene.substr(0, scene.find(':'));
}

Session::Session(Selection selection, std::shared_ptr<const LoadedScene> loaded)
    : selection_(std::move(selection)), loaded_(std::move(loaded)), generator_(generator_of(selection_.scene)) {
  if (selection_.at) player_ = player_of(selection_.at->animation);
  for (int side = 0; side < 2; ++side) {
    const SideSelection start = selection_.sides[side];
    choose_technique(side, start.technique);
    technique(side).apply(start.settings);
    technique_changed(side);
    choose_layer(side, start.layer);
  }
}

void Session::choose_scene(const std::string& reference) {
  auto generator = generator_of(reference);
  // Other settings of the same generator: a light or view that was moved stays where it is.
  keeps_moved_ = generator && scene_id(reference) == scene_id(selection_.scene);
  generator_ = std::move(generator);
  selection_.scene = reference;
  pick({});
}

void Session::generator_changed() {
  const std::string settings = generator_->settings();
  const std::string time = selection_.scene.substr(without_time(selection_.scene).size());  // the still's
  keeps_moved_ = true;
  selection_.scene = (settings.empty() ? generator_->id() : generator_->id() + ":" + settings) + time;
}

void Session::adopt(const EngineState& state) {
  if (!state.loaded || state.loaded == selection_.loaded || state.loaded->reference != selection_.scene) return;
  const std::string word = together_word(selection_, scene()->lights.size());
  const Light before = selection_.light;
  const bool is_same_scene = scene_id(loaded_->reference) == scene_id(state.loaded->reference);
  const bool keeps_light = keeps_moved_ && light_moved_;
  selection_.loaded = loaded_ = state.loaded;
  selection_.together.clear();
  choose_light(before.name);
  if (!word.empty()) renew_together(word);
  if (keeps_light && whole_name(selection_.light.name) == whole_name(before.name)) {
    const std::string name = selection_.light.name;
    selection_.light = before;
    selection_.light.name = name;
    light_moved_ = true;
  }
  if (!(keeps_moved_ && view_moved_)) choose_view(named_or_first(scene()->views, selection_.view.name).name);
  keeps_moved_ = true;
  renew_animation(is_same_scene);
}

void Session::choose_light(const std::string& name) {
  const std::vector<Light> lights = lights_named(*scene(), name);
  const std::string chosen = named_or_first(lights, selection_.light.name).name;
  const bool was_among = selection_.together.size() > lights.size() && whole_name(chosen) == whole_name(selection_.light.name);
  selection_.together = lights.size() > 1 ? lights : std::vector<Light>();
  selection_.light.name = chosen;
  if (!was_among) reset_light();
}

void Session::choose_together(const std::string& word) {
  const std::vector<RowLights> rows = row_lights({word}, selection_.scene, *scene());
  if (rows.size() != 1) throw Error("{} is {} pictures; the window shows one: {}+ is that of all", word, rows.size(), word);
  const std::vector<std::string>& names = rows[0].lights;
  if (std::ranges::find(names, selection_.light.name) == names.end()) choose_light(names[0]);
  selection_.together.clear();
  if (names.size() < 2) return;
  for (const std::string& name : names) selection_.together.push_back(named_or_first(scene()->lights, name));
}

/// In another scene: the same lights, or the chosen one where these are not there.
void Session::renew_together(const std::string& word) {
  try {
    choose_together(word);
  } catch (const Error&) {
    choose_light(std::string(whole_name(selection_.light.name)));
  }
}

void Session::reset_light() {
  selection_.light = named_or_first(scene()->lights, selection_.light.name);
  light_moved_ = false;
}

void Session::choose_view(const std::string& name) {
  selection_.view = named_or_first(scene()->views, name);
  view_moved_ = false;
}

void Session::set_light(const Light& light) {
  check(light, "window");
  light_moved_ = light_moved_ || !are_same(light, selection_.light);
  selection_.light = usable(light);
}

void Session::set_view(const View& view) {
  check(view, "window");
  view_moved_ = view_moved_ || !are_same(view, selection_.view);
  selection_.view = usable(view);
}

void Session::set_size(int width, int height) {
  if (width == selection_.width && height == selection_.height) return;
  selection_.width = width;
  selection_.height = height;
  if (picked_ && (picked_->x >= width || picked_->y >= height)) picked_.reset();
  pick(picked_);
  const auto is_inside = [&](const glm::dvec2& p) { return p.x >= 0 && p.y >= 0 && p.x <= width && p.y <= height; };
  if (profile && !(is_inside(profile->from) && is_inside(profile->to))) profile.reset();
}

void Session::mark_moving() {
  selection_.is_moving = true;
  moving_until_ = Window::now() + motion_rest;
}

std::optional<double> Session::motion_left() const {
  if (!selection_.is_moving) return std::nullopt;
  return std::max(0.0, moving_until_ - Window::now());
}

void Session::settle() {
  if (selection_.is_moving && !player_.is_playing() && Window::now() >= moving_until_) selection_.is_moving = false;
}

void Session::choose_technique(int side, const std::string& id) {
  std::shared_ptr<Technique>& known = known_[side][id];
  if (!known) known = registry().technique(id).make();
  technique_[side] = known;
  technique_changed(side);
  const auto layers = known->debug_layers();
  if (std::ranges::find(layers, selection_.sides[side].layer, &DebugLayer::name) == layers.end()) choose_layer(side, "");
}

void Session::technique_changed(int side) {
  selection_.sides[side].technique = technique_[side]->id();
  selection_.sides[side].settings = technique_[side]->settings();
}

void Session::swap_sides() {
  std::swap(known_[0], known_[1]);
  std::swap(technique_[0], technique_[1]);
  std::swap(selection_.sides[0], selection_.sides[1]);
}

void Session::pick(std::optional<glm::ivec2> pixel) {
  picked_ = pixel;
  selection_.picked.reset();
  if (picked_) selection_.picked = static_cast<std::uint32_t>(picked_->y) * selection_.width + picked_->x;
}

void Session::say(const std::string& text, bool is_warning) {
  message_ = text;
  is_warning_ = is_warning;
}

// --- what each key does ------------------------------------------------------------------------------------------------

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

void Session::flip_profile() {
  if (profile) return profile.reset();
  const double y = picked_ ? picked_->y + 0.5 : selection_.height / 2.0;
  profile = ProfileLine{{0.5, y}, {selection_.width - 0.5, y}};
}

void Session::flip_together() {
  if (!scene()) return;
  const std::size_t before = selection_.together.size();
  if (whole_lights(selection_.together).size() > 1) return choose_light(std::string(whole_name(selection_.light.name)));
  choose_together("all+");
  if (selection_.together.size() == before) say("the scene has one light", true);
}

void Session::act(const KeyEffect& effect, double count) {
  if (scene()) {
    const std::optional<View> view = moved_by_key(selection_.view, *scene(), effect, count);
    const std::optional<Light> light = moved_by_key(selection_.light, *scene(), effect, count);
    if (view) set_view(*view);
    if (light) set_light(*light);
    if (view || light) return mark_moving();
  }
  if (const auto* steps = std::get_if<FrameSteps>(&effect)) return step_frames(count * steps->frames);
  if (const auto* setting = std::get_if<SceneSetting>(&effect)) return set_scene_parameter(*setting);
  if (const auto* steps = std::get_if<ParameterSteps>(&effect)) return step_parameters(*steps, count);
  if (const auto* chosen = std::get_if<Layout>(&effect)) layout = *chosen;
  if (const auto* chosen = std::get_if<Paint>(&effect)) paint = *chosen;
  if (const auto* action = std::get_if<Action>(&effect)) carry_out(*action);
}

void Session::carry_out(Action action) {
  if (action == Action::contours) shows_contours = !shows_contours;
  if (action == Action::silhouettes) shows_silhouettes = !shows_silhouettes;
  if (action == Action::magnifier) shows_magnifier = !shows_magnifier;
  if (action == Action::panels) shows_panels = !shows_panels;
  if (action == Action::help) shows_help = !shows_help;
  if (action == Action::play) flip_playing();
  // What is shown now is saved.
  if (action == Action::save || action == Action::copy_command) player_.pause();
  if (action == Action::save) requests.save = true;
  if (action == Action::copy_command) requests.copy_command = true;
  if (action == Action::screenshot) requests.screenshot = true;
  if (action == Action::quit) requests.quit = true;
  if (action == Action::technique_before) step_technique(-1);
  if (action == Action::technique_after) step_technique(1);
  if (action == Action::swap_sides) swap_sides();
  if (action == Action::layer_after) next_layer();
  if (action == Action::reset_view) choose_view(selection_.view.name);
  if (action == Action::reset_light) reset_light();
  if (action == Action::all_lights) flip_together();
  if (action == Action::profile) flip_profile();
  if (action == Action::cancel && !std::exchange(shows_help, false)) picked_ ? pick({}) : profile.reset();
}

}  // namespace gnomon::viewer
