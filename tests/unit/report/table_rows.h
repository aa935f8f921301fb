#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>

#include "report/table/layout.h"
#include "report/table/table.h"

// Rows of tables, and how texts are searched.
namespace table_rows {

using namespace gnomon;

inline std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

inline bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

/// The line that holds `part`; empty when none does.
inline std::string line_with(const std::string& text, const std::string& part) {
  for (const std::string& line : lines_of(text))
    if (has(line, part)) return line;
  return "";
}

inline Record row(const std::string& technique, double resolve, double wrong_rate, const std::string& scene = "soup") {
  Record r;
  r.job = technique + scene;
  r.scene = scene;
  r.light = "point";
  r.light_kind = "point";
  r.view = "main";
  r.technique = technique;
  r.width = 640;
  r.height = 480;
  r.status = Status::ok;
  r.support = Support::Kind::full;
  r.times(Stage::setup) = {{100}, {101}, {102}, {103}, {104}};
  r.times(Stage::resolve) = {{resolve}, {resolve * 2}, {resolve}, {resolve}, {resolve / 2}};
  r.bytes = 3u << 20;
  r.metrics[Truth::shape] = {
      {"error", wrong_rate}, {"wrong_rate", wrong_rate}, {"tested_share", 0.95}, {"displacement_mean", std::nullopt}};
  r.metrics[Truth::mesh] = {{"wrong_rate", wrong_rate / 2}};
  r.context = {{"gl_renderer", "a renderer"}, {"processor", "an abacus"}, {"threads", 2}, {"commit", "abc123"}};
  return r;
}

inline Record refusal(const std::string& technique, Status status, const std::string& reason) {
  Record r = row(technique, 1, 0);
  r.status = status;
  r.support = status == Status::failed ? std::nullopt : std::optional(Support::Kind::unsupported);
  r.reason = reason;
  r.stages = {};
  r.bytes.reset();
  r.metrics.clear();
  return r;
}

}  // namespace table_rows
