// What every key and the mouse do.
#include <imgui.h>

#include <algorithm>

#include "app/viewer/mouse.h"
#include "app/viewer/panels.h"
#include "app/viewer/window.h"

namespace gnomon::viewer {

namespace {

/// Keys, or uses of the mouse, under one heading.
struct Group {
  std::string title;
  float key_width;                                             ///< in heights of the font
  float row_lines;                                             ///< how many a row takes, about
  std::vector<std::pair<std::string, std::string>> rows = {};  ///< name and sentence

  float lines() const { return row_lines * static_cast<float>(rows.size()) + 2; }  // with heading and gap
};

std::vector<Group> help_groups() {
  std::vector<Group> groups;
  const KeyRow* before = nullptr;
  for (const KeyRow& row : key_table().rows()) {
    if (!before || row.group != before->group) groups.push_back({row.group, 5.5f, 1});
    // Keys that do the same share a row.
    if (before && row.effect == before->effect)
      groups.back().rows.back().first += ", " + row.name;
    else
      groups.back().rows.emplace_back(row.name, row.sentence);
    before = &row;
  }
  groups.push_back({"Mouse in the picture", 10, 1.5f});
  for (const MouseRow& row : mouse_rows) groups.back().rows.emplace_back(row.name, row.sentence);
  return groups;
}

void draw_group(const Group& group) {
  ImGui::TextUnformatted(group.title.c_str());
  ImGui::Separator();
  if (!ImGui::BeginTable(group.title.c_str(), 2, ImGuiTableFlags_NoSavedSettings)) return;
  ImGui::TableSetupColumn("key", ImGuiTableColumnFlags_WidthFixed, group.key_width * ImGui::GetFontSize());
  ImGui::TableSetupColumn("sentence", ImGuiTableColumnFlags_WidthStretch);
  for (const auto& [name, sentence] : group.rows) {
    ImGui::TableNextColumn();
    ImGui::TextUnformatted(name.c_str());
    ImGui::TableNextColumn();
    Widgets::wrapped(sentence, quiet_text);
  }
  ImGui::EndTable();
  ImGui::Dummy({0, ImGui::GetFontSize() * 0.3f});
}

/// Which group each column begins with, so that the highest column is as low as can be. Groups stay in their order.
std::vector<std::size_t> column_starts(const std::vector<float>& lines, int count) {
  const auto starts_under = [&](float limit) {
    std::vector<std::size_t> starts = {0};
    float done = 0;
    for (std::size_t k = 0; k < lines.size(); ++k) {
      if (done + lines[k] > limit && done > 0) {
        starts.push_back(k);
        done = 0;
      }
      done += lines[k];
    }
    return starts;
  };
  float limit = std::ranges::max(lines);
  std::vector<std::size_t> starts = starts_under(limit);
  for (; starts.size() > static_cast<std::size_t>(count); starts = starts_under(limit)) limit += 0.5f;
  starts.resize(static_cast<std::size_t>(count), lines.size());
  return starts;
}

/// Whole groups in columns of nearly the same height. Returns the height of the highest.
float draw_columns(int count) {
  const std::vector<Group> groups = help_groups();
  std::vector<float> lines;
  for (const Group& group : groups) lines.push_back(group.lines());
  std::vector<std::size_t> starts = column_starts(lines, count);
  starts.push_back(lines.size());
  const float gap = ImGui::GetFontSize(),
              width = (ImGui::GetContentRegionAvail().x - gap * static_cast<float>(count - 1)) / static_cast<float>(count);
  const float height = ImGui::GetContentRegionAvail().y - ImGui::GetFrameHeightWithSpacing();
  float highest = 0;
  for (int column = 0; column < count; ++column) {
    if (column > 0) ImGui::SameLine(0, gap);
    ImGui::PushID(column);
    if (ImGui::BeginChild("column", {width, height})) {
      for (std::size_t k = starts[column]; k < starts[column + 1]; ++k) draw_group(groups[k]);
      highest = std::max(highest, ImGui::GetCursorPosY() + ImGui::GetScrollY());
    }
    ImGui::EndChild();
    ImGui::PopID();
  }
  return highest;
}

}  // namespace

void draw_help(glm::ivec2 window, Session& session) {
  const auto scale = static_cast<float>(pixels_per_unit());
  const ImVec2 all(window.x / scale, window.y / scale);
  // What the columns needed when they were drawn last.
  static float columns_height = 1e6f;
  const float around = ImGui::GetFrameHeightWithSpacing() + ImGui::GetFontSize() * 1.6f;
  const ImVec2 size(std::min(all.x - 40, ImGui::GetFontSize() * 90), std::min(all.y - 40, columns_height + around));
  ImGui::SetNextWindowPos({all.x / 2, all.y / 2}, ImGuiCond_Always, {0.5f, 0.5f});
  ImGui::SetNextWindowSize(size);
  ImGui::PushStyleVar(ImGuiStyleVar_WindowBorderSize, 1);
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {ImGui::GetFontSize(), ImGui::GetFontSize() * 0.8f});
  ImGui::SetNextWindowFocus();
  if (ImGui::Begin("help", nullptr,
                   ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove |
                       ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoNav)) {
    constexpr float least_width = 27;  // of a column, in heights of the font
    columns_height = draw_columns(
        std::clamp(static_cast<int>(ImGui::GetContentRegionAvail().x / (least_width * ImGui::GetFontSize())), 1, 3));
    if (ImGui::Button("Close")) session.shows_help = false;
  }
  ImGui::End();
  ImGui::PopStyleVar(2);
}

}  // namespace gnomon::viewer
