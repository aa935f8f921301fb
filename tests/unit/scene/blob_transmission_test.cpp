// Scenes with glass as bytes.
#include <gnomon/error.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "../hand_made.h"
#include "measure/scene/blob.h"
#include "measure/scene/fields.h"

namespace blob_transmission_test {
using namespace gnomon;

using Wrap = AlphaMask::Wrap;

std::shared_ptr<const Transmission> colored(float last = 0.75f) {
  return std::make_shared<const Transmission>(2, 1, 3, std::vector<float>{0, 0.1f, 0.2f, 1, 0.5f, last}, Wrap::mirror,
                                              Wrap::clamp);
}
std::shared_ptr<const AlphaMask> mask() {
  const std::vector<std::uint8_t> alpha = {0, 255};
  return std::make_shared<const AlphaMask>(2, 1, alpha);
}
const std::vector<glm::vec2> places = {{0, 0}, {0, 1}, {1, 1}, {1, -0.5f}};

/// Two panes of one texture, one of them with holes and seen; a plain pane; a ground; and what is not seen and opaque.
Scene glass_scene(float last = 0.75f) {
  Scene scene;
  scene.name = "glass";
  for (int height = 0; height < 5; ++height) scene.meshes.push_back(hand_made::square(1, static_cast<float>(height)));
  scene.meshes[0].transmission = scene.meshes[2].transmission = colored(last);
  scene.meshes[0].uv = scene.meshes[2].uv = places;
  scene.meshes[0].seen = false;
  scene.meshes[2].alpha_mask = mask();
  scene.meshes[3].transmission = std::make_shared<const Transmission>(glm::vec3(0.4f));
  scene.meshes[4].seen = false;
  scene.lights = {hand_made::point_light({0, 9, 0})};
  scene.views = {{}};
  return scene;
}

TEST(blob_transmission, comes_back_bit_for_bit_and_shared_as_it_was) {
  const Scene scene = glass_scene(), back = scene_from_bytes(scene_bytes(scene));
  ASSERT_EQ(back.meshes.size(), 5u);
  for (std::size_t m = 0; m < 5; ++m) {
    const Mesh &a = scene.meshes[m], &b = back.meshes[m];
    EXPECT_EQ(a.uv, b.uv) << m;
    EXPECT_EQ(a.seen, b.seen) << m;
    EXPECT_EQ(a.alpha_mask == nullptr, b.alpha_mask == nullptr) << m;
    ASSERT_EQ(a.transmission == nullptr, b.transmission == nullptr) << m;
    if (!a.transmission) continue;
    EXPECT_EQ(*a.transmission, *b.transmission) << m;
  }
  EXPECT_EQ(back.meshes[0].transmission, back.meshes[2].transmission);
  EXPECT_EQ(scene_bytes(back), scene_bytes(scene));
}

// The layout of scenes without glass is that of scenes without glass before: 2, and 3 with masks.
TEST(blob_transmission, leaves_scenes_without_it_as_they_were) {
  Scene scene = glass_scene();
  EXPECT_EQ(static_cast<int>(scene_bytes(scene).at(0)), 4);
  for (Mesh& mesh : scene.meshes) mesh.transmission.reset();
  EXPECT_EQ(static_cast<int>(scene_bytes(scene).at(0)), 4) << "two meshes are not seen";
  for (Mesh& mesh : scene.meshes) mesh.seen = true;
  const std::vector<std::byte> masked = scene_bytes(scene), glass = scene_bytes(glass_scene());
  EXPECT_EQ(static_cast<int>(masked.at(0)), 3);
  ASSERT_GT(glass.size(), masked.size());
  EXPECT_TRUE(std::equal(masked.begin() + 4, masked.end(), glass.begin() + 4)) << "all else is the same";
  scene.meshes[2].alpha_mask.reset();
  EXPECT_EQ(static_cast<int>(scene_bytes(scene).at(0)), 2);
  EXPECT_FALSE(scene_from_bytes(scene_bytes(scene)).has_transmission());
}

TEST(blob_transmission, is_part_of_a_scene_s_identity) {
  const auto hash = [](const Scene& scene) { return scene_hash(scene, scene.lights[0]); };
  const std::string before = hash(glass_scene());
  EXPECT_EQ(hash(glass_scene()), before);
  EXPECT_NE(hash(glass_scene(std::nextafter(0.75f, 1.0f))), before);
  const auto changed = [&](auto change) {
    Scene scene = glass_scene();
    change(scene);
    return hash(scene) != before;
  };
  EXPECT_TRUE(changed([](Scene& s) { s.meshes[0].seen = true; }));
  EXPECT_TRUE(changed([](Scene& s) { s.meshes[1].seen = false; }));
  EXPECT_TRUE(changed([](Scene& s) { s.meshes[0].uv[3].y = std::nextafter(s.meshes[0].uv[3].y, 9.0f); }));
  EXPECT_TRUE(changed([](Scene& s) { s.meshes[3].transmission.reset(); }));
  EXPECT_TRUE(changed([](Scene& s) { s.meshes[1].transmission = s.meshes[3].transmission; }));
}

TEST(blob_transmission, whose_bytes_end_early_is_refused) {
  const std::vector<std::byte> bytes = scene_bytes(glass_scene());
  for (std::size_t size = 0; size < bytes.size(); ++size)
    EXPECT_THROW(scene_from_bytes(std::span(bytes).first(size)), Error) << size;
}

struct Written {
  std::int32_t width = 2, height = 1, channels = 1;
  std::uint32_t wrap = 0;
  std::vector<float> values = {0.25f, 0.5f};
  std::uint64_t times = 1;
  std::uint32_t mesh = 0, transmission = 0;
  std::vector<glm::vec2> uv = places;
  std::vector<std::uint32_t> unseen = {0};
  bool has_mask = false, is_curved = false;
};

/// The bytes of a scene of one square, with the transmissions, transmitting and unseen meshes that are given.
Scene read(const Written& w) {
  Scene scene;
  scene.meshes = {hand_made::square(1, 0)};
  if (w.is_curved) scene.meshes[0].shape = Disc{};
  if (w.has_mask) {
    scene.meshes[0].alpha_mask = mask();
    scene.meshes[0].uv = places;
  }
  FieldWriter writer;
  writer.bytes = scene_bytes(scene);
  writer.bytes[0] = std::byte{4};
  if (!w.has_mask) writer(std::uint64_t{0}, std::uint64_t{0}, std::uint64_t{0});  // paths, masks, masked meshes
  writer(std::uint64_t{1}, w.width, w.height, w.channels, w.wrap, w.wrap, w.values, w.times);
  for (std::uint64_t k = 0; k < w.times; ++k) writer(w.mesh, w.transmission, w.uv);
  writer(w.unseen);
  return scene_from_bytes(writer.bytes);
}

TEST(blob_transmission, that_fits_no_mesh_or_is_none_is_refused) {
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  const Scene good = read({});
  EXPECT_EQ(good.meshes[0].transmission->at(1, 0), glm::vec3(0.5f));
  EXPECT_FALSE(good.meshes[0].seen);
  EXPECT_TRUE(read({.uv = {}, .has_mask = true}).has_transmission());
  EXPECT_TRUE(read({.width = 1, .values = {0.5f}, .uv = {}}).has_transmission()) << "no place is needed";
  EXPECT_THROW(read({.width = 0, .values = {}}), Error);
  EXPECT_THROW(read({.width = -2}), Error);
  EXPECT_THROW(read({.height = Transmission::most_texels + 1}), Error);
  EXPECT_THROW(read({.channels = 2}), Error);
  EXPECT_THROW(read({.wrap = 3}), Error);
  EXPECT_THROW(read({.values = {0.5f}}), Error);
  for (const float value : {-0.5f, 1.5f, nan}) EXPECT_THROW(read({.values = {0.5f, value}}), Error) << value;
  EXPECT_THROW(read({.times = 2}), Error);
  EXPECT_THROW(read({.mesh = 1}), Error);
  EXPECT_THROW(read({.transmission = 1}), Error);
  EXPECT_THROW(read({.uv = {}}), Error);
  EXPECT_THROW(read({.uv = std::vector<glm::vec2>(3)}), Error);
  EXPECT_THROW(read({.uv = {{0, 0}, {0, 3e38f}, {0, 0}, {0, 0}}}), Error);
  EXPECT_THROW(read({.has_mask = true}), Error) << "uv twice";
  EXPECT_THROW(read({.is_curved = true}), Error);
  EXPECT_THROW(read({.unseen = {1}}), Error);
  EXPECT_THROW(read({.unseen = {0, 0}}), Error);
}

}  // namespace blob_transmission_test
