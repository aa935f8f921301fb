// How the window looks, dark and quiet, so that the picture is what one sees; rows of the panels, and the widgets that follow
// from parameter rows.
#include "app/viewer/widgets.h"

#include <gnomon/error.h>
#include <imgui.h>
#include <imgui_internal.h>

#include <algorithm>
#include <cmath>
#include <type_traits>
#include <utility>

#include "app/viewer/window.h"

namespace gnomon::viewer {

namespace {

float unit_scale = 1;

constexpr std::size_t longest_inline_unit = 6;  // "texel"
constexpr unsigned plate_color = 0xc81e1a18;    // dark enough for words on any grab, and shows where that is

/// What follows a number in its slider; % is doubled, as in every format.
std::string unit_words(std::string_view unit) {
  if (unit.empty() || unit.size() > longest_inline_unit) return "";
  std::string words = " ";
  for (const char c : unit) words += c == '%' ? "%%" : std::string(1, c);
  return words;
}

std::string sentence_of(const Parameter& row) {
  return fmt::format("{}\n{}, {} by default, spoils {}", row.sentence(), row.allowed(), row.default_text(), name(row.spoils()));
}

}  // namespace

void set_style(double scale) {
  unit_scale = static_cast<float>(scale);
  ImGuiStyle style;
  ImGui::StyleColorsDark(&style);
  style.WindowPadding = {10, 8};
  style.FramePadding = {6, 3};
  style.ItemSpacing = {6, 4};
  style.ItemInnerSpacing = {5, 4};
  style.CellPadding = {4, 1};
  style.ScrollbarSize = 11;
  style.GrabMinSize = 9;
  style.WindowBorderSize = style.ChildBorderSize = 0;
  style.PopupBorderSize = 1;
  style.WindowRounding = 0;
  style.FrameRounding = style.GrabRounding = style.PopupRounding = style.ScrollbarRounding = 3;
  const auto gray = [](float value, float alpha = 1) { return ImVec4(value * 0.96f, value, value * 1.06f, alpha); };
  using Level = std::pair<ImGuiCol, float>;
  for (const auto& [what, value] :
       {Level(ImGuiCol_Text, 0.86f), Level(ImGuiCol_WindowBg, 0.125f), Level(ImGuiCol_Border, 0.28f),
        Level(ImGuiCol_FrameBg, 0.19f), Level(ImGuiCol_FrameBgHovered, 0.24f), Level(ImGuiCol_FrameBgActive, 0.27f),
        Level(ImGuiCol_Button, 0.23f), Level(ImGuiCol_ButtonHovered, 0.3f), Level(ImGuiCol_Header, 0.18f),
        Level(ImGuiCol_HeaderHovered, 0.24f), Level(ImGuiCol_HeaderActive, 0.27f), Level(ImGuiCol_Separator, 0.22f),
        Level(ImGuiCol_ScrollbarBg, 0.11f), Level(ImGuiCol_ScrollbarGrab, 0.28f)})
    style.Colors[what] = gray(value);
  style.Colors[ImGuiCol_PopupBg] = gray(0.145f, 0.98f);
  style.Colors[ImGuiCol_TextDisabled] = ImGui::ColorConvertU32ToFloat4(quiet_text);
  for (const auto& [what, alpha] :
       {Level(ImGuiCol_CheckMark, 1.0f), Level(ImGuiCol_SliderGrabActive, 1.0f), Level(ImGuiCol_SliderGrab, 0.85f),
        Level(ImGuiCol_ButtonActive, 0.7f), Level(ImGuiCol_TextSelectedBg, 0.4f)})
    style.Colors[what] = ImVec4(0.33f, 0.58f, 0.80f, alpha);  // the accent
  style.ScaleAllSizes(unit_scale);
  ImGui::GetStyle() = style;
}

Lengths lengths() {
  const auto scaled = [](float value) { return value * unit_scale; };
  return {.scale = scaled(panel_width) / panel_width, .label = scaled(112), .gap = scaled(8)};
}

void Widgets::note(const std::string& name) {
  const ImVec2 low = ImGui::GetItemRectMin(), high = ImGui::GetItemRectMax();
  const double scale = pixels_per_unit();
  const ImRect& clip = ImGui::GetCurrentWindow()->ClipRect;
  const bool is_visible =
      low.x >= clip.Min.x - 1 && low.y >= clip.Min.y - 1 && high.x <= clip.Max.x + 1 && high.y <= clip.Max.y + 1;
  places_[name] = {{low.x * scale, low.y * scale}, {high.x * scale, high.y * scale}, is_visible};
}

void Widgets::tooltip(const std::string& words) {
  static double last_motion = 0;
  const ImVec2 moved = ImGui::GetIO().MouseDelta;
  if (moved.x != 0 || moved.y != 0 || ImGui::IsAnyItemActive()) last_motion = ImGui::GetTime();
  if (words.empty() || !ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled)) return;
  if (ImGui::GetTime() < last_motion + tooltip_delay) return;
  ImGui::BeginTooltip();
  ImGui::PushTextWrapPos(ImGui::GetFontSize() * 26);
  ImGui::TextUnformatted(words.c_str());
  ImGui::PopTextWrapPos();
  ImGui::EndTooltip();
}

