// Scenes with alpha masks as bytes.
#include <gnomon/error.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "../hand_made.h"
#include "measure/scene/blob.h"
#include "measure/scene/fields.h"

namespace blob_masks_test {
using namespace gnomon;

using Wrap = AlphaMask::Wrap;

std::shared_ptr<const AlphaMask> mask_of(float cutoff = 0.5f, std::uint8_t first = 255) {
  const std::vector<std::uint8_t> alpha = {first, 0, 127, 128, 51, 254};
  return std::make_shared<const AlphaMask>(3, 2, alpha, 0.875f, cutoff, Wrap::mirror, Wrap::clamp);
}

/// Two cards of one mask, one of another, and a ground without holes.
Scene masked_scene(float cutoff = 0.5f, std::uint8_t first = 255) {
  Scene scene;
  scene.name = "masked";
  for (const float height : {1.0f, 0.0f, 2.0f, 3.0f}) scene.meshes.push_back(hand_made::square(1, height));
  const auto shared = mask_of(cutoff, first);
  for (const std::size_t card : {0, 2, 3}) {
    scene.meshes[card].alpha_mask = shared;
    scene.meshes[card].uv = {{0, 0}, {0, 1}, {1, 1}, {1, -0.5f}};
  }
  const std::vector<std::uint8_t> gray = {0, 255};
  scene.meshes[3].alpha_mask = std::make_shared<const AlphaMask>(2, 1, gray, 1.0f, 0.4f, Wrap::repeat, Wrap::repeat, 33);
  scene.lights = {hand_made::point_light({0, 9, 0})};
  scene.views = {{}};
  return scene;
}

TEST(blob_masks, come_back_bit_for_bit_and_shared_as_they_were) {
  const Scene scene = masked_scene(), back = scene_from_bytes(scene_bytes(scene));
  ASSERT_EQ(back.meshes.size(), 4u);
  for (std::size_t m = 0; m < 4; ++m) {
    const Mesh &a = scene.meshes[m], &b = back.meshes[m];
    EXPECT_EQ(a.uv, b.uv);
    ASSERT_EQ(a.alpha_mask == nullptr, b.alpha_mask == nullptr) << m;
    if (!a.alpha_mask) continue;
    EXPECT_EQ(a.alpha_mask->width(), b.alpha_mask->width());
    EXPECT_EQ(a.alpha_mask->height(), b.alpha_mask->height());
    EXPECT_EQ(a.alpha_mask->wrap_u(), b.alpha_mask->wrap_u());
    EXPECT_EQ(a.alpha_mask->wrap_v(), b.alpha_mask->wrap_v());
    EXPECT_EQ(a.alpha_mask->factor(), b.alpha_mask->factor());
    EXPECT_EQ(a.alpha_mask->cutoff(), b.alpha_mask->cutoff());
    EXPECT_TRUE(std::ranges::equal(a.alpha_mask->bits(), b.alpha_mask->bits()));
    EXPECT_TRUE(std::ranges::equal(a.alpha_mask->alpha(), b.alpha_mask->alpha()));
  }
  EXPECT_EQ(back.meshes[0].alpha_mask, back.meshes[2].alpha_mask);
  EXPECT_NE(back.meshes[0].alpha_mask, back.meshes[3].alpha_mask);
  EXPECT_EQ(scene_bytes(back), scene_bytes(scene));
}

// A program that reads only scenes without masks reads their layout number, 2, and no other.
TEST(blob_masks, leave_scenes_without_them_as_they_were) {
  Scene scene = masked_scene();
  EXPECT_EQ(static_cast<int>(scene_bytes(scene).at(0)), 3);
  for (Mesh& mesh : scene.meshes) {
    mesh.alpha_mask.reset();
    mesh.uv.clear();
  }
  const std::vector<std::byte> solid = scene_bytes(scene);
  EXPECT_EQ(static_cast<int>(solid.at(0)), 2);
  EXPECT_FALSE(scene_from_bytes(solid).has_alpha_masks());
  const std::vector<std::byte> masked = scene_bytes(masked_scene());
  ASSERT_GT(masked.size(), solid.size());
  EXPECT_TRUE(std::equal(solid.begin() + 4, solid.end(), masked.begin() + 4));
}

TEST(blob_masks, are_shared_at_the_cost_of_one) {
  Scene scene = masked_scene();
  const std::size_t shared = scene_bytes(scene).size();
  scene.meshes[2].alpha_mask = mask_of();  // one of its own
  // Six fields of 4 bytes, two counts, a word for each of two rows, a byte for each of six texels.
  EXPECT_EQ(scene_bytes(scene).size(), shared + 6 * 4 + 2 * 8 + 2 * 4 + 6);
}

TEST(blob_masks, are_part_of_a_scene_s_identity) {
  const auto hash = [](const Scene& scene) { return scene_hash(scene, scene.lights[0]); };
  const std::string before = hash(masked_scene());
  EXPECT_EQ(hash(masked_scene()), before);
  EXPECT_NE(hash(masked_scene(0.75f)), before);
  EXPECT_NE(hash(masked_scene(0.5f, 250)), before);
  const auto changed = [&](auto change) {
    Scene scene = masked_scene();
    change(scene);
    return hash(scene) != before;
  };
  EXPECT_TRUE(changed([](Scene& s) { s.meshes[0].uv[3].y = std::nextafter(s.meshes[0].uv[3].y, 9.0f); }));
  EXPECT_TRUE(changed([](Scene& s) { std::swap(s.meshes[0].alpha_mask, s.meshes[3].alpha_mask); }));
  EXPECT_TRUE(changed([](Scene& s) {
    s.meshes[0].alpha_mask.reset();
    s.meshes[0].uv.clear();
  }));
}

TEST(blob_masks, whose_bytes_end_early_are_refused) {
  Scene scene = masked_scene();
  scene.paths = {{"slide", Path::Moves::light, {{0, 0, 0}, {1, 0, 0}}, 3}};
  EXPECT_EQ(scene_from_bytes(scene_bytes(scene)).paths.size(), 1u);
  for (const Scene& one : {scene, masked_scene()}) {
    const std::vector<std::byte> bytes = scene_bytes(one);
    for (std::size_t size = 0; size < bytes.size(); ++size)
      EXPECT_THROW(scene_from_bytes(std::span(bytes).first(size)), Error) << size;
  }
}

/// The bytes of a scene of one square with the masks and masked meshes that `write` appends.
std::vector<std::byte> with_masks(const auto& write) {
  Scene scene;
  scene.meshes = {hand_made::square(1, 0)};
  FieldWriter writer;
  writer.bytes = scene_bytes(scene);
  writer.bytes[0] = std::byte{3};
  writer(std::uint64_t{0});  // paths
  write(writer);
  return writer.bytes;
}

struct Written {
  std::int32_t width = 2, height = 1;
  std::uint32_t wrap = 0;
  float factor = 1, cutoff = 0.5f;
  std::vector<std::uint32_t> bits = {1};
  std::vector<std::uint8_t> alpha = {255, 0};
  std::uint64_t times = 1;
  std::uint32_t mesh = 0, mask = 0;
  std::vector<glm::vec2> uv = std::vector<glm::vec2>(4);
};

Scene read(const Written& w) {
  return scene_from_bytes(with_masks([&](FieldWriter& writer) {
    writer(std::uint64_t{1}, w.width, w.height, w.wrap, w.wrap, w.factor, w.cutoff, w.bits, w.alpha, w.times);
    for (std::uint64_t k = 0; k < w.times; ++k) writer(w.mesh, w.mask, w.uv);
  }));
}

TEST(blob_masks, that_fit_no_mask_or_no_mesh_are_refused) {
  EXPECT_TRUE(read({}).has_alpha_masks());
  EXPECT_THROW(read({.width = 0, .bits = {}, .alpha = {}}), Error);
  EXPECT_THROW(read({.width = -2}), Error);
  EXPECT_THROW(read({.height = AlphaMask::most_texels + 1}), Error);
  EXPECT_THROW(read({.wrap = 3}), Error);
  EXPECT_THROW(read({.factor = 1.5f}), Error);
  EXPECT_THROW(read({.cutoff = std::numeric_limits<float>::quiet_NaN()}), Error);
  EXPECT_THROW(read({.bits = {1, 0}}), Error);
  EXPECT_THROW(read({.bits = {4}}), Error);  // a third texel of a row of two
  EXPECT_THROW(read({.alpha = {255}}), Error);
  EXPECT_THROW(read({.times = 2}), Error);
  EXPECT_THROW(read({.mesh = 1}), Error);
  EXPECT_THROW(read({.mask = 1}), Error);
  EXPECT_THROW(read({.uv = std::vector<glm::vec2>(3)}), Error);
  EXPECT_THROW(read({.uv = {{0, 0}, {0, std::numeric_limits<float>::infinity()}, {0, 0}, {0, 0}}}), Error);
}

TEST(blob_masks, places_that_no_loader_takes_are_refused) {
  Scene scene = masked_scene();
  scene.meshes[2].uv[1] = {0, 3e38f};
  EXPECT_THROW(scene_from_bytes(scene_bytes(scene)), Error);
  scene = masked_scene();
  scene.meshes[2].shape = Disc{};
  EXPECT_THROW(scene_from_bytes(scene_bytes(scene)), Error);
}

}  // namespace blob_masks_test
