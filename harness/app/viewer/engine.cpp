// The threads of the engine and their work: scenes are loaded, and frames made of what is selected, smaller ones while
// something moves, so that they keep up.
#include "app/viewer/engine.h"

#include <gnomon/error.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "app/viewer/compose.h"
#include "app/viewer/engine_side.h"
#include "measure/notice.h"
#include "measure/scene/load.h"
#include "measure/worker/worker_frame_maker.h"

namespace gnomon::viewer {

namespace fs = std::filesystem;

namespace {

constexpr double frame_budget_ms = 40;  // with what the window itself takes: 20 pictures a second

/// As for `gnomon render`: without curved shapes both truths are one.
Truth truth_of(const Selection& selection) {
  return selection.loaded->scene.has_curved_shapes() ? selection.truth : Truth::shape;
}

/// Whether a frame is of the selected scene, size and truth, from the selected view.
bool shows_view(const Frame* frame, const Selection& selection) {
  return frame && frame->loaded == selection.loaded && frame->picture_width == selection.width &&
         frame->picture_height == selection.height && frame->gbuffer.truth == truth_of(selection) &&
         are_same(frame->gbuffer.view, selection.view);
}

/// What the picture receives of all lights without shadows, in their order.
std::vector<double> received_light_of(const Frame& frame) {
  std::vector<double> received = received_light(frame.gbuffer, frame.all_lights()[0]);
  for (const Light& light : frame.all_lights().subspan(1)) {
    const std::vector<double> more = received_light(frame.gbuffer, light);
    for (std::size_t i = 0; i < received.size(); ++i) received[i] += more[i];
  }
  return received;
}

/// Throws WorkerFailure for a scene that brings the ray tracer down, which the viewer's own process uses from then on.
void try_in_a_worker(const Scene& scene, const fs::path& folder, const std::string& program) {
  const ScratchFolder trial = ScratchFolder::at(folder / "trial");
  FrameStore frames(scene, trial.path(), std::make_unique<WorkerFrameMaker>(trial.path() / "frame", program));
  const View& view = scene.views.front();
  for (const Truth truth : {Truth::shape, Truth::mesh}) {
    const FrameKey key{view, 64, 36, truth};
    frames.gbuffer(key);
    for (const Light& light : scene.lights)
      if (reference_support(scene, light, view)) frames.reference(key, light);
  }
}

int divided(int size, int divisor) { return std::max(1, (size + divisor - 1) / divisor); }

}  // namespace

Engine::Body::Body(WorkerOptions the_workers, double timeout, std::function<void()> on_change)
    : workers(std::move(the_workers)), timeout_seconds(timeout), changed(std::move(on_change)) {
  for (int k = 0; k < 2; ++k) sides[k] = std::make_unique<Side>(*this, k);
  for (int lane = 0; lane < lane_count; ++lane) threads.emplace_back([this, lane] { serve(static_cast<Lane>(lane)); });
}

Engine::Body::~Body() {
  {
    const std::lock_guard lock(mutex);
    stop = true;
    for (const auto& side : sides) side->interrupt();
    if (curve_worker) curve_worker->interrupt();
    refinement.give_up();
    news.notify_all();
  }
  for (std::thread& thread : threads) thread.join();
}

void Engine::Body::wake_threads() {
  ++state.number;
  state.is_finished = false;
  std::ranges::fill(is_idle, false);
  news.notify_all();
}

Engine::Body::Work Engine::Body::next(Lane lane) {
  if (lane == loading) return next_scene();
  if (lane == framing) return next_frame();
  if (lane == measuring) return next_curve();
  return lane == refining ? next_reference() : sides[lane - left_side]->next();
}

void Engine::Body::serve(Lane lane) {
  // What makes the picture better must not hold up what makes it.
  if (lane == refining || lane == measuring) setpriority(PRIO_PROCESS, static_cast<id_t>(syscall(SYS_gettid)), 5);
  std::unique_lock lock(mutex);
  while (!stop) {
    if (const Work work = next(lane)) {
      lock.unlock();
      work();
      lock.lock();
      continue;
    }
    is_idle[lane] = true;
    if (!state.is_finished && std::ranges::all_of(is_idle, std::identity{})) {
      state.is_finished = true;
      ++state.number;
      lock.unlock();
      changed();
      lock.lock();
      if (!is_idle[lane] || stop) continue;
    }
    news.wait(lock);
  }
}

Engine::Body::Work Engine::Body::next_scene() {
  if (selection.scene.empty() || selection.scene == tried_scene) return {};
  tried_scene = selection.scene;
  state.scene_error.clear();
  if (state.loaded && state.loaded->reference == selection.scene) return {};
  state.is_loading = true;
  return [this, reference = selection.scene] {
    changed();  // it may take long
    std::shared_ptr<LoadedScene> loaded = std::exchange(offered, nullptr);
    std::string trouble;
    try {
      if (!loaded || loaded->reference != reference)
        loaded = std::make_shared<LoadedScene>(LoadedScene{reference, load_scene(reference)});
      try_in_a_worker(loaded->scene, scratch.path(), workers.program);
      auto store = std::make_unique<FrameStore>(loaded->scene, scratch.path());
      // Made here, because they are made on first use, and not for two threads at once.
      for (const Truth truth : {Truth::shape, Truth::mesh}) {
        store->everything(truth);
        store->casters(truth);
      }
      // Its file for the workers goes with it.
      const auto end = [file = store->scene_file()](FrameStore* gone) {
        std::error_code ignored;
        fs::remove(file, ignored);
        delete gone;
      };
      loaded->store = {store.release(), end};
    } catch (const std::exception& error) {
      trouble = message_of(error);
    }
    change([&](EngineState& s) {
      s.is_loading = false;
      s.scene_error = trouble;
      if (trouble.empty()) s.loaded = loaded;
    });
  };
}

int PreviewDivisor::next() const {
  const double now = ms_[value_];
  if (now == 0) return value_;
  if (now <= frame_budget_ms) {
    if (value_ == 1) return 1;
    const double bigger = ms_[value_ - 1] > 0 ? ms_[value_ - 1] : now * value_ * value_ / ((value_ - 1.0) * (value_ - 1.0));
    return bigger <= frame_budget_ms ? value_ - 1 : value_;
  }
  // Smaller frames are worth it that save at least this part of what the pixels that they spare are of all.
  const auto worth = [](int divisor) { return 1 - 0.4 * (1 - std::pow((divisor - 1.0) / divisor, 2)); };
  if (value_ < largest && (ms_[value_ + 1] == 0 || ms_[value_ + 1] < worth(value_ + 1) * now)) return value_ + 1;
  return value_ > 1 && ms_[value_ - 1] > 0 && now > worth(value_) * ms_[value_ - 1] ? value_ - 1 : value_;
}

void PreviewDivisor::took(double ms) {
  // A frame now and then is slow for reasons of its own.
  double& known = ms_[value_];
  known = known == 0 ? ms : 0.7 * known + 0.3 * ms;
  value_ = next();
}

void PreviewDivisor::forget() { ms_ = {}; }

void PreviewDivisor::expect(double full_ms) {
  if (std::ranges::any_of(ms_, [](double ms) { return ms > 0; })) return;
  while (value_ < largest && full_ms > frame_budget_ms * value_ * value_) ++value_;
}

std::shared_ptr<const fs::path> Engine::Body::write_shared(const GBuffer& gbuffer) {
  const fs::path file = scratch.path() / fmt::format("{}.gbuffer", ++gbuffer_count);
  write_gbuffer(file, gbuffer);
  return {new fs::path(file), [](const fs::path* path) {
            std::error_code ignored;
            fs::remove(*path, ignored);
            delete path;
          }};
}

Engine::Body::Work Engine::Body::next_frame() {
  if (!selection.loaded) return {};
  const Frame* const newest = state.frame.get();
  const bool is_there = shows_view(newest, selection) && is_lit_by(*newest, selection);
  if (is_there && (newest->is_full() || (selection.is_moving && !selection.full_while_moving))) return {};
  if (state.selection_number == failed_selection) return {};
  return [this, selection = selection, number = state.selection_number] { make_frame(selection, number); };
}

/// What the slower side took for its last answer, as if that had been of full size.
double Engine::Body::full_ms() const {
  const std::lock_guard lock(mutex);
  double slower = 0;
  for (const SideState& side : state.sides) {
    if (side.is_reference || !side.answer) continue;
    const GBuffer& g = side.answer->frame->gbuffer;
    const auto ms = [&](Stage stage) { return side.newest_ms[static_cast<int>(stage)].value_or(0); };
    const double pixels =
        static_cast<double>(selection.width) * selection.height / static_cast<double>(std::max<std::size_t>(g.size(), 1));
    slower = std::max(slower, ms(Stage::relight) + pixels * ms(Stage::resolve));
  }
  return slower;
}

void Engine::Body::make_frame(const Selection& selection, std::uint64_t number) {
  const auto start = Clock::now();
  const std::shared_ptr<const Frame> before = state.frame;  // only this thread makes frames
  const bool same_view = shows_view(before.get(), selection);
  PreviewDivisor& fitting = same_view ? light_divisor : camera_divisor;
  const bool may_shrink = selection.is_moving && !selection.full_while_moving;
  if (!may_shrink) {
    camera_divisor.forget();
    light_divisor.forget();
  }
  if (may_shrink) fitting.expect(full_ms());
  const int divisor = may_shrink ? fitting.value() : 1;
  const int width = divided(selection.width, divisor), height = divided(selection.height, divisor);

  auto frame = std::make_shared<Frame>();
  frame->number = ++frame_count;
  frame->loaded = selection.loaded;
  frame->light = selection.light;
  if (!selection.together.empty()) frame->lights = lights_of(selection);
  frame->picture_width = selection.width;
  frame->picture_height = selection.height;
  try {
    if (same_view && before->gbuffer.width == width && before->gbuffer.height == height) {
      frame->gbuffer = before->gbuffer;
      frame->file = before->file;
    } else {
      const Scene& scene = selection.loaded->scene;
      frame->gbuffer = make_gbuffer(scene, selection.loaded->store->everything(truth_of(selection)), selection.view, width,
                                    height, truth_of(selection));
      frame->file = write_shared(frame->gbuffer);
    }
    frame->received = received_light_of(*frame);
    frame->exposure = exposure_of(frame->scene(), frame->gbuffer, frame->received);
  } catch (const std::exception& error) {
    // A full disk or no memory: said, and tried again with the next selection.
    change([&](EngineState& s) {
      s.trouble = message_of(error);
      failed_selection = number;
    });
    return;
  }
  change([&](EngineState& s) {
    s.frame = frame;
    s.trouble.clear();
    for (const auto& side : sides) side->new_frame();
    refinement.give_up();
  });
  if (!may_shrink) return;
  wait_for_sides(frame->number);
  fitting.took(std::chrono::duration<double, std::milli>(Clock::now() - start).count());
}

/// The next frame while something moves is not begun before this one is answered, or one that is slow would never be seen. One
/// that is too slow is left behind. The reference is not waited for as long as techniques are: it may follow them.
void Engine::Body::wait_for_sides(std::uint64_t frame) {
  constexpr auto for_reference = std::chrono::milliseconds(25), for_technique = std::chrono::milliseconds(100);
  const auto begin = Clock::now();
  const auto have_answered = [&](bool with_reference) {
    return stop || std::ranges::all_of(sides, [&](const auto& side) {
             return (!with_reference && side->is_reference()) || side->has_finished(frame);
           });
  };
  std::unique_lock lock(mutex);
  const bool are_all_references = sides[0]->is_reference() && sides[1]->is_reference();
  news.wait_until(lock, begin + (are_all_references ? for_technique : for_reference), [&] { return have_answered(true); });
  news.wait_until(lock, begin + for_technique, [&] { return have_answered(false); });
}

bool are_same(const Light& a, const Light& b) { return light_and_view_bytes(a, {}) == light_and_view_bytes(b, {}); }
bool are_same(const View& a, const View& b) { return light_and_view_bytes(Light(), a) == light_and_view_bytes(Light(), b); }

bool are_same(const Selection& a, const Selection& b) {
  return a.scene == b.scene && a.loaded == b.loaded && a.truth == b.truth && are_same(a.light, b.light) &&
         are_same(a.together, b.together) && are_same(a.view, b.view) && a.width == b.width && a.height == b.height &&
         a.is_moving == b.is_moving && a.full_while_moving == b.full_while_moving && a.sides == b.sides &&
         a.picked == b.picked && a.repeat == b.repeat && a.curve == b.curve;
}

Engine::Engine(WorkerOptions workers, double timeout_seconds, std::function<void()> changed)
    : body_(std::make_unique<Body>(std::move(workers), timeout_seconds, std::move(changed))) {}

Engine::~Engine() = default;

void Engine::offer(std::shared_ptr<LoadedScene> loaded) {
  const std::lock_guard lock(body_->mutex);
  body_->offered = std::move(loaded);
}

std::uint64_t Engine::select(const Selection& selection) {
  const std::lock_guard lock(body_->mutex);
  for (const auto& side : body_->sides) side->drop_work_before(selection);
  body_->drop_curve_before(selection);
  if (selection.scene != body_->selection.scene) body_->state.scene_error.clear();
  body_->selection = selection;
  ++body_->state.selection_number;
  body_->wake_threads();
  return body_->state.selection_number;
}

EngineState Engine::state() const {
  const std::lock_guard lock(body_->mutex);
  EngineState state = body_->state;
  const auto now = Body::Clock::now();
  for (int k = 0; k < 2; ++k)
    if (const auto since = body_->sides[k]->since_) {
      state.sides[k].seconds = std::chrono::duration<double>(now - *since).count();
      if (const auto& worker = body_->sides[k]->worker_) state.sides[k].progress = worker->progress();
    }
  return state;
}

}  // namespace gnomon::viewer
