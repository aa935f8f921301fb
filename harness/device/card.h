#pragma once
#include <optional>
#include <string>
#include <string_view>

namespace gnomon {

/// How the card that draws is doing, by its maker's own library.
struct CardState {
  std::string name, driver;  ///< "NVIDIA H100 PCIe", version of the driver
  std::optional<double> graphics_mhz, memory_mhz, power_w, power_limit_w, celsius;  ///< nothing where it does not report one
};

/// Queries NVIDIA's management library for the card whose name is a part of the OpenGL renderer's; changes nothing. Nothing
/// where there is no such library or card.
std::optional<CardState> card_state(std::string_view renderer, const char* library = "libnvidia-ml.so.1");

}  // namespace gnomon
