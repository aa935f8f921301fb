// The live numbers of both sides, side by side.
#include <imgui.h>

#include <algorithm>
#include <cmath>

#include "app/viewer/panels.h"
#include "report/table/digits.h"

namespace gnomon::viewer {

namespace {

/// A value, or nothing; out of date while a newer answer is shown.
struct Value {
  std::string words;
  bool is_old = false;
};

/// The sides that have numbers of their own: the reference has none.
std::vector<int> numbered_sides(const EngineState& state) {
  std::vector<int> sides;
  for (int side = 0; side < 2; ++side)
    if (!state.sides[side].is_reference) sides.push_back(side);
  return sides;
}

/// Words at the right edge where they fit; else in several lines.
void draw_words(const std::string& words) {
  const std::string all = Widgets::lines(words, ImGui::GetContentRegionAvail().x);
  ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, {0, 0});
  for (std::size_t at = 0; at <= all.size();) {
    const std::size_t end = std::min(all.find('\n', at), all.size());
    Widgets::right(all.substr(at, end - at));
    at = end + 1;
  }
  ImGui::PopStyleVar();
}

/// A value at the right edge of its column, without its unit where that has no room; a dash where there is none.
void draw_value(const Value& value) {
  std::string shown = value.words.empty() ? "-" : value.words;
  if (ImGui::CalcTextSize(shown.c_str()).x > ImGui::GetContentRegionAvail().x) shown = shown.substr(0, shown.find(' '));
  const bool is_faint = value.words.empty() || value.is_old;
  ImGui::PushStyleColor(ImGuiCol_Text, is_faint ? quiet_text : ImGui::GetColorU32(ImGuiCol_Text));
  Widgets::right(shown);
  ImGui::PopStyleColor();
  if (shown.size() < value.words.size()) Widgets::tooltip(value.words);
}

void draw_name(const std::string& name, const std::string& sentence) {
  ImGui::TableNextColumn();
  ImGui::TextDisabled("%s", name.c_str());
  const bool is_cut = ImGui::CalcTextSize(name.c_str()).x > ImGui::GetContentRegionAvail().x;
  Widgets::tooltip(is_cut ? name + "\n" + sentence : sentence);
}

/// A row: what it is, and a value for each side that has numbers.
template <class Words>
void draw_row(const EngineState& state, const std::string& name, const std::string& sentence, const Words& words) {
  draw_name(name, sentence);
  for (const int side : numbered_sides(state)) {
    ImGui::TableNextColumn();
    draw_value(words(state.sides[side], side));
  }
}

std::string phase_words(const SideState& side) {
  if (side.phase == Phase::working) {
    const std::string share = side.progress > 0 ? fmt::format(" {:.0f} %", 100 * side.progress) : "";
    return fmt::format("{}{} {:.1f} s", side.words.empty() ? "working" : side.words, share, side.seconds);
  }
  return side.phase == Phase::done && side.is_approximate() ? "approximate" : phase_names[static_cast<int>(side.phase)];
}

void draw_phase(const SideState& state, bool is_right) {
  const bool is_bad = state.phase == Phase::failed || state.phase == Phase::unsupported;
  ImGui::PushStyleColor(ImGuiCol_Text, is_bad ? warning_text : quiet_text);
  is_right ? draw_words(phase_words(state)) : ImGui::TextUnformatted(phase_words(state).c_str());
  ImGui::PopStyleColor();
  std::string sentence = state.words;
  if (state.is_approximate()) sentence = "approximate: " + state.answer->support.why();
  if (!state.renderer.empty()) sentence += (sentence.empty() ? "" : "\n") + state.renderer;
  Widgets::tooltip(sentence);
}

void draw_heads(const PanelData& shown, const Session& session) {
  ImGui::TableNextColumn();
  for (int side = 0; side < 2; ++side) {
    ImGui::TableNextColumn();
    draw_words(shown.titles[side]);
    Widgets::tooltip(written(session.selection().sides[side]));
  }
  ImGui::TableNextColumn();
  for (int side = 0; side < 2; ++side) {
    ImGui::TableNextColumn();
    draw_phase(shown.state.sides[side], true);
  }
}

/// The head of the only side that has numbers.
void draw_head(const PanelData& shown, const Session& session, int side) {
  ImGui::TextUnformatted(shown.titles[side].c_str());
  Widgets::tooltip(written(session.selection().sides[side]));
  ImGui::SameLine(0, 2 * lengths().gap);
  draw_phase(shown.state.sides[side], false);
}

void draw_tallies(const EngineState& state) {
  for (const Tally& tally : tallies(state.frame.get()))
    draw_row(state, tally.name, tally.sentence, [&](const SideState& side, int) {
      if (!side.verdict) return Value{};
      return Value{tally.words(*side.verdict), side.verdict->answer != side.answer};
    });
}

void draw_times(const EngineState& state) {
  const bool moves = state.loaded && state.loaded->scene.motion;
  for (const Stage stage : all_stages) {
    if (stage == Stage::update && !moves) continue;
    draw_row(state, std::string(name(stage)),
             "The last time that this stage was done, live and beside whatever else runs; gnomon run measures.",
             [&](const SideState& side, int) {
               const auto ms = side.newest_ms[static_cast<int>(stage)];
               return Value{ms ? milliseconds(*ms) + " ms" : ""};
             });
  }
}

constexpr std::size_t least_plotted = 8;  // a curve of fewer times is not drawn

/// The last times of resolve as a curve from 0 up, and their median while camera and light rest.
void draw_resolves(const EngineState& state, const ResolveTimes& times) {
  const std::vector<int> sides = numbered_sides(state);
  if (std::ranges::any_of(sides, [&](int side) { return times.median(side).has_value(); }))
    draw_row(state, "median", "Of the times of resolve since camera and light rest; \"repeat resolve\" makes more of them.",
             [&](const SideState&, int side) {
               const auto median = times.median(side);
               return Value{median ? fmt::format("{} ms", milliseconds(median->ms)) : ""};
             });
  if (std::ranges::none_of(sides, [&](int side) { return times.last(side).size() >= least_plotted; })) return;
  draw_name("resolves", "The last times of resolve, from 0 ms at the bottom, the newest at the right.");
  for (const int side : sides) {
    ImGui::TableNextColumn();
    const std::span<const float> ms = times.last(side);
    if (ms.size() < least_plotted) continue;
    ImGui::PushID(side);
    ImGui::PlotLines("##resolves", ms.data(), static_cast<int>(ms.size()), 0, nullptr, 0, 1.05f * std::ranges::max(ms),
                     {ImGui::GetContentRegionAvail().x, 1.8f * ImGui::GetFontSize()});
    ImGui::PopID();
  }
}

std::string count_words(const Count& count) {
  const std::string value = count.value == std::floor(count.value) ? fmt::format("{:.0f}", count.value) : measured(count.value);
  return count.unit.empty() || count.unit == count.name ? value : value + " " + count.unit;
}

/// Of both sides: those of the left in its order, then what only the right has.
std::vector<std::string> count_names(const EngineState& state) {
  std::vector<std::string> names;
  for (const SideState& side : state.sides)
    if (side.counts)
      for (const Count& count : *side.counts)
        if (std::ranges::find(names, count.name) == names.end()) names.push_back(count.name);
  return names;
}

void draw_counts(const EngineState& state) {
  for (const std::string& name : count_names(state))
    draw_row(state, name, "Work or memory of the last stages; the same on every machine.", [&](const SideState& side, int) {
      if (!side.counts) return Value{};
      const auto found = std::ranges::find(*side.counts, name, &Count::name);
      return found == side.counts->end() ? Value{} : Value{count_words(*found), side.counted_answer != side.answer};
    });
}

/// A table of names and values. Whether it was begun.
bool begin_numbers(const char* id, std::size_t sides, float width, float name_width) {
  const ImVec2 size(width, 0);
  const auto columns = static_cast<int>(1 + sides);
  if (!ImGui::BeginTable(id, columns, ImGuiTableFlags_SizingStretchSame | ImGuiTableFlags_NoSavedSettings, size)) return false;
  ImGui::TableSetupColumn("name", ImGuiTableColumnFlags_WidthFixed, name_width);
  for (std::size_t k = 0; k < sides; ++k) ImGui::TableSetupColumn("side", ImGuiTableColumnFlags_WidthStretch);
  return true;
}

}  // namespace

