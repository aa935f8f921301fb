#pragma once
#include <gnomon/technique.h>

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace gnomon {

/// More about a technique whose work is done by a process of its own.
class WorksElsewhere {
 public:
  virtual ~WorksElsewhere() = default;
  /// Milliseconds of the last stage by its own clock, which count instead of the harness's. Nothing: the harness's count.
  virtual std::optional<double> own_ms() const = 0;
  /// Name and version of what makes the masks, for records: "three.js r187". Valid after setup; empty: the program itself.
  virtual std::string maker() const = 0;
  /// As Technique::explain, of many pixels in their order: one request costs as much as a thousand.
  virtual std::vector<std::optional<Explanation>> explain_all(std::span<const std::uint32_t> pixels) const = 0;
};

/// Null where the technique works in this process.
inline const WorksElsewhere* elsewhere(const Technique& technique) { return dynamic_cast<const WorksElsewhere*>(&technique); }

/// A technique's explanations of pixels of its last resolve, in their order.
inline std::vector<std::optional<Explanation>> explain_all(const Technique& technique, std::span<const std::uint32_t> pixels) {
  if (const WorksElsewhere* const there = elsewhere(technique)) return there->explain_all(pixels);
  std::vector<std::optional<Explanation>> all;
  for (const std::uint32_t pixel : pixels) all.push_back(technique.explain(pixel));
  return all;
}

}  // namespace gnomon
