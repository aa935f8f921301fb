#pragma once
#include <string>
#include <vector>

namespace gnomon {

/// Names of settings, "TECHNIQUE:A=1,B=2", without what is said once for all of them.
struct ShortNames {
  std::string heading;             ///< what all share; empty: they share nothing
  std::vector<std::string> names;  ///< one for each setting
};

/// Says what all settings share once: the technique, and values of parameters. A single setting keeps its name.
ShortNames without_shared(const std::vector<std::string>& settings);

/// Further says the parameters of each technique once: "shadow_map: bias, filter", and "slope, pcf" for a setting. Where
/// settings of a technique have different parameters names stay what they are.
ShortNames values_alone(const std::vector<std::string>& settings);

}  // namespace gnomon
