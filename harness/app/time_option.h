#pragma once
#include <optional>
#include <string>

#include "app/command_line.h"

namespace gnomon::app {

/// The time at which one scene that moves is shown, for commands of one scene.
struct TimeOption {
  std::optional<double> seconds;
  std::string animation;
};

/// Adds `--time` and `--animation`. `alone` says what the animation does without a time; empty: it needs one.
void add_time_option(Command& command, TimeOption& option, const std::string& alone = "");
/// Makes the scene's reference that of a still at the time; without one the reference gets its canonical form. Throws Error
/// where the scene has a time already.
void put_time(std::string& scene, const TimeOption& option);

}  // namespace gnomon::app
