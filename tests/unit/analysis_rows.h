#pragma once
#include <gnomon/kit/random.h>

#include <cmath>
#include <initializer_list>
#include <numbers>
#include <string>
#include <vector>

#include "analysis/analysis.h"

// Records made by hand, for the tests of analyses.
namespace analysis_rows {
using namespace gnomon;

inline bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

/// Box and Muller 1958.
inline double normal(Random& random) {
  const double radius = std::sqrt(-2 * std::log(1 - random.uniform(0, 1))), turn = 2 * std::numbers::pi * random.uniform(0, 1);
  return radius * std::cos(turn);
}

/// One place, three processes of one repetition each.
inline Record row(const std::string& setting, double relight, double resolve, double wrong_rate,
                  const std::string& scene = "soup") {
  Record r;
  r.scene = scene;
  r.light = r.lights.emplace_back().name = "point";
  r.view = "main";
  const std::size_t colon = setting.find(':');
  r.technique = setting.substr(0, colon);
  if (colon != setting.npos) r.settings = setting.substr(colon + 1);
  for (const auto& [key, value] : split_settings(r.settings)) r.parameters[key] = Json::parse(value);
  r.width = 640;
  r.height = 360;
  r.status = Status::ok;
  r.times(Stage::build) = {{1}, {1}, {1}};
  r.times(Stage::relight) = {{relight}, {relight}, {relight}};
  r.times(Stage::resolve) = {{resolve}, {resolve}, {resolve}};
  r.bytes = 1u << 20;
  r.metrics[Truth::shape] = {{"error", wrong_rate}, {"wrong_rate", wrong_rate}};
  r.classes["T"] = 1000;
  return r;
}

/// The same row on an animation at 60 frames per second: three processes of one repetition each.
inline Record moving(Record r, double update, double relight, double resolve) {
  r.path = "walk";
  r.start = 0;
  r.frame_rate = 60;
  r.times(Stage::update) = {{update}, {update}, {update}};
  r.moving_times(Stage::relight) = {{relight}, {relight}, {relight}};
  r.moving_times(Stage::resolve) = {{resolve}, {resolve}, {resolve}};
  return r;
}

/// As if the best constant mask of its place had this error.
inline Record with_constant(Record r, double constant_error) {
  r.metrics[Truth::shape]["constant_error"] = constant_error;
  return r;
}

/// The same under a disc light, whose reference errs by 0.002.
inline Record soft_row(const std::string& setting, double relight, double resolve, double error,
                       const std::string& scene = "soup") {
  Record r = row(setting, relight, resolve, 0, scene);
  r.light = r.light_kind = "disc";
  r.answer = AnswerKind::fraction;
  r.lights[0].name = r.lights[0].kind = "disc";
  r.lights[0].answer = AnswerKind::fraction;
  r.metrics[Truth::shape] = {{"error", error}, {"wrong_rate", 0.0}, {"error_floor", 0.002}};
  return r;
}

inline std::vector<Record> family(std::initializer_list<int> counts, double exponent) {
  std::vector<Record> records;
  for (const int count : counts) {
    Record r = row("a", 3, 2 * std::pow(count, exponent), 0.1, fmt::format("soup:count={},seed=7", count));
    r.scene_facts = Record::SceneFacts{.meshes = 1, .triangles = static_cast<std::uint64_t>(count)};
    records.push_back(r);
  }
  return records;
}

}  // namespace analysis_rows
