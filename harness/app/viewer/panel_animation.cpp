// The controls of a scene that moves.
#include <imgui.h>

#include "app/viewer/panels.h"

namespace gnomon::viewer {

namespace {

constexpr const char* rest_words = "at rest";

void draw_animation_list(Session& session, Widgets& widgets) {
  const std::string shown = session.player().animation();
  std::vector<Widgets::Choice> choices = {{"animation.rest", rest_words, "The meshes as the file has them.", shown.empty()}};
  for (const Animation& animation : session.scene()->motion->animations)
    choices.push_back(
        {"animation." + animation.name, animation.name, fmt::format("{:g} s long.", animation.end()), animation.name == shown});
  widgets.label("animation", "What moves the meshes of this scene.");
  if (const auto k = widgets.list("animation", shown.empty() ? rest_words : shown, choices))
    widgets.attempt([&] { session.choose_animation(*k == 0 ? "" : choices[*k].words); });
}

/// Frames, with the time beside the number. It scrubs.
void draw_time(Session& session, Widgets& widgets) {
  const Player& player = session.player();
  int frame = player.frame();
  const std::string format = fmt::format("%d  ({:.3f} s)", player.pose()->seconds);
  widgets.label("frame", "60 of them are a second.");
  if (Widgets::slider("##frame", frame, 0, player.last_frame(), format.c_str(), ImGuiSliderFlags_AlwaysClamp))
    session.go_to_frame(frame);
  widgets.note_slider("frame");
}

void draw_buttons(Session& session, Widgets& widgets) {
  const KeyEffect effects[] = {FrameSteps{-1}, Action::play, FrameSteps{1}};
  const bool plays = session.player().is_playing();
  const Widgets::Choice choices[] = {{"frame.back", "Back", "A frame back ([)."},
                                     {"play", plays ? "Pause" : "Play", "In real time (Space)."},
                                     {"frame.on", "On", "A frame on (])."}};
  widgets.label("", "", 0.5f);
  if (const auto k = widgets.buttons(choices, ImGui::GetStyle().ItemSpacing.x))
    widgets.attempt([&] { session.act(effects[*k]); });
  bool loops = session.player().loops;
  widgets.label("", "", 0.5f);
  if (ImGui::Checkbox("again and again", &loops)) session.set_looping(loops);
  widgets.note("loop");
  Widgets::tooltip("At the last frame it begins anew; else it stops there.");
}

}  // namespace

void draw_animation(Session& session, Widgets& widgets) {
  const Scene* const scene = session.scene();
  if (!scene || !scene->motion || scene->motion->animations.empty()) return;
  draw_animation_list(session, widgets);
  if (!session.player().is_at_rest()) draw_time(session, widgets);
  draw_buttons(session, widgets);
}

}  // namespace gnomon::viewer
