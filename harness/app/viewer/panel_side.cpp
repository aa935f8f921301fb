// What a side shows: its technique, the technique's parameters, and a debug layer.
#include <imgui.h>

#include "app/viewer/panels.h"
#include "app/viewer/style.h"

namespace gnomon::viewer {

namespace {

void draw_layers(int side, Session& session, Widgets& widgets) {
  const std::vector<DebugLayer> layers = session.technique(side).debug_layers();
  const std::string prefix = side_name(side);
  const std::string& chosen = session.selection().sides[side].layer;
  std::string sentence = layers.empty() ? "This technique has no debug layers." : "A picture of what the technique did.";
  for (const DebugLayer& layer : layers)
    if (layer.name == chosen) sentence = layer.sentence;
  widgets.label("debug layer", sentence);
  ImGui::BeginDisabled(layers.empty());
  const bool is_open = ImGui::BeginCombo("##layer", chosen.empty() ? "none" : chosen.c_str());
  widgets.note(prefix + ".layer");
  if (is_open) {
    if (ImGui::Selectable("none", chosen.empty())) session.choose_layer(side, "");
    widgets.note(prefix + ".layer.none");
    for (const DebugLayer& layer : layers) {
      if (ImGui::Selectable(layer.name.c_str(), layer.name == chosen)) session.choose_layer(side, layer.name);
      widgets.note(prefix + ".layer." + layer.name);
      Widgets::tooltip(layer.sentence);
    }
    ImGui::EndCombo();
  }
  ImGui::EndDisabled();
  if (!chosen.empty()) Widgets::wrapped(sentence, quiet_text);
}

}  // namespace

std::string title_of(const Session& session, int side) {
  return std::string(registry().technique(session.selection().sides[side].technique).about.title);
}

void draw_technique(int side, Session& session, Widgets& widgets) {
  const std::string prefix = side_name(side);
  const TechniqueEntry& chosen = registry().technique(session.technique(side).id());
  ImGui::PushID(side);
  widgets.label(prefix, fmt::format("{}: {}", chosen.id, chosen.about.summary), 0.4f);
  const bool is_open = ImGui::BeginCombo("##technique", std::string(chosen.about.title).c_str(), ImGuiComboFlags_HeightLargest);
  widgets.note(prefix + ".technique");
  if (is_open) {
    for (const TechniqueEntry& entry : registry().techniques()) {
      if (ImGui::Selectable(std::string(entry.about.title).c_str(), entry.id == chosen.id))
        session.choose_technique(side, entry.id);
      widgets.note(prefix + ".technique." + entry.id);
      Widgets::tooltip(fmt::format("{}: {}", entry.id, entry.about.summary));
    }
    ImGui::EndCombo();
  }
  ImGui::PopID();
}

void draw_side_controls(int side, Session& session, const Shown& shown, Widgets& widgets) {
  const std::string prefix = side_name(side);
  Technique& technique = session.technique(side);
  if (widgets.parameters(prefix, technique)) session.technique_changed(side);
  draw_layers(side, session, widgets);
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

}  // namespace gnomon::viewer
