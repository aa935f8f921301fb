#pragma once
#include "device/bare_pass.h"
#include "device/context.h"
#include "device/stopwatch.h"
#include "measure/worker/protocol.h"

namespace gnomon {

// What a worker that draws says of its device, as the protocol has it.

/// How the card is doing: name, driver, graphics_mhz and so on. Nothing where the processor draws, or nobody knows.
std::optional<Json> card_json(const GlInfo& info);

/// A frame's bare pass, drawn once before it is timed: drivers compile at the first draw.
class TimedBarePass {
 public:
  TimedBarePass(Floor floor, const Scene& scene, const GBuffer& gbuffer);
  /// So many times in a row, 1 .. most_floor_times, by the host's clock and by that of the device.
  FloorRequest::Reply time(int times, DeviceStopwatch* stopwatch) const;

 private:
  BarePass pass_;
};

}  // namespace gnomon
