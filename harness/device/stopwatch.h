#pragma once
#include <array>
#include <optional>

namespace gnomon {

/// Takes the time between two places in what the device does, by the device's own clock. Needs a current context.
class DeviceStopwatch {
 public:
  DeviceStopwatch();
  DeviceStopwatch(const DeviceStopwatch&) = delete;
  ~DeviceStopwatch();

  void start() { mark(0); }
  void stop() { mark(1); }
  /// Between the last start and stop, milliseconds; waits for both. Nothing where the device has no clock.
  std::optional<double> milliseconds() const;

 private:
  void mark(int which);
  std::array<unsigned, 2> queries_{};  // zero: the device has no clock
};

}  // namespace gnomon
