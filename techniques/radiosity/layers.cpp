#include "layers.h"

#include <gnomon/kit/pictures/layers.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace gnomon::radiosity {

namespace {

void put(std::vector<float>& picture, std::size_t pixel, const glm::dvec3& color) {
  for (int c = 0; c < 3; ++c) picture[3 * pixel + c] = static_cast<float>(std::clamp(color[c], 0.0, 1.0));
}

template <class Paint>
std::vector<float> paint(const GBuffer& gbuffer, const Look& look, const Paint& color_of) {
  std::vector<float> picture(3 * gbuffer.size());
  for (std::size_t i = 0; i < gbuffer.size(); ++i) {
    const std::optional<Found> found = look(i);
    put(picture, i, found ? glm::dvec3(color_of(*found)) : glm::dvec3(background_color()));
  }
  return picture;
}

/// One of many muted colors, the same for the same number.
glm::dvec3 tone(std::uint32_t number) {
  const double hue = std::fmod(number * std::numbers::phi, 1.0) * 2 * std::numbers::pi;
  const double light = 0.25 + 0.15 * std::fmod(number * std::numbers::sqrt2, 1.0);
  return light * (glm::dvec3(1) + 0.35 * glm::dvec3(std::cos(hue), std::cos(hue - 2.1), std::cos(hue + 2.1)));
}

/// Steps of the form factor from one color to the next: 1 is 2^-14, each color is twice the one before.
float heat_of(double factor) { return factor > 0 ? static_cast<float>(std::max(factor * 16384, 1.0)) : 0; }

}  // namespace

std::vector<DebugLayer> layers() {
  std::vector<Swatch> divided = heat_legend();
  divided.resize(5);
  std::vector<Swatch> factors = heat_legend();
  for (Swatch& swatch : factors) swatch.name += " / 16384";
  factors.push_back({"white: the patch", glm::dvec3(1)});
  return {
      {"radiosity", "All light on the surfaces, as they send it to the eye; bright places are cut off.", {}},
      {"patches", "A tone for each patch; dark lines are borders of elements.", {}},
      {"subdivision", "How often a patch was divided in two each way where shadow edges cross it: gray never.", divided},
      {"unshot", "Light that patches have got and not handed on, white where it is the most.", {}},
      {"form_factors", "What share of the light of the patch at pick_x, pick_y each patch gets: its form factor.", factors},
      {"hemicube",
       "What the patch at pick_x, pick_y sees, drawn on its hemicube: the top in the middle, the four half sides around it; "
       "surfaces in their color, patch by patch.",
       {}}};
}

std::vector<float> paint_patches(const GBuffer& gbuffer, const Lighting& lighting, const Look& look) {
  const Division& division = lighting.division();
  return paint(gbuffer, look, [&](const Found& found) {
    const Element& element = division.elements()[found.element];
    const glm::dvec2 in = (found.place - element.low) / element.step;
    double to_border = std::min(in.x, in.y);
    to_border = std::min(to_border, division.corner_count(element) == 3 ? 1 - in.x - in.y : 1 - std::max(in.x, in.y));
    return tone(2 * element.patch + found.side) * (to_border < 0.06 ? 0.35 : 1.0);
  });
}

std::vector<float> paint_subdivision(const GBuffer& gbuffer, const Lighting& lighting, const Look& look) {
  std::vector<float> levels(gbuffer.size());
  for (std::size_t i = 0; i < gbuffer.size(); ++i)
    if (const auto found = look(i)) levels[i] = static_cast<float>(lighting.division().elements()[found->element].level);
  return heat_layer(gbuffer, levels);
}

std::vector<float> paint_unshot(const GBuffer& gbuffer, const Lighting& lighting, const Look& look) {
  const auto unshot = [&](const Found& found) {
    return lighting.unshot(lighting.division().elements()[found.element].patch, found.side);
  };
  double most = 0;
  for (std::size_t i = 0; i < gbuffer.size(); ++i)
    if (const auto found = look(i)) most = std::max(most, glm::dot(unshot(*found), glm::dvec3(1.0 / 3)));
  return paint(gbuffer, look, [&](const Found& found) { return most > 0 ? unshot(found) / most : glm::dvec3(0); });
}

