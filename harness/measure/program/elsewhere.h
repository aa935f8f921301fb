#pragma once
#include <gnomon/technique.h>

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace gnomon {

/// What a technique says, beside what every technique does, whose work a process of its own does.
class WorksElsewhere {
 public:
  virtual ~WorksElsewhere() = default;
  /// Milliseconds of the last stage by its own clock: these count then, and the harness's own clock stands beside them.
  /// Nothing: the harness's counts.
  virtual std::optional<double> own_ms() const = 0;
  /// Name and version of what makes the masks: "three.js r187". Known after setup; records have it. Empty: nothing else.
  virtual std::string maker() const = 0;
  /// As Technique::explain, of many pixels in their order: one question costs as much as a thousand.
  virtual std::vector<std::optional<Explanation>> explain_all(std::span<const std::uint32_t> pixels) const = 0;
};

/// Null where the technique works in this process.
inline const WorksElsewhere* elsewhere(const Technique& technique) { return dynamic_cast<const WorksElsewhere*>(&technique); }

/// What a technique says of pixels of its last resolve, in their order.
std::vector<std::optional<Explanation>> explain_all(const Technique& technique, std::span<const std::uint32_t> pixels);

}  // namespace gnomon
