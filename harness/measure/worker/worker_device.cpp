#include "measure/worker/worker_device.h"

#include <gnomon/error.h>

#include <chrono>

#include "device/card.h"

namespace gnomon {

std::optional<Json> card_json(const GlInfo& info) {
  const auto state = info.is_software() ? std::nullopt : card_state(info.renderer);
  if (!state) return std::nullopt;
  const auto number = [](const std::optional<double>& value) { return value ? Json(*value) : Json(); };
  return json_object({{"name", state->name},
                      {"driver", state->driver},
                      {"graphics_mhz", number(state->graphics_mhz)},
                      {"memory_mhz", number(state->memory_mhz)},
                      {"power_w", number(state->power_w)},
                      {"power_limit_w", number(state->power_limit_w)},
                      {"celsius", number(state->celsius)}});
}

TimedBarePass::TimedBarePass(Floor floor, const Scene& scene, const GBuffer& gbuffer) : pass_(floor, scene, gbuffer) {
  pass_.draw();
}

FloorRequest::Reply TimedBarePass::time(int times, DeviceStopwatch* stopwatch) const {
  if (!(times >= 1 && times <= most_floor_times)) throw Error("times = {} is outside 1 .. {}", times, most_floor_times);
  using Clock = std::chrono::steady_clock;
  pass_.draw(1);  // what it draws has come up when the clock starts
  glFinish();
  const auto start = Clock::now();
  if (stopwatch) stopwatch->start();
  pass_.draw(times);
  if (stopwatch) stopwatch->stop();
  glFinish();
  FloorRequest::Reply result{.ms = std::chrono::duration<double, std::milli>(Clock::now() - start).count(), .device_ms = {}};
  if (stopwatch) result.device_ms = stopwatch->milliseconds();
  return result;
}

}  // namespace gnomon
