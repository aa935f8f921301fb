#include <gnomon/kit/layers.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

namespace gnomon {

namespace {

/// Linear light of the colors that the page shows as sRGB 24, 26, 30.
constexpr glm::dvec3 background{0.0091, 0.0103, 0.0130};

void put(std::vector<float>& picture, std::size_t i, const glm::dvec3& color) {
  for (int c = 0; c < 3; ++c) picture[3 * i + c] = static_cast<float>(std::clamp(color[c], 0.0, 1.0));
}

double luminance(const glm::dvec3& color) { return glm::dot(color, glm::dvec3(0.2126, 0.7152, 0.0722)); }

/// Colors of a heat layer at equal steps of 0 .. 1, linear RGB: each is lighter than the one before, so that steps are told
/// apart in gray, too. sRGB 36 48 148, 22 116 156, 36 164 112, 148 206 60, 253 231 37.
constexpr std::array<glm::dvec3, 5> heat_colors{{{0.0176, 0.0296, 0.2961},
                                                 {0.0080, 0.1746, 0.3325},
                                                 {0.0176, 0.3712, 0.1620},
                                                 {0.2961, 0.6172, 0.0452},
                                                 {0.9823, 0.7991, 0.0185}}};
constexpr glm::dvec3 negative_color{0.7157, 0.0296, 0.0212};

glm::dvec3 heat(double t) {
  const double place = std::clamp(t, 0.0, 1.0) * (heat_colors.size() - 1);
  const std::size_t k = std::min(static_cast<std::size_t>(place), heat_colors.size() - 2);
  return glm::mix(heat_colors[k], heat_colors[k + 1], place - static_cast<double>(k));
}

}  // namespace

std::vector<float> shaded_layer(const Scene& scene, const GBuffer& gbuffer, const Light& light, std::span<const float> mask) {
  assert(mask.size() == gbuffer.size());
  std::vector<float> picture(gbuffer.size() * 3);
  const glm::dvec4 l = homogeneous(light);
  for (std::size_t i = 0; i < gbuffer.size(); ++i) {
    if (gbuffer.is_background(i)) {
      put(picture, i, background);
      continue;
    }
    const glm::dvec3 point = gbuffer.position(i), to = to_light(l, point);
    double received = 0;
    if (in_spot_cone(light, point))
      received = std::max(0.0, glm::dot(glm::dvec3(gbuffer.normal(i)), to) / std::max(glm::length(to), 1e-300));
    // Two thirds of the color are taken out and the brightest white is held at half, so that what is drawn over it stands out.
    const glm::dvec3 albedo = scene.meshes[gbuffer.mesh[i]].albedo;
    const glm::dvec3 muted = glm::mix(glm::dvec3(luminance(albedo)), albedo, 1 / 3.0);
    put(picture, i, muted * (0.06 + 0.44 * received * mask[i]));
  }
  return picture;
}

std::vector<float> heat_layer(const GBuffer& gbuffer, std::span<const float> values) {
  assert(values.size() == gbuffer.size());
  std::vector<float> picture(gbuffer.size() * 3);
  const double largest = std::ranges::max(values);
  // The logarithm of 1 + v / 4 is nearly a straight line over small counts and keeps them apart when the largest is in the
  // hundreds: of 4, the value 1 lies at 0.32; of 400, still at 0.05.
  const double scale = 1 / std::log1p(std::max(largest, 1e-30) / 4);
  const glm::dvec3 eye = gbuffer.view.eye;
  for (std::size_t i = 0; i < gbuffer.size(); ++i) {
    if (values[i] > 0) {
      put(picture, i, heat(std::log1p(values[i] / 4.0) * scale));
    } else if (values[i] < 0) {
      put(picture, i, negative_color);
    } else if (gbuffer.is_background(i)) {
      put(picture, i, background);
    } else {
      // Lit from the eye: no light is known here, and shape is all that is wanted.
      const glm::dvec3 to_eye = glm::normalize(eye - glm::dvec3(gbuffer.position(i)));
      put(picture, i, glm::dvec3(0.02 + 0.10 * std::abs(glm::dot(glm::dvec3(gbuffer.normal(i)), to_eye))));
    }
  }
  return picture;
}

void paint_volumes(std::span<const VolumeFaces> faces, std::span<float> picture) {
  assert(picture.size() == 3 * faces.size());
  constexpr double left_by_one = 0.8;
  // Linear RGB of sRGB 245 130 30, 60 120 240, 250 225 70, 190 70 220.
  constexpr std::array<glm::dvec3, 4> colors{
      {{0.9131, 0.2232, 0.0130}, {0.0452, 0.1878, 0.8714}, {0.9560, 0.7529, 0.0612}, {0.5149, 0.0612, 0.7157}}};
  for (std::size_t i = 0; i < faces.size(); ++i) {
    const std::array counts{faces[i].front_sides, faces[i].back_sides, faces[i].light_caps, faces[i].dark_caps};
    // Each kind hides what it would hide alone; what is hidden is shared out among their colors in that proportion.
    double left = 1, hidden_sum = 0;
    glm::dvec3 color(0);
    for (std::size_t k = 0; k < counts.size(); ++k) {
      const double left_by_kind = std::pow(left_by_one, std::max(0.0f, counts[k]));
      left *= left_by_kind;
      hidden_sum += 1 - left_by_kind;
      color += (1 - left_by_kind) * colors[k];
    }
    if (hidden_sum == 0) continue;
    for (int c = 0; c < 3; ++c) {
      float& channel = picture[3 * i + c];
      channel = static_cast<float>(left * channel + (1 - left) * color[c] / hidden_sum);
    }
  }
}

}  // namespace gnomon