std::string Widgets::lines(const std::string& words, float width) {
  const auto width_of = [](const std::string& text) { return ImGui::CalcTextSize(text.c_str()).x; };
  std::string lines, line;
  for (std::size_t at = 0; at < words.size();) {
    const std::size_t end = std::min(words.find_first_of(" \n", at), words.size());
    const std::string word = words.substr(at, end - at);
    const bool is_new = !line.empty() && width_of(line + " " + word) > width;
    if (is_new) lines += std::exchange(line, "") + "\n";
    line += (line.empty() ? "" : " ") + word;
    if (end < words.size() && words[end] == '\n') lines += std::exchange(line, "") + "\n";
    at = end + 1;
  }
  return lines + line;
}

void Widgets::wrapped(const std::string& words) {
  const std::string all = lines(words, ImGui::GetContentRegionAvail().x);
  ImGui::PushTextWrapPos(0);  // a word that is wider than a line
  ImGui::TextUnformatted(all.c_str());
  ImGui::PopTextWrapPos();
}

void Widgets::wrapped(const std::string& words, unsigned color) {
  ImGui::PushStyleColor(ImGuiCol_Text, color);
  wrapped(words);
  ImGui::PopStyleColor();
}

void Widgets::label(const std::string& words, const std::string& sentence, float share) {
  const float width = share * lengths().label;
  ImGui::AlignTextToFramePadding();
  const float left = ImGui::GetCursorPosX();
  const ImVec2 at = ImGui::GetCursorScreenPos();
  // A name that is too long ends at its widget.
  ImGui::PushClipRect(at, {at.x + width - 4, at.y + ImGui::GetFrameHeight()}, true);
  ImGui::TextUnformatted(words.c_str());
  ImGui::PopClipRect();
  tooltip(ImGui::GetItemRectSize().x > width - 4 && !sentence.empty() ? words + "\n" + sentence : sentence);
  ImGui::SameLine(left + width);
  ImGui::SetNextItemWidth(-FLT_MIN);
}

bool Widgets::button(const std::string& name, const char* words, const std::string& sentence) {
  const bool is_pressed = ImGui::Button(words, {-FLT_MIN, 0});
  note(name);
  tooltip(sentence);
  return is_pressed;
}

std::optional<std::size_t> Widgets::buttons(std::span<const Choice> choices, float gap) {
  std::optional<std::size_t> pressed;
  float wanted = 0;
  for (const Choice& choice : choices) wanted += ImGui::CalcTextSize(choice.words.c_str()).x;
  const float each = (ImGui::GetContentRegionAvail().x - wanted - gap * static_cast<float>(choices.size() - 1)) /
                     static_cast<float>(choices.size());
  // Words lie in the middle of a button; less than its usual margin does.
  ImGui::PushStyleVar(ImGuiStyleVar_FramePadding, {0, ImGui::GetStyle().FramePadding.y});
  for (std::size_t k = 0; k < choices.size(); ++k) {
    if (k > 0) ImGui::SameLine(0, gap);
    if (choices[k].is_chosen)
      for (const ImGuiCol color : {ImGuiCol_Button, ImGuiCol_ButtonHovered}) ImGui::PushStyleColor(color, chosen_color);
    const float width = k + 1 < choices.size() ? std::floor(ImGui::CalcTextSize(choices[k].words.c_str()).x + each) : -FLT_MIN;
    if (ImGui::Button(choices[k].words.c_str(), {width, 0})) pressed = k;
    if (choices[k].is_chosen) ImGui::PopStyleColor(2);
    note(choices[k].name);
    tooltip(choices[k].sentence);
  }
  ImGui::PopStyleVar();
  return pressed;
}

std::optional<std::size_t> Widgets::list(const std::string& name, const std::string& shown, std::span<const Choice> choices,
                                         int flags) {
  std::optional<std::size_t> chosen;
  const bool is_open = ImGui::BeginCombo(("##" + name).c_str(), shown.c_str(), flags);
  note(name);
  if (!is_open) return chosen;
  for (std::size_t k = 0; k < choices.size(); ++k) {
    const Choice& choice = choices[k];
    const ImGuiSelectableFlags row_flags = choice.is_enabled ? 0 : ImGuiSelectableFlags_Disabled;
    if (ImGui::Selectable(choice.words.c_str(), choice.is_chosen, row_flags)) chosen = k;
    note(choice.name);
    tooltip(choice.sentence);
  }
  ImGui::EndCombo();
  return chosen;
}