void draw_numbers(const PanelData& shown, const Session& session) {
  const EngineState& state = shown.state;
  const std::vector<int> sides = numbered_sides(state);
  if (sides.empty()) return Widgets::wrapped("Both sides show the reference itself: there is nothing to compare.", quiet_text);
  const float gap = lengths().gap, room = ImGui::GetContentRegionAvail().x, font = ImGui::GetFontSize();
  const float short_names = 5.2f * font;
  float long_names = short_names;
  for (const std::string& name : count_names(state)) long_names = std::max(long_names, ImGui::CalcTextSize(name.c_str()).x);
  const auto limited = [&](float most) { return std::min(long_names, std::max(short_names, most)); };
  if (sides.size() == 1) draw_head(shown, session, sides[0]);
  // One side's numbers have room beside each other.
  if (sides.size() == 1 && room > 22 * font) {
    const float first = short_names + 6 * font, second = room - gap - first;
    if (begin_numbers("numbers", 1, first, short_names)) {
      draw_tallies(state);
      draw_times(state);
      ImGui::EndTable();
    }
    ImGui::SameLine(0, gap);
    if (begin_numbers("counts", 1, second, limited(second - 5.5f * font))) {
      draw_resolves(state, shown.times);
      draw_counts(state);
      ImGui::EndTable();
    }
    return;
  }
  if (!begin_numbers("numbers", sides.size(), 0, limited(room - 8.3f * font * static_cast<float>(sides.size())))) return;
  if (sides.size() == 2) draw_heads(shown, session);
  draw_tallies(state);
  draw_times(state);
  draw_resolves(state, shown.times);
  draw_counts(state);
  ImGui::EndTable();
}

}  // namespace gnomon::viewer
