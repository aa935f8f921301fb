#pragma once
#include <cmath>
#include <cstdlib>

#include "report/figure/figure_axis.h"

// Rows of figures, and how their programs are searched.
namespace figure_rows {

using namespace gnomon;

inline bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

inline Record row(int size, double cost, double wrong, const std::string& scene = "soup") {
  Record r;
  r.scene = scene;
  r.light = "point";
  r.technique = "map";
  r.settings = fmt::format("size={}", size);
  r.parameters = {{"size", size}};
  r.status = Status::ok;
  for (const Stage stage : {Stage::build, Stage::relight, Stage::resolve})
    r.times(stage) = {{cost}, {cost * 1.5}, {cost / 1.5}};
  r.metrics[Truth::shape] = {{"error", wrong}, {"wrong_rate", wrong}};
  r.classes["T"] = 100;
  r.causes = {{"acne", 3}, {"edge_resolution", 1}};
  r.path = "slide";
  r.frames = {{"error", {wrong, wrong / 2, std::nullopt}}};
  return r;
}

inline std::vector<Record> some() { return {row(256, 1, 0.2), row(512, 2, 0.1), row(1024, 4, 0)}; }

/// What follows the first `before` in the text, as a number.
inline double number_after(const std::string& text, const std::string& before) {
  const std::size_t at = text.find(before);
  return at == text.npos ? NAN : std::strtod(text.c_str() + at + before.size(), nullptr);
}

}  // namespace figure_rows
