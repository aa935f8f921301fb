// Times of a row of which the geometry moves: update, and the relight and resolve that follow it, from frame to frame.
#include "measure/run/motion_walk.h"

#include <gnomon/error.h>
#include <gnomon/registry.h>

#include "measure/notice.h"

namespace gnomon {

int FrameOrder::next() {
  if (now_ + step_ < 0 || now_ + step_ >= frames_) step_ = -step_;
  return now_ += step_;
}

const FrameRequest& MotionFrames::request(int number) {
  const auto known = requests_.find(number);
  if (known != requests_.end()) return known->second;
  RowFrame frame = first_;
  frame.number = number;
  run_.go_to(frame);
  return requests_.emplace(number, run_.request(frame, truth_)).first->second;
}

MotionTime timed_motion(WorkerClient& worker, const FrameRequest& request, int number) {
  return at_frame(number, [&] {
    const FrameReply reply = worker.frame(request);
    if (!reply.support) throw Error("at frame {}: {}", number, reply.support.why());
    MotionTime time;
    time.update = worker.time(Stage::update);
    time.update_clocks = worker.other_clocks();
    time.relight = worker.time(Stage::relight);
    time.resolve = worker.time(Stage::resolve);
    return time;
  });
}

int motion_iterations(double ms, int step_count) {
  constexpr double cheap_ms = 200;
  constexpr int few = 4;
  int least = 1;
  while (least < few && 2 * least * ms <= cheap_ms) least *= 2;
  const int steps = std::max(iterations_for(ms), least);
  const int round = 2 * step_count;  // forth and back
  return steps >= round ? steps - steps % round : std::min(steps, step_count);
}

int motion_iterations(const Job& job, double ms) {
  const int step_count = *job.times->frames - 1;
  return registry().technique(job.contender.technique).about.remembers ? step_count : motion_iterations(ms, step_count);
}

MotionTime MotionWalk::step(int k, int steps, double shift) {
  if (steps <= order_.step_count()) {
    const int from = static_cast<int>((k + shift) / steps * order_.step_count());
    if (order_.now() != from) time_(from);
    order_.jump_to(from);
  }
  return time_(order_.next());
}

double MotionWalk::warm_up(int warmups) {
  constexpr double most_ms = 300;
  const int steps = std::min(warmups, order_.step_count());
  double slowest = 0, sum = 0;
  for (int k = 0; k < steps && sum < most_ms; ++k) {
    const double ms = step(k, steps, 0.5).sum();
    slowest = k <= 1 ? ms : std::max(slowest, ms);
    sum += ms;
  }
  return slowest;
}

TimingTask MotionWalk::task(int repetitions, int iterations) {
  TimingTask task;
  repetitions_ = task.repetitions = repetitions;
  task.iterations = iterations;
  task.milliseconds = [this](int steps) {
    const auto start = std::chrono::steady_clock::now();
    const double ms = add_sample(steps);
    seconds += seconds_since(start);
    return ms;
  };
  return task;
}

double MotionWalk::add_sample(int steps) {
  MotionTime sum{.update_clocks = {.device = 0, .harness = 0}};
  const auto add = [](std::optional<double>& to, const std::optional<double>& more) {
    to = to && more ? std::optional(*to + *more) : std::nullopt;
  };
  const double shift = (static_cast<double>(std::size(relight)) + 0.5) / repetitions_;
  for (int k = 0; k < steps; ++k) {
    const MotionTime time = step(k, steps, shift);
    sum.update += time.update;
    sum.relight += time.relight;
    sum.resolve += time.resolve;
    add(sum.update_clocks.device, time.update_clocks.device);
    add(sum.update_clocks.harness, time.update_clocks.harness);
  }
  relight.push_back(sum.relight / steps);
  resolve.push_back(sum.resolve / steps);
  if (const auto device = sum.update_clocks.device) update.device.push_back(*device / steps);
  if (const auto harness = sum.update_clocks.harness) update.harness.push_back(*harness / steps);
  return sum.update;
}

}  // namespace gnomon
