#include "app/viewer/frame_lane.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "app/viewer/compose.h"
#include "measure/notice.h"

namespace gnomon::viewer {

namespace {

constexpr double frame_budget_ms = 40;  // with what the window itself takes: 20 pictures a second

/// As for `gnomon render`: without curved shapes both truths are one.
Truth truth_of(const Frame& frame, const Selection& selection) {
  return frame.scene().has_curved_shapes() ? selection.truth : Truth::shape;
}

/// Whether a frame is of the selected scene at the selected time, size and truth, from the selected view.
bool shows_view(const Frame* frame, const Selection& selection) {
  return frame && frame->loaded == selection.loaded && are_same_time(frame->at(), selection.at) &&
         frame->picture_width == selection.width && frame->picture_height == selection.height &&
         frame->gbuffer.truth == truth_of(*frame, selection) && are_same(frame->gbuffer.view, selection.view);
}

/// Whether smaller frames will do.
bool may_shrink(const Selection& selection) { return selection.is_moving && !selection.full_while_moving; }

/// What the picture receives of all lights without shadows, in their order.
std::vector<double> received_light_of(const Frame& frame) {
  const auto all = frame.all_lights();
  const std::vector<Light> lights = whole_lights({all.begin(), all.end()});
  std::vector<double> received = received_light(frame.gbuffer, lights[0]);
  for (const Light& light : std::span(lights).subspan(1))
    std::ranges::transform(received, received_light(frame.gbuffer, light), received.begin(), std::plus<>());
  return received;
}

}  // namespace

int PreviewDivisor::next() const {
  const double now = ms_[value_];
  if (now == 0) return value_;
  if (now <= frame_budget_ms) {
    if (value_ == 1) return 1;
    const double bigger = ms_[value_ - 1] > 0 ? ms_[value_ - 1] : now * value_ * value_ / ((value_ - 1.0) * (value_ - 1.0));
    return bigger <= frame_budget_ms ? value_ - 1 : value_;
  }
  // A smaller frame is worth it if it saves at least 0.4 of the share of pixels that it spares.
  const auto worth = [](int divisor) { return 1 - 0.4 * (1 - std::pow((divisor - 1.0) / divisor, 2)); };
  if (value_ < largest && (ms_[value_ + 1] == 0 || ms_[value_ + 1] < worth(value_ + 1) * now)) return value_ + 1;
  return value_ > 1 && ms_[value_ - 1] > 0 && now > worth(value_) * ms_[value_ - 1] ? value_ - 1 : value_;
}

void PreviewDivisor::took(double ms) {
  // A mean, because single frames are slow for reasons of their own.
  double& mean = ms_[value_];
  mean = mean == 0 ? ms : 0.7 * mean + 0.3 * ms;
  value_ = next();
}

void PreviewDivisor::expect(double full_ms) {
  if (std::ranges::any_of(ms_, [](double ms) { return ms > 0; })) return;
  while (value_ < largest && full_ms > frame_budget_ms * value_ * value_) ++value_;
}

Work FrameLane::next() {
  const Selection& selection = board_.selection;
  if (!selection.loaded) return {};
  const Frame* const newest = board_.state.frame.get();
  const bool is_there = shows_view(newest, selection) && newest->at() == selection.at && is_lit_by(*newest, selection);
  if (is_there && (newest->is_full() || may_shrink(selection))) return {};
  if (board_.state.selection_number == failed_selection_) return {};
  return [this, selection, number = board_.state.selection_number] { make_frame(selection, number); };
}

/// What the slower side took for its last answer, as if that had been of full size.
double FrameLane::full_ms() const {
  const std::lock_guard lock(board_.mutex);
  double slower = 0;
  for (const SideState& side : board_.state.sides) {
    if (side.is_reference || !side.answer) continue;
    const GBuffer& g = side.answer->frame->gbuffer;
    const auto ms = [&](Stage stage) { return side.newest_ms[static_cast<int>(stage)].value_or(0); };
    const double pixels = static_cast<double>(board_.selection.width) * board_.selection.height /
                          static_cast<double>(std::max<std::size_t>(g.size(), 1));
    slower = std::max(slower, ms(Stage::relight) + pixels * ms(Stage::resolve));
  }
  return slower;
}

void FrameLane::make_frame(const Selection& selection, std::uint64_t number) {
  const auto start = Clock::now();
  const std::shared_ptr<const Frame> before = board_.state.frame;  // only this thread makes frames
  const bool same_view = shows_view(before.get(), selection);
  PreviewDivisor& fitting = same_view ? light_divisor_ : camera_divisor_;
  const bool is_preview = may_shrink(selection);
  if (is_preview) {
    fitting.expect(full_ms());
  } else {
    camera_divisor_.forget();
    light_divisor_.forget();
  }
  auto frame = std::make_shared<Frame>();
  frame->number = ++frame_count_;
  frame->loaded = selection.loaded;
  frame->light = selection.light;
  if (!selection.together.empty()) frame->lights = lights_of(selection);
  frame->picture_width = selection.width;
  frame->picture_height = selection.height;
  try {
    make_picture(selection, same_view ? before.get() : nullptr, is_preview ? fitting.value() : 1, *frame);
  } catch (const std::exception& error) {
    // A full disk, no memory, a pose that cannot be: reported, and tried again with the next selection.
    failed_selection_ = number;
    board_.change([&](EngineState& s) { s.trouble = message_of(error); });
    return;
  }
  board_.change([&](EngineState& s) {
    s.frame = frame;
    s.trouble.clear();
    for (SideLane& side : sides_) side.give_up_causes();
    reference_.give_up();
  });
  if (!is_preview) return;
  wait_for_sides(frame->number);
  fitting.took(std::chrono::duration<double, std::milli>(Clock::now() - start).count());
}

/// The pose and what the eye sees of it. `before` shows the same view; null: no frame does.
void FrameLane::make_picture(const Selection& selection, const Frame* before, int divisor, Frame& frame) {
  if (selection.at) {
    frame.posed = copies_.of({frame.loaded, &frame.loaded->scene}, *selection.at);
    frame.pose = WantedPose{.at = *selection.at, .hash = frame.posed->hash()};
  } else {
    copies_.clear();
  }
  const auto divided = [&](int size) { return std::max(1, (size + divisor - 1) / divisor); };
  const int width = divided(selection.width), height = divided(selection.height);
  if (before && before->gbuffer.width == width && before->gbuffer.height == height) {
    frame.gbuffer = before->gbuffer;
    frame.file = before->file;
  } else {
    const Truth truth = truth_of(frame, selection);
    frame.gbuffer = make_gbuffer(frame.scene(), frame.everything(truth), selection.view, width, height, truth);
    frame.file = board_.write_shared(frame.gbuffer);
  }
  frame.received = received_light_of(frame);
  frame.exposure = exposure_of(frame.scene(), frame.gbuffer, frame.received);
}

/// While something moves, the next frame waits until the sides have answered this one: otherwise a slow side would never be
/// seen. A side that is too slow is left behind. The wait for the reference is shorter, because it may follow the techniques.
void FrameLane::wait_for_sides(std::uint64_t frame) {
  constexpr auto for_reference = std::chrono::milliseconds(25), for_technique = std::chrono::milliseconds(100);
  const auto begin = Clock::now();
  std::unique_lock lock(board_.mutex);
  const auto have_answered = [&](bool with_reference) {
    return board_.stop || std::ranges::all_of(sides_, [&](const SideLane& side) {
             return (!with_reference && side.is_reference()) || side.has_finished(frame);
           });
  };
  const auto until = begin + (std::ranges::all_of(sides_, &SideLane::is_reference) ? for_technique : for_reference);
  board_.news.wait_until(lock, until, [&] { return have_answered(true); });
  board_.news.wait_until(lock, begin + for_technique, [&] { return have_answered(false); });
}

}  // namespace gnomon::viewer