std::vector<float> paint_form_factors(const GBuffer& gbuffer, const Lighting& lighting, const Look& look, const Found& picked,
                                      const Surfaces& surfaces) {
  const Division& division = lighting.division();
  const std::uint32_t patch = division.elements()[picked.element].patch;
  const Sender sender = lighting.sender_of(patch, picked.side);
  const Gathering gathering(*surfaces.all, Way::contour, 16);
  std::vector<std::array<float, 2>> factors(division.patch_count(), {-1, -1});  // of both sides
  std::vector<float> heat(gbuffer.size());
  std::vector<std::size_t> own;
  for (std::size_t i = 0; i < gbuffer.size(); ++i) {
    const auto found = look(i);
    if (!found) continue;
    const std::uint32_t other = division.elements()[found->element].patch;
    if (other == patch && found->side == picked.side) {
      own.push_back(i);
      continue;
    }
    float& factor = factors[other][found->side];
    if (factor < 0) {
      const Element& element = division.elements()[other];
      const Node& center = division.nodes()[element.center];
      const Face& face = division.face_of(element);
      const Receiving at{center.point, found->side ? -face.normal : face.normal, face.mesh, face.triangle_at(center.place),
                         other};
      Factor result;
      gathering.factors(sender, false, {&at, 1}, 1, {&result, 1});
      factor = static_cast<float>(result.seen * division.area(element) / sender.area);
    }
    heat[i] = heat_of(factor);
  }
  std::vector<float> picture = heat_layer(gbuffer, heat);
  for (const std::size_t i : own) put(picture, i, glm::dvec3(1));
  return picture;
}

std::vector<float> paint_hemicube(const GBuffer& gbuffer, const Lighting& lighting, const Found& picked, const Scene& scene,
                                  Hemicube& hemicube, int resolution) {
  const Division& division = lighting.division();
  const Sender sender = lighting.sender_of(division.elements()[picked.element].patch, picked.side);
  std::vector<std::uint32_t> shown;
  for (std::uint32_t e = 0; e < division.elements().size(); ++e)
    if (!division.elements()[e].is_divided()) shown.push_back(e);
  hemicube.show(division, shown);
  std::vector<double> shares(shown.size());
  hemicube.look(sender.center(), sender.normal, resolution, shares);

  std::vector<float> picture(3 * gbuffer.size());
  const auto texel = [&](int row, int column) { return hemicube.texels()[std::size_t(row) * resolution + column]; };
  // Unfolded it is a square of twice the top's side, the corners empty.
  const double scale = 2.0 / std::min(gbuffer.width, gbuffer.height);
  for (std::size_t i = 0; i < gbuffer.size(); ++i) {
    const double x = (i % gbuffer.width + 0.5 - gbuffer.width / 2.0) * scale;
    const double y = (gbuffer.height / 2.0 - (i / gbuffer.width + 0.5)) * scale;
    // On the top, x runs along its first axis and y along its second one, in -1/2 .. 1/2; beyond are the sides.
    const auto index = [&](double from_0_to_1) {
      return std::clamp(static_cast<int>(from_0_to_1 * resolution), 0, resolution - 1);
    };
    const double beyond = std::max(std::abs(x), std::abs(y)) - 0.5;
    std::optional<std::uint32_t> id;
    if (beyond < 0) {
      id = texel(index(0.5 - y), index(x + 0.5));
    } else if (beyond < 0.5 && std::min(std::abs(x), std::abs(y)) < 0.5) {
      const int side = std::abs(x) > std::abs(y) ? (x > 0 ? 0 : 1) : (y > 0 ? 2 : 3);
      // `right` of a side is its forward direction crossed with the normal: of the first -v, of the second v, then u, -u.
      const double along = side == 0 ? -y : side == 1 ? y : side == 2 ? x : -x;
      id = texel(resolution + side * (resolution / 2) + std::min(static_cast<int>(beyond * resolution), resolution / 2 - 1),
                 index(along + 0.5));
    }
    glm::dvec3 color(0.02);
    if (id && *id == 0) color = glm::dvec3(0);
    if (id && *id > 0) {
      const Element& element = division.elements()[shown[*id - 1]];
      const glm::dvec3 albedo(scene.meshes[division.face_of(element).mesh].albedo);
      color = albedo * (0.6 + 0.4 * std::fmod(element.patch * std::numbers::phi, 1.0));
    }
    put(picture, i, color);
  }
  return picture;
}

}  // namespace gnomon::radiosity
