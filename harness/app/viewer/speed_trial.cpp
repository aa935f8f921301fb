#include "app/viewer/speed_trial.h"

#include <cmath>

#include "app/viewer/moves.h"
#include "measure/statistics/statistics.h"
#include "report/table/digits.h"
#include "report/table/text_table.h"

namespace gnomon::viewer {

namespace {

enum Situation { at_rest, light_moves, camera_moves, full_frames };

}  // namespace

/// The camera and the light swing to and fro, so that a long trial stays where something is to be seen.
void SpeedTrial::step(Session& session) {
  ++steps_;
  const double swing = std::sin(0.05 * steps_);
  if (situation_ == at_rest) return session.do_again();
  if (situation_ == light_moves) {
    const Scene& scene = *session.scene();
    const glm::dvec3 place = light_place(scene, light_);
    session.set_light(light_moved_to(scene, light_, place + glm::dvec3(10 * key_step(scene) * swing, 0, 0)));
  } else {
    session.set_view(orbit(view_, {200 * swing, 0}, session.selection().height));
    session.set_full_while_moving(situation_ == full_frames);
  }
  session.mark_moving();
}

void SpeedTrial::steer(Session& session, const EngineState& state, bool is_finished, double now) {
  if (is_over() || !state.frame) return;
  if (!is_running_) {
    if (!is_finished || session.selection().is_moving) return;
    is_running_ = true;
    has_stepped_ = false;
    start_ = last_picture_ = now;
    view_ = session.selection().view;
    light_ = session.selection().light;
    steps_ = 0;
    const auto shown = left_frame(state);
    shown_ = {shown ? shown->number : 0, state.sides[0].answer_count};  // there already
  }
  if (now - start_ >= seconds_) {
    is_running_ = false;
    rows_[situation_].seconds = now - start_;
    ++situation_;
    session.set_full_while_moving(false);
    session.set_view(view_);
    session.set_light(light_);
    return;
  }
  if (has_stepped_ && !is_answered(state)) {
    if (situation_ != at_rest) session.mark_moving();
    return;
  }
  step_frame_ = state.frame->number;
  step_answer_ = state.sides[0].answer_count;
  has_stepped_ = true;
  step(session);
}

/// The frame that the left side's mask is of.
std::shared_ptr<const Frame> SpeedTrial::left_frame(const EngineState& state) {
  const SideState& left = state.sides[0];
  if (left.is_reference) return state.reference ? state.reference->frame : nullptr;
  return left.answer ? left.answer->frame : nullptr;
}

bool SpeedTrial::is_answered(const EngineState& state) const {
  if (situation_ == at_rest) return state.sides[0].is_reference || state.sides[0].answer_count != step_answer_;
  const auto frame = left_frame(state);
  return frame && frame->number > step_frame_;
}

void SpeedTrial::presented(const EngineState& state, double now) {
  const auto frame = left_frame(state);
  const SideState& left = state.sides[0];
  const std::pair newest{frame ? frame->number : 0, left.answer_count};
  if (!is_running_ || !frame || newest == shown_) return;
  shown_ = newest;
  Measured& row = rows_[situation_];
  row.gaps.push_back(1000 * (now - last_picture_));
  last_picture_ = now;
  row.width = frame->gbuffer.width;
  row.height = frame->gbuffer.height;
  if (const auto ms = left.newest_ms[static_cast<int>(Stage::relight)]) row.relight.push_back(*ms);
  if (const auto ms = left.newest_ms[static_cast<int>(Stage::resolve)]) row.resolve.push_back(*ms);
}

std::string SpeedTrial::table() const {
  TextTable table({{"situation", ""},
                   {"pictures", "1/s", Align::right},
                   {"median", "ms", Align::right},
                   {"95 %", "ms", Align::right},
                   {"frame", "pixel", Align::right},
                   {"relight", "ms", Align::right},
                   {"resolve", "ms", Align::right}});
  for (std::size_t k = 0; k < std::size(titles); ++k) {
    const Measured& row = rows_[k];
    const auto time = [](const std::vector<double>& values) {
      return values.empty() ? std::string("-") : milliseconds(median(values));
    };
    table.add_row({titles[k], rounded(static_cast<double>(row.gaps.size()) / row.seconds, 3), time(row.gaps),
                   row.gaps.empty() ? "-" : milliseconds(quantile(row.gaps, 0.95)), fmt::format("{}x{}", row.width, row.height),
                   k == light_moves ? time(row.relight) : "-", time(row.resolve)});
  }
  return table.text();
}

}  // namespace gnomon::viewer
