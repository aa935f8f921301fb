#include "measure/run/worker_device.h"

#include <gnomon/error.h>

#include <chrono>

#include "device/card.h"
#include "measure/run/worker.h"

namespace gnomon {

Json card_json(const GlInfo& info) {
  const auto state = info.is_software() ? std::nullopt : card_state(info.renderer);
  if (!state) return {};
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

Json TimedBarePass::time(double times, DeviceStopwatch* stopwatch) const {
  if (!(times >= 1 && times <= most_floor_times)) throw Error("times = {} is outside 1 .. {}", times, most_floor_times);
  using Clock = std::chrono::steady_clock;
  glFinish();
  const auto start = Clock::now();
  if (stopwatch) stopwatch->start();
  pass_.draw(static_cast<int>(times));
  if (stopwatch) stopwatch->stop();
  glFinish();
  Json result = json_object({{"ms", std::chrono::duration<double, std::milli>(Clock::now() - start).count()}});
  if (const auto ms = stopwatch ? stopwatch->milliseconds() : std::nullopt) result["device_ms"] = *ms;
  return result;
}

}  // namespace gnomon
