// Error against samples at the frame at rest, measured by a worker of its own, so that the side's has nothing to take back.
#include <gnomon/registry.h>

#include <algorithm>

#include "app/viewer/engine_body.h"
#include "app/viewer/several_lights.h"
#include "measure/notice.h"

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
  const ErrorCounts errors = Scoring(evidence).error_counts();
  return errors.error_sum / static_cast<double>(std::max<std::size_t>(errors.tested, 1));
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

/// Under the lock, before the selection changes: a curve is of what was selected when it was asked for.
void Engine::Body::drop_curve_before(const Selection& next) {
  Selection same = selection;
  same.picked = next.picked;
  if (are_same(same, next)) return;
  ++curve_ticket;
  state.curve = nullptr;
  if (curve_worker) curve_worker->interrupt();
}

/// When the left side has been judged at a frame at rest.
Engine::Body::Work Engine::Body::next_curve() {
  if (selection.curve == 0 || selection.curve == begun_curve || selection.is_moving) return {};
  const SideState& left = state.sides[0];
  const std::shared_ptr<const Verdict>& verdict = left.verdict;
  const bool is_judged = verdict && verdict->answer == left.answer && left.answer->frame == state.frame &&
                         verdict->has_causes && state.frame->loaded == selection.loaded && is_lit_by(*state.frame, selection);
  if (!is_judged) return {};
  begun_curve = selection.curve;
  return [this, verdict, side = selection.sides[0], ticket = curve_ticket] { measure_curve(verdict, side, ticket); };
}

void Engine::Body::measure_curve(const std::shared_ptr<const Verdict>& verdict, const SideSelection& side,
                                 std::uint64_t ticket) {
  SampleCurve curve{.frame = verdict->answer->frame, .samples = {}, .error = {}};
  curve.error_floor = verdict->error_floor.value_or(0);
  const auto show = [&] {
    change([&](EngineState& s) {
      if (ticket == curve_ticket) s.curve = std::make_shared<const SampleCurve>(curve);
    });
  };
  show();
  try {
    const auto technique = registry().technique(side.technique).make();
    technique->apply(side.settings);
    auto worker = std::make_unique<WorkerClient>(workers, scratch.path() / "curve", timeout_seconds);
    {
      const std::lock_guard lock(mutex);
      if (ticket != curve_ticket || stop) return;
      curve_worker = std::move(worker);
    }
    curve_worker->load(
        {.scene_file = curve.frame->loaded->store->scene_file(), .technique = side.technique, .settings = side.settings});
    for (const int n : curve_samples(*technique)) {
      technique->parameter("samples").set(fmt::format("{}", n));
      curve_worker->set(technique->settings());
      const Frame& frame = *curve.frame;
      const GBuffer& g = frame.gbuffer;
      const Support support =
          curve_worker
              ->frame({.gbuffer_file = *frame.file,
                       .width = g.width,
                       .height = g.height,
                       .truth = g.truth,
                       .seen = FreeLightAndView{{frame.all_lights().begin(), frame.all_lights().end()}, g.view}})
              .support;
      if (!support) throw Error("{}", support.why());
      curve.error.push_back(mean_error(*verdict, curve_worker->mask()));
      curve.samples.push_back(n);
      show();
      if (curve.error.back() < worth_going_on * curve.error_floor) break;
    }
  } catch (const std::exception& error) {
    curve.why_not = message_of(error);  // seen where nothing else was selected meanwhile
  }
  curve.is_complete = true;
  std::unique_ptr<WorkerClient> gone;
  {
    const std::lock_guard lock(mutex);
    gone = std::move(curve_worker);
  }
  gone.reset();
  show();
}

}  // namespace gnomon::viewer
