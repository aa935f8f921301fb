// The worker of a side and the order of its work, the most urgent first.
#include "app/viewer/side_lane.h"

#include <gnomon/registry.h>

#include <algorithm>

#include "app/viewer/several_lights.h"
#include "measure/notice.h"

namespace gnomon::viewer {

namespace {

constexpr int stage_count = std::size(stage_names);

/// Whether the side shows the reference, which the engine has anyway: as it is, and without its debug layers.
bool shows_reference(const SideSelection& selection) {
  return selection.settings.empty() && selection.layer.empty() &&
         registry().technique(selection.technique).about.role == gnomon::Role::reference;
}

}  // namespace

bool SideLane::has_finished(std::uint64_t frame) const {
  const SideState& s = state();
  if (s.is_reference) return board_.state.reference && board_.state.reference->frame->number >= frame;
  return s.phase == Phase::failed || s.phase == Phase::starting || frame_ > frame ||
         (frame_ == frame && (fresh_ == stage_count || !is_supported_));
}

void SideLane::report_progress(SideState& report) const {
  if (!since_) return;
  report.seconds = std::chrono::duration<double>(Clock::now() - *since_).count();
  if (worker_) report.progress = worker_->progress();
}

void SideLane::interrupt() {
  causes_.give_up();
  if (worker_) worker_->interrupt();
}

SideLane::LoadedTechnique SideLane::selected_technique(const Selection& selection) const {
  return {selection.loaded, selection.sides[index_].technique, selection.sides[index_].attempt};
}

void SideLane::drop_work_before(const Selection& selection) {
  if (board_.selection.sides[index_] != selection.sides[index_]) causes_.give_up();
  if (!loaded_ || *loaded_ == selected_technique(selection)) return;
  is_given_up_ = true;
  if (worker_) worker_->interrupt();
}

Work SideLane::next() {
  const SideSelection& selection = board_.selection.sides[index_];
  const std::shared_ptr<const Frame>& frame = board_.state.frame;
  // What is shown is of the selected scene, or there is nothing to do yet.
  if (!frame || frame->loaded != board_.selection.loaded || selection.technique.empty()) return {};
  if (shows_reference(selection)) return show_reference(frame);
  if (Work work = next_answer(selection, frame)) return work;
  const bool is_answered = !has_failed_ && frame_ == frame->number && is_supported_ && fresh_ == stage_count;
  return is_answered ? next_finding(selection, frame) : Work{};
}

/// The state of the reference is the side's, and no worker is needed.
Work SideLane::show_reference(const std::shared_ptr<const Frame>& frame) {
  const auto& reference = board_.state.reference;
  const bool is_done = reference && reference->frame == frame && reference->is_complete;
  const bool has_none = is_done && !reference->why_not.empty();
  SideState& s = state();
  s = {};
  s.is_reference = true;
  s.phase = has_none ? Phase::unsupported : is_done ? Phase::done : Phase::working;
  s.words = has_none ? reference->why_not : is_done ? "" : "reference";
  loaded_.reset();
  return worker_ ? [this] { board_.end(worker_); } : Work{};
}

/// On the way to the mask of the frame: the worker, its settings, the frame, the stages.
Work SideLane::next_answer(const SideSelection& selection, const std::shared_ptr<const Frame>& frame) {
  const LoadedTechnique selected = selected_technique(board_.selection);
  const bool is_set = settings_ == selection.settings;
  if (loaded_ != selected || is_given_up_ || (!is_set && has_failed_))
    return [this, selected, settings = selection.settings] { start(selected, settings); };
  if (!is_set) return guarded([this, settings = selection.settings] { set(settings); });
  if (has_failed_) return {};
  if (frame_ != frame->number) return guarded([this, frame] { go_to(frame); });
  if (!is_supported_) return {};
  if (fresh_ < stage_count || repeat_ != board_.selection.repeat)
    return guarded([this, frame, repeat = board_.selection.repeat] { answer(frame, repeat); });
  return {};
}

/// What is found out about an answer, by what it takes: a layer, wrong pixels, counts, the picked pixel, causes.
Work SideLane::next_finding(const SideSelection& selection, const std::shared_ptr<const Frame>& frame) {
  SideState& s = state();
  const std::shared_ptr<const SideAnswer>& last = s.answer;
  if (selection.layer.empty())
    s.layer = nullptr;
  else if (!s.layer || s.layer->answer != last || s.layer->layer.name != selection.layer)
    return guarded([this, last, layer = selection.layer] { draw_layer(last, layer); });
  if (!frame->is_full()) return {};
  const std::shared_ptr<const ReferenceState>& reference = board_.state.reference;
  const bool has_classes = reference && reference->frame == frame && !reference->classes.empty();
  if (has_classes && (!s.verdict || s.verdict->answer != last))
    return guarded([this, last, reference] { count_wrong(last, reference); });
  if (board_.selection.is_moving) return {};
  if (s.counted_answer != last) return guarded([this, last] { count(last); });
  const auto& picked = board_.selection.picked;
  if (s.explained != picked || (picked && s.explained_answer != last))
    return guarded([this, last, picked] { explain_picked(last, picked); });
  if (has_classes && !s.verdict->has_causes && reference->is_complete)
    return guarded([this, verdict = s.verdict, reference] { find_causes_of(verdict, reference); });
  return {};
}

/// Work whose failure is the side's failure.
Work SideLane::guarded(Work work) {
  return [this, work = std::move(work)] {
    try {
      work();
    } catch (const std::exception& error) {
      fail(message_of(error));
    }
  };
}

void SideLane::fail(const std::string& why) {
  std::unique_ptr<WorkerClient> gone;
  change([&](SideState&) {
    since_.reset();
    causes_.give_up();
    gone = std::move(worker_);
    // Interrupted, because something else was selected: no failure of the technique.
    if (board_.stop || is_given_up_) {
      loaded_.reset();
      return;
    }
    has_failed_ = true;
    show_nothing(Phase::failed, why);
  });
}

/// Under the lock: there is no answer, for this reason.
void SideLane::show_nothing(Phase phase, const std::string& why) {
  SideState& s = state();
  s.phase = phase;
  s.words = why;
  s.answer = nullptr;
  s.verdict = nullptr;
  s.layer = nullptr;
}

void SideLane::start(const LoadedTechnique& selected, const std::string& settings) {
  std::unique_ptr<WorkerClient> gone;
  bool is_selected = false;
  change([&](SideState& s) {
    gone = std::move(worker_);
    is_selected = selected == selected_technique(board_.selection);
    if (!is_selected) return;
    loaded_ = selected;
    is_given_up_ = false;
    settings_ = settings;
    has_failed_ = false;
    fresh_ = 0;
    frame_ = 0;
    tells_parts_ = false;
    stage_ms_ = {};
    s = {};
    s.words = "start";
  });
  gone.reset();
  if (!is_selected) return;
  guarded([&] {
    auto worker = board_.start_worker(fmt::format("{}", index_));
    {
      const std::lock_guard lock(board_.mutex);
      worker_ = std::move(worker);
      if (board_.stop || is_given_up_) worker_->interrupt();
    }
    Call(*this, "start")
        ->load({.scene_file = selected.scene->store->scene_file(), .technique = selected.technique, .settings = settings});
    change([&](SideState& s) {
      if (worker_->gl()) s.renderer = worker_->gl()->renderer;
    });
  })();
}

void SideLane::set(const std::string& settings) {
  settings_ = settings;
  Call(*this, "set")->set(settings);
  // Support may depend on a parameter, and is reported for a frame.
  const std::lock_guard lock(board_.mutex);
  frame_ = 0;
}

/// Has the worker go to a frame.
Support SideLane::set_frame(const Frame& frame, const std::string& words) {
  FrameReply reply = Call(*this, words)->frame(request_at(frame));
  light_supports_ = std::move(reply.lights);
  return reply.support;
}

void SideLane::go_to(const std::shared_ptr<const Frame>& frame) {
  support_ = set_frame(*frame, "frame");
  change([&](SideState& s) {
    frame_ = frame->number;
    is_supported_ = static_cast<bool>(support_);
    if (is_supported_)
      s.phase = Phase::working;
    else
      show_nothing(Phase::unsupported, support_.why());
  });
}

/// Build and update replace each other: the one that was done last has a time.
void SideLane::note_time(Stage stage, double ms) {
  if (stage == Stage::build) stage_ms_[static_cast<int>(Stage::update)].reset();
  if (stage == Stage::update) stage_ms_[static_cast<int>(Stage::build)].reset();
  stage_ms_[static_cast<int>(stage)] = ms;
}

/// Does the stages that are out of date, and resolve in any case; the mask.
std::vector<float> SideLane::resolve_mask(bool is_timed) {
  // A build brings along what update would do.
  for (int stage = std::min(fresh_, stage_count - 1); stage < stage_count; stage = std::max(stage + 1, fresh_)) {
    const double ms = Call(*this, std::string(stage_names[stage]))->time(static_cast<Stage>(stage));
    if (is_timed) note_time(static_cast<Stage>(stage), ms);
  }
  return Call(*this, "mask")->mask();
}

void SideLane::answer(const std::shared_ptr<const Frame>& frame, std::uint64_t repeat) {
  auto answer = std::make_shared<SideAnswer>();
  answer->frame = frame;
  answer->support = support_;
  answer->mask = resolve_mask(true);
  if (frame->is_together()) {
    answer->masks = split_masks(answer->mask, frame->lights.size());
    ShownMasks shown = shown_together(*frame, frame->gbuffer, answer->masks);
    answer->mask = std::move(shown.mask);
    answer->channels = std::move(shown.channels);
  }
  answer->stage_ms = stage_ms_;
  change([&](SideState& s) {
    s.phase = Phase::done;
    s.words = support_.why();
    // A repetition with the same masks keeps the answer, and with it the findings about it.
    const bool is_repeated = s.answer && s.answer->frame == frame && repeat_ != repeat && s.answer->mask == answer->mask &&
                             s.answer->masks == answer->masks;
    if (!is_repeated) s.answer = answer;
    s.newest_ms = answer->stage_ms;
    ++s.answer_count;
    repeat_ = repeat;
  });
}

}  // namespace gnomon::viewer
