// Makes frames of what is selected: smaller ones while something moves, so that they keep up.
#include <algorithm>

#include "app/viewer/compose.h"
#include "app/viewer/engine_side.h"

namespace gnomon::viewer {

namespace fs = std::filesystem;

namespace {

constexpr double frame_budget_ms = 40;  // with what the window itself takes: 20 pictures a second

/// As for `gnomon render`: without curved shapes both truths are one.
Truth truth_of(const Selection& selection) {
  return selection.loaded->scene.has_curved_shapes() ? selection.truth : Truth::shape;
}

int divided(int size, int divisor) { return std::max(1, (size + divisor - 1) / divisor); }

}  // namespace

int Divisor::next() const {
  const double now = ms_[value_];
  if (now == 0) return value_;
  if (now <= frame_budget_ms) {
    if (value_ == 1) return 1;
    const double bigger = ms_[value_ - 1] > 0 ? ms_[value_ - 1] : now * value_ * value_ / ((value_ - 1.0) * (value_ - 1.0));
    return bigger <= frame_budget_ms ? value_ - 1 : value_;
  }
  constexpr double worth = 0.8;  // of the time: what smaller frames must at least save
  if (value_ < largest && (ms_[value_ + 1] == 0 || ms_[value_ + 1] < worth * now)) return value_ + 1;
  return value_ > 1 && ms_[value_ - 1] > 0 && now > worth * ms_[value_ - 1] ? value_ - 1 : value_;
}

void Divisor::took(double ms) {
  // A frame now and then is slow for reasons of its own.
  double& known = ms_[value_];
  known = known == 0 ? ms : 0.7 * known + 0.3 * ms;
  value_ = next();
}

void Divisor::forget() { ms_ = {}; }

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
  const bool is_there = newest && newest->loaded == selection.loaded && newest->picture_width == selection.width &&
                        newest->picture_height == selection.height && newest->gbuffer.truth == truth_of(selection) &&
                        light_and_view == light_and_view_bytes(selection.light, selection.view);
  if (is_there && (newest->is_full() || (selection.is_moving && !selection.full_while_moving))) return {};
  if (state.selection_number == failed_selection) return {};
  return [this, selection = selection, number = state.selection_number] { make_frame(selection, number); };
}

void Engine::Body::make_frame(const Selection& selection, std::uint64_t number) {
  const auto start = Clock::now();
  const std::shared_ptr<const Frame> before = state.frame;  // only this thread makes frames
  const bool same_view = before && before->loaded == selection.loaded && before->picture_width == selection.width &&
                         before->picture_height == selection.height && before->gbuffer.truth == truth_of(selection) &&
                         light_and_view_bytes({}, before->gbuffer.view) == light_and_view_bytes({}, selection.view);
  Divisor& fitting = same_view ? light_divisor : camera_divisor;
  const bool may_shrink = selection.is_moving && !selection.full_while_moving;
  if (!may_shrink) {
    camera_divisor.forget();
    light_divisor.forget();
  }
  const int divisor = may_shrink ? fitting.value() : 1;
  const int width = divided(selection.width, divisor), height = divided(selection.height, divisor);

  auto frame = std::make_shared<Frame>();
  frame->number = ++frame_count;
  frame->loaded = selection.loaded;
  frame->light = selection.light;
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
    frame->received = received_light(frame->gbuffer, selection.light);
  } catch (const std::exception& error) {
    // A full disk or no memory: said, and tried again with the next selection.
    change([&](EngineState& s) {
      s.trouble = error.what();
      failed_selection = number;
    });
    return;
  }
  change([&](EngineState& s) {
    s.frame = frame;
    s.trouble.clear();
    light_and_view = light_and_view_bytes(selection.light, selection.view);
    for (const auto& side : sides) side->new_frame();
    refinement.give_up();
  });
  if (!may_shrink) return;
  wait_for_sides(frame->number);
  fitting.took(std::chrono::duration<double, std::milli>(Clock::now() - start).count());
}

/// The next frame while something moves is not begun before this one is answered, or one that is slow would never be seen. One
/// that is too slow is left behind.
void Engine::Body::wait_for_sides(std::uint64_t frame) {
  const auto deadline = Clock::now() + std::chrono::milliseconds(100);
  std::unique_lock lock(mutex);
  news.wait_until(lock, deadline, [&] { return stop || (sides[0]->has_finished(frame) && sides[1]->has_finished(frame)); });
}

}  // namespace gnomon::viewer
