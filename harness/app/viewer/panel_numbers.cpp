// The live numbers of both sides, side by side.
#include <imgui.h>

#include <algorithm>

#include "app/viewer/panels.h"
#include "app/viewer/style.h"
#include "report/table/digits.h"

namespace gnomon::viewer {

namespace {

/// A value at the right edge of its column, without its unit where that has no room; a dash where there is none.
void draw_value(const std::string& words) {
  std::string shown = words.empty() ? "-" : words;
  if (ImGui::CalcTextSize(shown.c_str()).x > ImGui::GetContentRegionAvail().x) shown = shown.substr(0, shown.find(' '));
  const float room = ImGui::GetContentRegionAvail().x - ImGui::CalcTextSize(shown.c_str()).x;
  if (room > 0) ImGui::SetCursorPosX(ImGui::GetCursorPosX() + room);
  if (words.empty())
    ImGui::TextDisabled("-");
  else
    ImGui::TextUnformatted(shown.c_str());
  if (shown.size() < words.size()) Widgets::tooltip(words);
}

/// Words at the right edge where they fit; else in several lines.
void draw_words(const std::string& words) {
  const float room = ImGui::GetContentRegionAvail().x - ImGui::CalcTextSize(words.c_str()).x;
  if (room > 0) ImGui::SetCursorPosX(ImGui::GetCursorPosX() + room);
  room > 0 ? ImGui::TextUnformatted(words.c_str()) : Widgets::wrapped(words);
}

/// A row: what it is, and a value for each side.
void draw_row(const std::string& name, const std::string& sentence, const std::string& left, const std::string& right) {
  ImGui::TableNextRow();
  ImGui::TableNextColumn();
  ImGui::PushStyleColor(ImGuiCol_Text, quiet_text);
  ImGui::TextUnformatted(name.c_str());
  ImGui::PopStyleColor();
  Widgets::tooltip(sentence);
  for (const std::string& value : {left, right}) {
    ImGui::TableNextColumn();
    draw_value(value);
  }
}

std::string phase_words(const SideState& side) {
  switch (side.phase) {
    case Phase::starting:
      return "starting";
    case Phase::working:
      return side.words.empty() ? fmt::format("working {:.1f} s", side.seconds)
                                : fmt::format("{} {:.1f} s", side.words, side.seconds);
    case Phase::done:
      return side.is_reference ? "reference" : "done";
    case Phase::unsupported:
      return "unsupported: " + side.words;
    case Phase::failed:
      return "failed: " + side.words;
  }
  return "";
}

void draw_heads(const Shown& shown, const Session& session) {
  ImGui::TableNextRow();
  ImGui::TableNextColumn();
  for (int side = 0; side < 2; ++side) {
    ImGui::TableNextColumn();
    const SideWish& wish = session.wish().sides[side];
    const TechniqueEntry& entry = registry().technique(wish.technique);
    draw_words(std::string(entry.about.title));
    Widgets::tooltip(wish.settings.empty() ? wish.technique : wish.technique + ":" + wish.settings);
  }
  ImGui::TableNextRow();
  ImGui::TableNextColumn();
  for (int side = 0; side < 2; ++side) {
    ImGui::TableNextColumn();
    const SideState& state = shown.state.sides[side];
    const bool is_bad = state.phase == Phase::failed || state.phase == Phase::unsupported;
    ImGui::PushStyleColor(ImGuiCol_Text, is_bad ? warning_text : quiet_text);
    draw_words(phase_words(state));
    ImGui::PopStyleColor();
    std::string sentence = state.words;
    if (state.answer && state.answer->support.kind() == Support::Kind::approximate)
      sentence += (sentence.empty() ? "" : "\n") + ("approximate: " + state.answer->support.why());
    if (!state.renderer.empty()) sentence += (sentence.empty() ? "" : "\n") + state.renderer;
    Widgets::tooltip(sentence);
  }
}

void draw_tallies(const EngineState& state) {
  const auto each = [&](auto&& words) {
    std::array<std::string, 2> result;
    for (int side = 0; side < 2; ++side)
      if (const auto& verdict = state.sides[side].verdict) result[side] = words(verdict->tally);
    return result;
  };
  const auto row = [&](const char* name, const char* sentence, auto&& words) {
    const auto [left, right] = each(words);
    draw_row(name, sentence, left, right);
  };
  row("wrong", "Share of the tested pixels that differ from the reference.", [](const Tally& tally) {
    return tally.tested ? fmt::format("{:.4f} %", 100.0 * tally.wrong / tally.tested) : std::string();
  });
  row("false dark", "Tested pixels that are dark where the reference is lit.",
      [](const Tally& tally) { return fmt::format("{}", tally.false_dark); });
  row("false lit", "Tested pixels that are lit where the reference is dark.",
      [](const Tally& tally) { return fmt::format("{}", tally.false_lit); });
  row("tested", "Pixels of class T: those whose answer is beyond doubt.",
      [](const Tally& tally) { return fmt::format("{}", tally.tested); });
}

void draw_times(const EngineState& state) {
  for (const Stage stage : {Stage::setup, Stage::build, Stage::relight, Stage::resolve}) {
    std::string words[2];
    for (int side = 0; side < 2; ++side)
      if (const auto ms = state.sides[side].newest_ms[static_cast<int>(stage)]) words[side] = milliseconds(*ms) + " ms";
    draw_row(std::string(name(stage)),
             "The last time that this stage was done, live and beside whatever else runs; gnomon run measures.", words[0],
             words[1]);
  }
}

std::string count_words(const Count& count) {
  const std::string value = measured(count.value);
  return count.unit.empty() || count.unit == count.name ? value : value + " " + count.unit;
}

/// Counts of both sides by name: those of the left in its order, then what only the right has.
void draw_counts(const EngineState& state) {
  std::vector<std::string> names;
  for (const SideState& side : state.sides)
    if (side.counts)
      for (const Count& count : *side.counts)
        if (std::ranges::find(names, count.name) == names.end()) names.push_back(count.name);
  for (const std::string& name : names) {
    std::string words[2];
    for (int side = 0; side < 2; ++side)
      if (const auto& counts = state.sides[side].counts)
        if (const auto found = std::ranges::find(*counts, name, &Count::name); found != counts->end())
          words[side] = count_words(*found);
    draw_row(name, "Work or memory of the last stages; the same on every machine.", words[0], words[1]);
  }
}

}  // namespace

void draw_numbers(const Shown& shown, const Session& session) {
  if (!ImGui::BeginTable("numbers", 3, ImGuiTableFlags_SizingStretchProp | ImGuiTableFlags_NoSavedSettings)) return;
  ImGui::TableSetupColumn("name", ImGuiTableColumnFlags_WidthFixed, ImGui::GetFontSize() * 5.5f);
  ImGui::TableSetupColumn("left", ImGuiTableColumnFlags_WidthStretch, 1);
  ImGui::TableSetupColumn("right", ImGuiTableColumnFlags_WidthStretch, 1);
  draw_heads(shown, session);
  draw_tallies(shown.state);
  draw_times(shown.state);
  draw_counts(shown.state);
  ImGui::EndTable();
}

}  // namespace gnomon::viewer
