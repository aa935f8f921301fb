#pragma once
#include <array>
#include <optional>

namespace gnomon {

/// Takes the time between two places in what a device does, by the device's own clock.
class DeviceStopwatch {
 public:
  DeviceStopwatch() = default;
  DeviceStopwatch(const DeviceStopwatch&) = delete;
  virtual ~DeviceStopwatch() = default;

  void start() { mark(0); }
  void stop() { mark(1); }
  /// Between the last start and stop, milliseconds; waits for both. Nothing where the device has no clock.
  virtual std::optional<double> milliseconds() const = 0;

 private:
  virtual void mark(int which) = 0;
};

/// That of OpenGL. Needs a current context.
class GlStopwatch final : public DeviceStopwatch {
 public:
  GlStopwatch();
  ~GlStopwatch() override;
  std::optional<double> milliseconds() const override;

 private:
  void mark(int which) override;
  std::array<unsigned, 2> queries_{};  // zero: the device has no clock
};

}  // namespace gnomon
