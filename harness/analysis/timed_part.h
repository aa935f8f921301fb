#pragma once
#include <string_view>

#include "measure/record/record.h"

namespace gnomon {

/// One series of times of a row: a stage, or of a row whose geometry moves a stage in the frames after `update`.
struct TimedPart {
  Stage stage = Stage::setup;
  bool is_moving = false;  ///< of Record::moving_stages
  constexpr TimedPart(Stage stage, bool is_moving = false) : stage(stage), is_moving(is_moving) {}
  bool operator==(const TimedPart&) const = default;
};

/// In the order of tables.
inline constexpr TimedPart all_parts[] = {Stage::setup,   Stage::build,           Stage::update,         Stage::relight,
                                          Stage::resolve, {Stage::relight, true}, {Stage::resolve, true}};
/// Those that are timed again and again: all but setup.
inline constexpr std::span repeated_parts = std::span(all_parts).subspan<1>();

/// "relight", "moving_relight".
inline constexpr std::string_view name(TimedPart part) {
  if (!part.is_moving) return name(part.stage);
  return part.stage == Stage::relight ? "moving_relight" : "moving_resolve";
}

inline const ProcessTimes& times_of(const Record& record, TimedPart part) {
  return part.is_moving ? record.moving_times(part.stage) : record.times(part.stage);
}

/// Whether the row follows an animation frame by frame.
inline bool moves_geometry(const Record& record) { return record.frame_rate.has_value(); }

}  // namespace gnomon
