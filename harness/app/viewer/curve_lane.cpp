#include "app/viewer/curve_lane.h"

#include <gnomon/registry.h>

#include <algorithm>

#include "app/viewer/several_lights.h"
#include "measure/notice.h"
#include "measure/score/score.h"

namespace gnomon::viewer {

namespace {

constexpr double worth_going_on = 1.5;  // times the error floor: what comes below is the reference's

/// The mean error of masks of the verdict's frame, one light after the other.
double mean_error(const Verdict& verdict, std::vector<float> masks) {
  const Frame& frame = *verdict.answer->frame;
  const GBuffer& g = frame.gbuffer;
  SideAnswer answer{.frame = verdict.answer->frame, .mask = std::move(masks), .masks = {}, .stage_ms = {}};
  std::shared_ptr<const Together> together;
  if (frame.is_together()) {
    answer.masks = split_masks(answer.mask, frame.lights.size());
    together = put_together(answer, *verdict.reference, verdict.estimates, {});
  }
  const Evidence evidence =
      together ? together->evidence() : evidence_of(g.width, g.height, answer.mask, *verdict.reference, verdict.estimates);
  return measure_metric(Scoring(evidence), "error").value_or(0);
}

}  // namespace

std::vector<int> curve_samples(const Parametrized& technique) {
  std::vector<int> all;
  for (const Parameter* const row : technique.parameters()) {
    const auto* const number = dynamic_cast<const Number<int>*>(row);
    if (!number || row->name() != "samples") continue;
    for (std::int64_t n = 1; n <= number->range().max; n *= 4)
      if (n >= number->range().min) all.push_back(static_cast<int>(n));
  }
  return all;
}

void CurveLane::drop_curve_before(const Selection& next) {
  Selection same = board_.selection;
  same.picked = next.picked;
  if (are_same(same, next)) return;
  ++ticket_;
  board_.state.curve = nullptr;
  interrupt();
}

/// When the left side has been judged at a frame at rest.
Work CurveLane::next() {
  const Selection& selection = board_.selection;
  if (selection.curve == 0 || selection.curve == begun_ || selection.is_moving) return {};
  const std::shared_ptr<const Frame>& frame = board_.state.frame;
  const SideState& left = board_.state.sides[0];
  const std::shared_ptr<const Verdict>& verdict = left.verdict;
  const bool is_judged = verdict && verdict->answer == left.answer && left.answer->frame == frame && verdict->has_causes &&
                         frame->loaded == selection.loaded && is_lit_by(*frame, selection);
  if (!is_judged) return {};
  begun_ = selection.curve;
  return [this, verdict, side = selection.sides[0], ticket = ticket_] { measure(verdict, side, ticket); };
}

void CurveLane::measure(const std::shared_ptr<const Verdict>& verdict, const SideSelection& side, std::uint64_t ticket) {
  const Frame& frame = *verdict->answer->frame;
  SampleCurve curve{.frame = verdict->answer->frame, .samples = {}, .error = {}};
  curve.error_floor = verdict->error_floor.value_or(0);
  const auto show = [&] {
    board_.change([&](EngineState& s) {
      if (ticket == ticket_) s.curve = std::make_shared<const SampleCurve>(curve);
    });
  };
  show();
  try {
    const auto technique = registry().technique(side.technique).make();
    technique->apply(side.settings);
    auto worker = board_.start_worker("curve");
    {
      const std::lock_guard lock(board_.mutex);
      if (ticket != ticket_ || board_.stop) return;
      worker_ = std::move(worker);
    }
    worker_->load({.scene_file = frame.loaded->store->scene_file(), .technique = side.technique, .settings = side.settings});
    for (const int n : curve_samples(*technique)) {
      technique->parameter("samples").set(fmt::format("{}", n));
      worker_->set(technique->settings());
      const Support support = worker_->frame(request_at(frame)).support;
      if (!support) throw Error("{}", support.why());
      curve.error.push_back(mean_error(*verdict, worker_->mask()));
      curve.samples.push_back(n);
      show();
      if (curve.error.back() < worth_going_on * curve.error_floor) break;
    }
  } catch (const std::exception& error) {
    curve.why_not = message_of(error);  // seen where nothing else was selected meanwhile
  }
  curve.is_complete = true;
  board_.end(worker_);
  show();
}

}  // namespace gnomon::viewer
