#include "measure/worker/worker_device.h"

#include "device/card.h"
#include "measure/progress.h"

namespace gnomon {

void for_each_field(MaybeConst<CardState> auto& r, const auto& use) {
  use("name", r.name, "driver", r.driver, "graphics_mhz", r.graphics_mhz, "memory_mhz", r.memory_mhz);
  use("power_w", r.power_w, "power_limit_w", r.power_limit_w, "celsius", r.celsius);
}

std::optional<Json> card_json(const GlInfo& info) {
  const auto state = info.is_software() ? std::nullopt : card_state(info.renderer);
  return state ? std::optional(written(*state)) : std::nullopt;
}

TimedBarePass::TimedBarePass(Floor floor, const Scene& scene, const GBuffer& gbuffer) : pass_(floor, scene, gbuffer) {
  pass_.draw();
}

FloorRequest::Reply TimedBarePass::time(int times, DeviceStopwatch* stopwatch) const {
  if (!(times >= 1 && times <= most_floor_times)) throw Error("times = {} is outside 1 .. {}", times, most_floor_times);
  pass_.draw(1);  // everything it draws has been prepared when the clock starts
  glFinish();
  const auto start = std::chrono::steady_clock::now();
  if (stopwatch) stopwatch->start();
  pass_.draw(times);
  if (stopwatch) stopwatch->stop();
  glFinish();
  const double ms = 1000 * seconds_since(start);
  return {.ms = ms, .device_ms = stopwatch ? stopwatch->milliseconds() : std::nullopt};
}

}  // namespace gnomon
