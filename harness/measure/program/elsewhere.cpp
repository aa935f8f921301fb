#include "measure/program/elsewhere.h"

namespace gnomon {

std::vector<std::optional<Explanation>> explain_all(const Technique& technique, std::span<const std::uint32_t> pixels) {
  if (const WorksElsewhere* const there = elsewhere(technique)) return there->explain_all(pixels);
  std::vector<std::optional<Explanation>> all;
  all.reserve(pixels.size());
  for (const std::uint32_t pixel : pixels) all.push_back(technique.explain(pixel));
  return all;
}

}  // namespace gnomon