void Widgets::right(const std::string& words) {
  const float room = ImGui::GetContentRegionAvail().x - ImGui::CalcTextSize(words.c_str()).x;
  if (room > 0) ImGui::SetCursorPosX(ImGui::GetCursorPosX() + room);
  ImGui::TextUnformatted(words.c_str());
}

bool Widgets::attempt(const std::function<void()>& work) {
  try {
    work();
    return true;
  } catch (const Error& error) {
    refused_(error.what());
    return false;
  }
}

void Widgets::note_slider(const std::string& name) {
  note(name);
  if (ImGui::IsItemActive() && ImGui::IsMouseDown(ImGuiMouseButton_Left)) is_dragging_ = true;
}

template <class T>
bool Widgets::slider(const char* id, T& value, T low, T high, const char* format, int flags) {
  constexpr ImGuiDataType kind = std::is_same_v<T, int>     ? ImGuiDataType_S32
                                 : std::is_same_v<T, float> ? ImGuiDataType_Float
                                                            : ImGuiDataType_Double;
  // What Dear ImGui writes lies on the grab, which is as bright as the words. Where a number is typed they are its own.
  const bool is_typed = ImGui::TempInputIsActive(ImGui::GetID(id));
  if (!is_typed) ImGui::PushStyleColor(ImGuiCol_Text, ImU32(0));
  const bool is_set = ImGui::SliderScalar(id, kind, &value, &low, &high, format, flags);
  if (is_typed) return is_set;
  ImGui::PopStyleColor();
  char words[64];
  ImGui::DataTypeFormatString(words, sizeof words, kind, &value, format);
  const ImVec2 first = ImGui::GetItemRectMin(), last = ImGui::GetItemRectMax(), size = ImGui::CalcTextSize(words);
  const ImVec2 at((first.x + last.x - size.x) / 2, (first.y + last.y - size.y) / 2);
  const float margin = ImGui::GetStyle().FramePadding.y;
  ImDrawList& list = *ImGui::GetWindowDrawList();
  list.PushClipRect(first, last, true);
  list.AddRectFilled({at.x - margin, at.y - margin / 3}, {at.x + size.x + margin, at.y + size.y + margin / 3}, plate_color,
                     margin);
  list.AddText(at, ImGui::GetColorU32(ImGuiCol_Text), words);
  list.PopClipRect();
  return is_set;
}
template bool Widgets::slider(const char*, int&, int, int, const char*, int);
template bool Widgets::slider(const char*, float&, float, float, const char*, int);
template bool Widgets::slider(const char*, double&, double, double, const char*, int);

template <class T>
bool Widgets::number(const Number<T>& row, std::string& text) {
  T value = row.value();
  const std::string format = (std::is_same_v<T, int> ? "%d" : "%.4g") + unit_words(row.unit());
  const ImGuiSliderFlags flags = row.range().log ? ImGuiSliderFlags_Logarithmic : ImGuiSliderFlags_None;
  const bool is_set = slider("##value", value, row.range().min, row.range().max, format.c_str(), flags);
  if (is_set) text = fmt::format("{}", value);
  return is_set;
}

bool Widgets::parameter(const std::string& name, Parameter& row) {
  ImGui::PushID(name.c_str());
  const std::string sentence = sentence_of(row);
  const bool is_marked = name == marked_;
  if (is_marked) ImGui::PushStyleColor(ImGuiCol_Text, light_color);
  label(std::string(row.name()), sentence);
  if (is_marked) ImGui::PopStyleColor();
  if (is_marked && is_newly_marked_) ImGui::SetScrollHereY();
  bool is_set = false;
  std::string text;
  if (const auto* whole = dynamic_cast<const Number<int>*>(&typed(row))) {
    is_set = number(*whole, text);
  } else if (const auto* real = dynamic_cast<const Number<double>*>(&typed(row))) {
    is_set = number(*real, text);
  } else if (const auto* flag = dynamic_cast<const Flag*>(&typed(row))) {
    bool value = *flag;
    is_set = ImGui::Checkbox("##value", &value);
    text = value ? "true" : "false";
  } else {
    const std::vector<std::string> texts = row.probes();
    std::vector<Choice> choices;
    for (const std::string& choice : texts) choices.push_back({name + "." + choice, choice, "", choice == row.text()});
    const auto chosen = list(name, row.text(), choices);
    is_set = chosen.has_value();
    if (chosen) text = texts[*chosen];
  }
  note_slider(name);
  tooltip(sentence);
  ImGui::PopID();
  return is_set && attempt([&] { row.set(text); });
}

bool Widgets::parameters(const std::string& prefix, Parametrized& object) {
  bool is_set = false;
  for (Parameter* const row : object.parameters()) is_set = parameter(prefix + "." + std::string(row->name()), *row) || is_set;
  return is_set;
}

}  // namespace gnomon::viewer
