// The reference against masks made by POV-Ray, which shares no code with it: tests/witness/README.md says how to read them.
#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>

#include "measure/frame/boundary.h"
#include "measure/frame/gbuffer_maker.h"
#include "measure/scene/load.h"
#include "places.h"

namespace {

using namespace gnomon;

constexpr int width = 640, height = 360;
constexpr double allowed_share = 2e-5;
// Both programs round; a pixel may fall to the other side only where the shadow's edge runs through it. Both sides of the
// edge are marked, so such a pixel is 0 or 1 away, and the square root of 2 across a corner.
constexpr float allowed_distance = 1.5f;

std::vector<std::uint8_t> read_witness(const std::string& file) {
  const auto input = OIIO::ImageInput::open(tree_file("tests/witness/" + file));
  if (!input || input->spec().width != width || input->spec().height != height) return {};
  std::vector<std::uint8_t> pixels(width * height);
  const bool whole = input->read_image(0, 0, 0, 1, OIIO::TypeDesc::UINT8, pixels.data());
  return whole ? pixels : std::vector<std::uint8_t>();
}

class Witness : public testing::TestWithParam<std::tuple<const char*, const char*>> {};

TEST_P(Witness, agrees_with_the_reference) {
  const auto [scene_id, light_name] = GetParam();
  const Scene scene = load_scene(scene_id);
  const auto light = std::ranges::find(scene.lights, std::string(light_name), &Light::name);
  ASSERT_NE(light, scene.lights.end());
  const RayScene everything(scene, Truth::shape, RayScene::Which::all), casters(scene, Truth::shape, RayScene::Which::casters);
  const GBuffer g = make_gbuffer(scene, everything, scene.views[0], width, height, Truth::shape);
  std::vector<float> reference(g.size());
  const std::size_t facing = trace_shadows(casters, scene, g, *light, reference);

  const std::string file = fmt::format("{}_{}_{}x{}.png", scene_id, light_name, width, height);
  const std::vector<std::uint8_t> witness = read_witness(file);
  ASSERT_EQ(witness.size(), g.size()) << file << " cannot be read; run tests/witness/make_witnesses";

  // The edge among the pixels that face the light alone: the others are 1 in the reference and 0 in the witness.
  std::vector<PixelClass> classes(g.size());
  for (std::size_t i = 0; i < g.size(); ++i) classes[i] = faces_light(scene, g, *light, i) ? PixelClass::T : PixelClass::F;
  const std::vector<float> distance = distance_transform(shadow_boundary(reference, classes, width, height), width, height);
  std::size_t dark = 0, different = 0;
  float farthest = 0;
  for (std::size_t i = 0; i < g.size(); ++i) {
    if (classes[i] != PixelClass::T) continue;
    dark += reference[i] == 0;
    if ((witness[i] != 0) == (reference[i] != 0)) continue;
    ++different;
    farthest = std::max(farthest, distance[i]);
  }
  std::cout << fmt::format("{} {}: {} facing, {} dark, {} different ({:.2g}), farthest {:.2f} px from the edge\n", scene_id,
                           light_name, facing, dark, different, static_cast<double>(different) / facing, farthest);
  EXPECT_GT(dark, 1000u);
  EXPECT_LE(static_cast<double>(different), allowed_share * static_cast<double>(facing))
      << "if scenes/" << scene_id << ".cpp has changed, run tests/witness/make_witnesses";
  EXPECT_LE(farthest, allowed_distance) << "if scenes/" << scene_id << ".cpp has changed, run tests/witness/make_witnesses";
}

INSTANTIATE_TEST_SUITE_P(povray, Witness,
                         testing::Combine(testing::Values("box_city", "contact", "fence", "soup", "sphere_over_plane"),
                                          testing::Values("point", "sun")),
                         [](const auto& info) {
                           return fmt::format("{}_{}", std::get<0>(info.param), std::get<1>(info.param));
                         });

}  // namespace
