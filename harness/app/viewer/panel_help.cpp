// What every key and the mouse do.
#include <imgui.h>

#include <algorithm>
#include <vector>

#include "app/viewer/keys.h"
#include "app/viewer/mouse.h"
#include "app/viewer/panels.h"
#include "app/viewer/style.h"
#include "app/viewer/window.h"

namespace gnomon::viewer {

namespace {

void draw_row(std::string_view key, std::string_view sentence) {
  ImGui::TableNextRow();
  ImGui::TableNextColumn();
  ImGui::TextUnformatted(key.data(), key.data() + key.size());
  ImGui::TableNextColumn();
  ImGui::PushStyleColor(ImGuiCol_Text, quiet_text);
  ImGui::TextWrapped("%.*s", static_cast<int>(sentence.size()), sentence.data());
  ImGui::PopStyleColor();
}

bool begin_group(std::string_view title, float key_width) {
  ImGui::TextUnformatted(title.data(), title.data() + title.size());
  ImGui::Separator();
  ImGui::PushID(title.data());
  const bool is_begun = ImGui::BeginTable("keys", 2, ImGuiTableFlags_NoSavedSettings);
  if (is_begun) {
    ImGui::TableSetupColumn("key", ImGuiTableColumnFlags_WidthFixed, key_width);
    ImGui::TableSetupColumn("sentence", ImGuiTableColumnFlags_WidthStretch);
  } else {
    ImGui::PopID();
  }
  return is_begun;
}

void end_group() {
  ImGui::EndTable();
  ImGui::PopID();
  ImGui::Dummy({0, ImGui::GetFontSize() * 0.3f});
}

/// Rows first .. end - 1 are one group.
struct Group {
  std::size_t first, end;
  float lines() const { return static_cast<float>(end - first) + 2; }  // with heading and gap
};

std::vector<Group> key_groups() {
  std::vector<Group> groups;
  const std::span<const KeyRow> rows = key_table().rows();
  for (std::size_t k = 0; k < rows.size(); ++k) {
    if (k == 0 || rows[k].group != rows[k - 1].group) groups.push_back({k, k});
    groups.back().end = k + 1;
  }
  return groups;
}

void draw_keys(const Group& group) {
  const std::span<const KeyRow> rows = key_table().rows();
  if (!begin_group(rows[group.first].group, ImGui::GetFontSize() * 5.5f)) return;
  for (std::size_t k = group.first; k < group.end; ++k) {
    // Keys that do the same share a row.
    std::string names(rows[k].name);
    for (; k + 1 < group.end && rows[k + 1].effect == rows[k].effect; ++k) names += fmt::format(", {}", rows[k + 1].name);
    draw_row(names, rows[k].sentence);
  }
  end_group();
}

void draw_mouse() {
  if (!begin_group("Mouse in the picture", ImGui::GetFontSize() * 10)) return;
  for (const MouseRow& row : mouse_rows()) draw_row(row.name, row.sentence);
  end_group();
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

/// Whole groups in columns of nearly the same height. Answers the height of the highest.
float draw_columns(int count) {
  const std::vector<Group> groups = key_groups();
  std::vector<float> lines;
  for (const Group& group : groups) lines.push_back(group.lines());
  lines.push_back(1.5f * static_cast<float>(mouse_rows().size()) + 2);
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
      for (std::size_t k = starts[column]; k < starts[column + 1]; ++k)
        if (k < groups.size())
          draw_keys(groups[k]);
        else
          draw_mouse();
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
