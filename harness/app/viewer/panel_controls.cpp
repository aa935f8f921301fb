// The panel at the left: what is shown.
#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>
#include <optional>

#include "app/viewer/light_size.h"
#include "app/viewer/moves.h"
#include "app/viewer/panels.h"
#include "app/viewer/side_names.h"
#include "app/viewer/window.h"
#include "measure/paths.h"
#include "measure/picture/signed_color.h"

namespace gnomon::viewer {

namespace {

bool section(const char* title) { return ImGui::CollapsingHeader(title, ImGuiTreeNodeFlags_DefaultOpen); }

void draw_scene_list(Session& session, std::span<const SceneListing> scenes, Widgets& widgets) {
  const std::string id = scene_id(session.selection().scene);
  std::vector<Widgets::Choice> choices;
  for (const SceneListing& scene : scenes) {
    const std::string words = scene.available ? scene.id : scene.id + "  (not fetched)";
    std::string sentence = fmt::format("{}: {}", scene.title, scene.summary);
    if (!scene.available) sentence += fmt::format("\nIts files are not here; {} {} fetches them.", fetch_command(), scene.id);
    choices.push_back({"scene." + scene.id, words, std::move(sentence), scene.id == id, scene.available});
  }
  widgets.label("scene", "A generated or described scene, or below the path of a .toml or mesh file.");
  if (const auto k = widgets.list("scene", id, choices, ImGuiComboFlags_HeightLarge))
    widgets.attempt([&] { session.choose_scene(scenes[*k].id); });
}

void draw_scene(Session& session, const PanelData& shown, std::span<const SceneListing> scenes, Widgets& widgets) {
  draw_scene_list(session, scenes, widgets);
  static std::string path;
  widgets.label("file", "Path of a .toml or mesh file; Enter opens it.");
  constexpr ImGuiInputTextFlags flags = ImGuiInputTextFlags_EnterReturnsTrue | ImGuiInputTextFlags_AutoSelectAll;
  if (ImGui::InputTextWithHint("##file", "path, then Enter", &path, flags) && !path.empty())
    widgets.attempt([&] { session.choose_scene(path); });
  widgets.note("scene.file");
  if (!shown.state.scene_error.empty()) Widgets::wrapped(shown.state.scene_error, warning_text);
  if (session.generator() && widgets.parameters("scene", *session.generator())) session.generator_changed();
  widgets.label("truth", "What counts: exact shapes, or the meshes that stand for them.");
  for (const Truth truth : {Truth::shape, Truth::mesh}) {
    if (truth == Truth::mesh) ImGui::SameLine();
    const std::string words(name(truth));
    if (ImGui::RadioButton(words.c_str(), session.selection().truth == truth)) session.set_truth(truth);
    widgets.note("truth." + words);
  }
}

/// Three fields in one row. Whether one was set.
bool draw_vector(const std::string& name, const char* words, glm::vec3& value, float speed, Widgets& widgets) {
  ImGui::PushID(name.c_str());
  widgets.label(words, "Meters, along x, y and z: dragged with the mouse, or typed after a double click.");
  const float gap = ImGui::GetStyle().ItemInnerSpacing.x;
  const float room = (ImGui::GetContentRegionAvail().x - 2 * gap) / 3;
  bool is_set = false;
  for (int k = 0; k < 3; ++k) {
    if (k > 0) ImGui::SameLine(0, gap);
    ImGui::PushID(k);
    ImGui::SetNextItemWidth(room);
    is_set = ImGui::DragFloat("##value", &value[k], speed, 0, 0, "%.4g") || is_set;
    widgets.note_slider(name + "." + "xyz"[k]);
    ImGui::PopID();
  }
  ImGui::PopID();
  return is_set;
}

bool draw_light_fields(Light& light, float speed, Widgets& widgets) {
  bool is_set = false;
  const auto vector = [&](const char* words, glm::vec3& value, float by) {
    is_set = draw_vector(std::string("light.") + words, words, value, by, widgets) || is_set;
  };
  if (glm::vec3* const place = position_of(light)) vector(has_area(light) ? "center" : "position", *place, speed);
  if (auto* const sun = std::get_if<DirectionalLight>(&light.kind))
    vector("direction", sun->direction, 0.005f * glm::length(sun->direction));
  if (auto* const spot = std::get_if<SpotLight>(&light.kind))
    vector("direction", spot->direction, 0.005f * glm::length(spot->direction));
  const std::vector<LightLength> lengths = light_lengths(light);
  for (std::size_t k = 0; k < lengths.size(); ++k) {
    const std::string name = fmt::format("light.{}", lengths[k].name);
    auto meters = static_cast<float>(lengths[k].meters);
    widgets.label(std::string(lengths[k].words),
                  "Meters from the center: dragged with the mouse, or typed after a double click; in the picture, too.");
    if (ImGui::DragFloat(("##" + name).c_str(), &meters, speed, 0, 0, "%.4g")) {
      light = with_length(light, k, meters);
      is_set = true;
    }
    widgets.note_slider(name);
  }
  return is_set;
}

constexpr const char* all_lights = "all+";

/// What the list of lights shows of several together, and which of them can be moved.
std::string together_words(const Selection& selection, const Scene& scene) {
  if (selection.together.empty()) return selection.light.name;
  const std::string word = together_word(selection, scene.lights.size());
  const std::string_view moved = whole_name(selection.light.name);
  return word == moved ? word : fmt::format("{} ({})", word == all_lights ? "all lights" : word, moved);
}

/// A list of the names of lights or views, and a button beside it that takes a move back: "reset". The name that was chosen, or
/// `all_lights` where it `has_all`, or nothing.
struct NameList {
  const char* what;
  std::string shown, chosen;
  bool is_moved = false, has_all = false, is_all = false;
};
template <class Item>
std::optional<std::string> draw_names(const NameList& list, const std::vector<Item>& items, Widgets& widgets) {
  const char* const what = list.what;
  std::optional<std::string> result;
  ImGui::PushID(what);
  widgets.label(what);
  const float reset_width = ImGui::CalcTextSize("reset").x + 2 * ImGui::GetStyle().FramePadding.x;
  ImGui::SetNextItemWidth(-reset_width - ImGui::GetStyle().ItemInnerSpacing.x);
  std::vector<Widgets::Choice> choices;
  if (list.has_all)
    choices.push_back({fmt::format("{}.{}", what, all_lights), "all lights", "All of them as one picture (E).", list.is_all});
  const std::size_t before = choices.size();
  for (const Item& item : items)
    choices.push_back({fmt::format("{}.{}", what, item.name), item.name, "", !list.is_all && item.name == list.chosen});
  if (const auto k = widgets.list(what, list.is_moved ? list.shown + ", moved" : list.shown, choices))
    result = *k < before ? all_lights : items[*k - before].name;
  ImGui::SameLine(0, ImGui::GetStyle().ItemInnerSpacing.x);
  ImGui::BeginDisabled(!list.is_moved);
  if (ImGui::Button("reset")) result = "";
  ImGui::EndDisabled();
  widgets.note(std::string(what) + ".reset");
  ImGui::PopID();
  return result;
}

void draw_light_and_view(Session& session, Widgets& widgets) {
  const Scene* const scene = session.scene();
  if (!scene) return;
  const Bounds bounds = scene->bounds();
  const float speed = glm::length(bounds.max - bounds.min) / 1000;
  const Selection& selection = session.selection();
  const std::string& moved = selection.light.name;
  const bool has_all = whole_lights(scene->lights).size() > 1;
  const NameList lights{.what = "light",
                        .shown = together_words(selection, *scene),
                        .chosen = selection.together.empty() ? moved : std::string(whole_name(moved)),
                        .is_moved = session.is_light_moved(),
                        .has_all = has_all,
                        .is_all = has_all && selection.together.size() == scene->lights.size()};
  if (const auto name = draw_names(lights, listed_lights(*scene), widgets)) {
    if (name->empty())
      session.reset_light();
    else if (*name == all_lights)
      widgets.attempt([&] { session.choose_together(all_lights); });
    else
      session.choose_light(*name);
  }
  Light light = session.selection().light;
  if (draw_light_fields(light, speed, widgets))
    if (widgets.attempt([&] { session.set_light(light); })) session.mark_moving();
  const std::string& seen = selection.view.name;
  const NameList views{.what = "view", .shown = seen, .chosen = seen, .is_moved = session.is_view_moved()};
  if (const auto name = draw_names(views, scene->views, widgets)) session.choose_view(name->empty() ? seen : *name);
  View view = session.selection().view;
  widgets.label("field of view", "Of the picture's height, in degrees.");
  if (Widgets::slider("##fov", view.fov_y_degrees, 5.f, 120.f, "%.4g degree", ImGuiSliderFlags_AlwaysClamp))
    if (widgets.attempt([&] { session.set_view(view); })) session.mark_moving();
  widgets.note_slider("view.fov_y_degrees");
}

/// Rows of buttons, `count` in each, for the values of an enumeration; one that is pressed becomes the chosen one.
template <class Mode>
void draw_modes(const char* what, std::span<const ModeRow> rows, std::size_t count, Mode& chosen, Widgets& widgets) {
  const auto before = static_cast<std::size_t>(chosen);
  widgets.label(what, "", 0.5f);
  const float left = ImGui::GetCursorPosX();
  for (std::size_t first = 0; first < rows.size(); first += count) {
    if (first > 0) ImGui::SetCursorPosX(left);
    std::vector<Widgets::Choice> buttons;
    for (std::size_t k = first; k < std::min(first + count, rows.size()); ++k)
      buttons.push_back(
          {fmt::format("{}.{}", what, rows[k].id), std::string(rows[k].title), std::string(rows[k].sentence), before == k});
    if (const auto k = widgets.buttons(buttons, 1)) chosen = static_cast<Mode>(first + *k);
  }
}

/// A box to tick. Whether it was.
bool draw_flag(const std::string& name, const char* words, bool& value, const std::string& sentence, Widgets& widgets) {
  const bool is_set = ImGui::Checkbox(words, &value);
  widgets.note(name);
  Widgets::tooltip(sentence);
  return is_set;
}

/// What a difference is to, how large one has the whole color, and what lies below.
void draw_difference_controls(DifferenceScale& difference, Widgets& widgets) {
  draw_modes("against", against_rows, 2, difference.against, widgets);
  const auto words = [](double full) { return fmt::format("-{0:g} .. +{0:g}", full); };
  std::vector<Widgets::Choice> choices;
  for (const double full : difference_scales)
    choices.push_back({fmt::format("full_scale.{:g}", full), words(full), "", full == difference.full});
  widgets.label("full scale", "The difference at which the colors end.");
  ImGui::SetNextItemWidth(-ImGui::CalcTextSize("plain").x - ImGui::GetFrameHeight() - 2 * ImGui::GetStyle().ItemSpacing.x);
  if (const auto k = widgets.list("full_scale", words(difference.full), choices)) difference.full = difference_scales[*k];
  ImGui::SameLine();
  draw_flag("plain", "plain", difference.is_plain, "The very colors of the scale, not as dark as the dimmed scene.", widgets);
}

void draw_picture_controls(Session& session, Widgets& widgets) {
  draw_modes("layout", layout_rows, 4, session.layout, widgets);
  draw_modes("paint", paint_rows, 3, session.paint, widgets);
  if (session.paint == Paint::difference) draw_difference_controls(session.difference, widgets);
  auto divider = static_cast<float>(100 * session.divider);
  widgets.label("divider", "Where the sides meet in a split picture; dragged in the picture, too.");
  if (Widgets::slider("##divider", divider, 0.f, 100.f, "%.0f %%", ImGuiSliderFlags_AlwaysClamp))
    session.divider = divider / 100;
  widgets.note("divider");
  float opacity = 100 * session.layer_opacity;
  widgets.label("layer opacity", "Of debug layers over the paint.");
  if (Widgets::slider("##opacity", opacity, 0.f, 100.f, "%.0f %%", ImGuiSliderFlags_AlwaysClamp))
    session.layer_opacity = opacity / 100;
  widgets.note("layer_opacity");
  widgets.label("overlays", "", 0.6f);
  draw_flag("silhouettes", "silhouettes", session.shows_silhouettes,
            "The casters' silhouette edges as the light sees them; dark where the eye does not (O).", widgets);
  ImGui::SameLine();
  draw_flag("contours", "contours", session.shows_contours,
            "Where visibility is 0.02, 0.5 and 0.98: thin of the side, broad of the reference (I).", widgets);
  widgets.label("panel", "", 0.6f);
  draw_flag("magnifier", "magnifier", session.shows_magnifier, "The pixels around one, and what is known of it (Z).", widgets);
  widgets.label("frames", "", 0.6f);
  bool is_full = session.selection().full_while_moving;
  if (draw_flag("full_frames", "full size", is_full,
                "While the camera or the light moves, frames have all the pixels of the picture, however long they take.",
                widgets))
    session.set_full_while_moving(is_full);
  ImGui::SameLine();
  draw_flag("repeat", "repeat resolve", session.repeats,
            "Both sides do resolve again and again, so that its time becomes a median.", widgets);
}

void draw_layers(int side, Session& session, Widgets& widgets) {
  const std::vector<DebugLayer> layers = session.technique(side).debug_layers();
  const std::string prefix = side_name(side);
  const std::string& chosen = session.selection().sides[side].layer;
  std::string sentence = layers.empty() ? "This technique has no debug layers." : "A picture of what the technique did.";
  for (const DebugLayer& layer : layers)
    if (layer.name == chosen) sentence = layer.sentence;
  std::vector<Widgets::Choice> choices = {{prefix + ".layer.none", "none", "", chosen.empty()}};
  for (const DebugLayer& layer : layers)
    choices.push_back({prefix + ".layer." + layer.name, layer.name, layer.sentence, layer.name == chosen});
  widgets.label("debug layer", sentence);
  ImGui::BeginDisabled(layers.empty());
  if (const auto k = widgets.list(prefix + ".layer", chosen.empty() ? "none" : chosen, choices))
    session.choose_layer(side, *k == 0 ? "" : layers[*k - 1].name);
  ImGui::EndDisabled();
  if (!chosen.empty()) Widgets::wrapped(sentence, quiet_text);
}

void draw_technique(int side, Session& session, Widgets& widgets) {
  const std::string name = fmt::format("{}.technique", side_name(side));
  const TechniqueEntry& chosen = registry().technique(session.technique(side).id());
  const auto said = [](const TechniqueEntry& entry) { return fmt::format("{}: {}", entry.id, entry.about.summary); };
  std::vector<Widgets::Choice> choices;
  for (const TechniqueEntry& entry : registry().techniques())
    choices.push_back({name + "." + entry.id, std::string(entry.about.title), said(entry), entry.id == chosen.id});
  widgets.label(side_name(side), said(chosen), 0.4f);
  if (const auto k = widgets.list(name, std::string(chosen.about.title), choices, ImGuiComboFlags_HeightLargest))
    session.choose_technique(side, registry().techniques()[*k].id);
}

void draw_side_controls(int side, Session& session, const PanelData& shown, Widgets& widgets) {
  const std::string prefix = side_name(side);
  Technique& technique = session.technique(side);
  if (widgets.parameters(prefix, technique)) session.technique_changed(side);
  draw_layers(side, session, widgets);
  const bool has_curve = shown.state.curve != nullptr;
  if (side == 0 && !curve_samples(technique).empty() &&
      widgets.button(
          "left.curve", has_curve ? "Hide the curve" : "Error against samples",
          "Measures the mean error of this frame with 1, 4, 16, ... samples, in the background and in a process of its "
          "own, until anything changes."))
    session.ask_for_curve(!has_curve);
  if (shown.state.sides[side].phase == Phase::failed &&
      widgets.button(prefix + ".start_again", "Start again", shown.state.sides[side].words))
    session.start_again(side);
  if (technique.parameters().empty()) return;
  ImGui::BeginDisabled(technique.settings().empty());
  if (widgets.button(prefix + ".reset", "Reset parameters", "Sets every parameter of this side to its default.")) {
    for (Parameter* const row : technique.parameters()) row->set(row->default_text());
    session.technique_changed(side);
  }
  ImGui::EndDisabled();
}

void draw_actions(Session& session, Widgets& widgets) {
  static constexpr Action actions[] = {Action::save, Action::copy_command, Action::screenshot, Action::help};
  const Widgets::Choice choices[] = {
      {"save", "Save", "Scene, command, mask and pictures into a folder (Ctrl+S)."},
      {"copy_command", "Command", "The command that renders the left side, to the clipboard (Ctrl+C)."},
      {"screenshot", "Screenshot", "A picture of the whole window (F12)."},
      {"help", "Help", "All keys (F1)."}};
  if (const auto k = widgets.buttons(choices, ImGui::GetStyle().ItemSpacing.x)) session.act(actions[*k]);
}

}  // namespace

void draw_controls(const PixelRect& place, Session& session, const PanelData& shown, std::span<const SceneListing> scenes,
                   Widgets& widgets) {
  if (begin_panel("controls", place)) {
    draw_actions(session, widgets);
    for (int side = 0; side < 2; ++side) draw_technique(side, session, widgets);
    if (section("Picture")) draw_picture_controls(session, widgets);
    ImGui::PushID("scene");
    if (section("Scene, light and view")) {
      draw_scene(session, shown, scenes, widgets);
      draw_animation(session, widgets);
      draw_light_and_view(session, widgets);
    }
    ImGui::PopID();
    for (int side = 0; side < 2; ++side) {
      ImGui::PushID(side);
      const std::string title = fmt::format("{}: {}", side == 0 ? "Left" : "Right", technique_title(session, side));
      if (section((title + "###side").c_str())) draw_side_controls(side, session, shown, widgets);
      ImGui::PopID();
    }
  }
  ImGui::End();
}

}  // namespace gnomon::viewer
