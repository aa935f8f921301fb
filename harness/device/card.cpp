#include "device/card.h"

#include <dlfcn.h>

#include <array>
#include <memory>

namespace gnomon {

namespace {

// What is used of NVIDIA's nvml.h: all functions return 0 on success, clocks are MHz, power is milliwatts.
using Handle = void*;
constexpr int graphics_clock = 0, memory_clock = 2, gpu_temperature = 0;

struct Closer {
  void operator()(void* library) const { dlclose(library); }
};

class Library {
 public:
  explicit Library(const char* file) : library_(dlopen(file, RTLD_NOW | RTLD_LOCAL)) {}
  /// Whether it has the function and that says it succeeded.
  template <class... Argument>
  bool call(const char* function, Argument... arguments) const {
    auto* const found = library_ ? reinterpret_cast<int (*)(Argument...)>(dlsym(library_.get(), function)) : nullptr;
    return found && found(arguments...) == 0;
  }
  template <class... Argument>
  std::optional<double> number(double scale, const char* function, Argument... arguments) const {
    unsigned value = 0;
    return call(function, arguments..., &value) ? std::optional(value * scale) : std::nullopt;
  }
  template <class... Argument>
  std::string text(const char* function, Argument... arguments) const {
    std::array<char, 128> buffer{};
    return call(function, arguments..., buffer.data(), static_cast<unsigned>(buffer.size() - 1)) ? buffer.data() : "";
  }

 private:
  std::unique_ptr<void, Closer> library_;
};

}  // namespace

std::optional<CardState> card_state(std::string_view renderer, const char* file) {
  const Library library(file);
  if (!library.call("nvmlInit_v2")) return std::nullopt;
  std::optional<CardState> state;
  unsigned count = 0;
  if (!library.call("nvmlDeviceGetCount_v2", &count)) count = 0;
  for (unsigned k = 0; k < count && !state; ++k) {
    Handle card = nullptr;
    if (!library.call("nvmlDeviceGetHandleByIndex_v2", k, &card)) continue;
    const std::string name = library.text("nvmlDeviceGetName", card);
    if (name.empty() || renderer.find(name) == renderer.npos) continue;
    constexpr double watts = 1e-3;
    state = CardState{.name = name,
                      .driver = library.text("nvmlSystemGetDriverVersion"),
                      .graphics_mhz = library.number(1, "nvmlDeviceGetClockInfo", card, graphics_clock),
                      .memory_mhz = library.number(1, "nvmlDeviceGetClockInfo", card, memory_clock),
                      .power_w = library.number(watts, "nvmlDeviceGetPowerUsage", card),
                      .power_limit_w = library.number(watts, "nvmlDeviceGetEnforcedPowerLimit", card),
                      .celsius = library.number(1, "nvmlDeviceGetTemperature", card, gpu_temperature)};
  }
  library.call("nvmlShutdown");
  return state;
}

}  // namespace gnomon
