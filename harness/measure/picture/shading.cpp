#include "measure/picture/shading.h"

#include <fmt/format.h>
#include <gnomon/kit/parallel.h>

#include <cmath>

namespace gnomon {

std::uint8_t srgb(double linear) {
  const double x = std::clamp(linear, 0.0, 1.0);
  return static_cast<std::uint8_t>(std::lround(255 * (x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1 / 2.4) - 0.055)));
}

const SrgbSteps& srgb_steps() {
  static const SrgbSteps table = [] {
    SrgbSteps steps;
    for (int i = 0; i <= 4096; ++i) steps[i] = srgb(i / 4096.0);
    return steps;
  }();
  return table;
}

std::vector<double> received_light(const GBuffer& gbuffer, const Light& light) {
  std::vector<double> received(gbuffer.size());
  const glm::dvec4 l = homogeneous(light);
  for_blocks(received.size(), 16384, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (gbuffer.is_background(i)) continue;
      const glm::dvec3 point = gbuffer.position(i), to = to_light(l, point);
      if (!in_spot_cone(light, point)) continue;
      const double cosine = glm::dot(glm::dvec3(gbuffer.normal(i)), to) / std::max(glm::length(to), 1e-300);
      received[i] = light.intensity * std::max(0.0, cosine);
    }
  });
  return received;
}

std::string percent(double share) { return fmt::format("{:.{}f} %", 100 * share, share < 0.001 ? 4 : share < 0.1 ? 2 : 1); }

}  // namespace gnomon
