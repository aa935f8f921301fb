// What a caster that moves may change in the images of a light, and filters of that alone.
#include <gnomon/kit/maps/moved_tiles.h>
#include <gtest/gtest.h>

#include <random>

#include "drawing_test.h"
#include "small_world.h"

namespace moved_tiles_test {
using namespace gnomon;

class MovedTexels : public DrawingTest {};

PixelRectangle tiles_at(int column, int row, int columns = 1, int rows = 1) {
  return {column * Blur::tile_width, row * Blur::tile_height, (column + columns) * Blur::tile_width,
          (row + rows) * Blur::tile_height};
}

TEST(moved_tiles, tiles_are_marked_that_hold_a_texel_or_one_around_it) {
  const auto marked = [](const PixelRectangle& texels, int around) {
    MarkedTiles tiles(4 * Blur::tile_width, 1);
    tiles.mark(0, texels, around);
    return tiles.rectangles();
  };
  const PixelRectangle inner = tiles_at(1, 2);
  EXPECT_EQ(marked(inner, 0), (std::vector<LayerRectangle>{{0, inner}}));
  EXPECT_EQ(marked(inner, 1), (std::vector<LayerRectangle>{{0, tiles_at(0, 1, 3, 3)}}));
  const PixelRectangle one{inner.left + 3, inner.top + 3, inner.left + 4, inner.top + 4};
  EXPECT_EQ(marked(one, 3), (std::vector<LayerRectangle>{{0, inner}}));
  EXPECT_EQ(marked(one, 4), (std::vector<LayerRectangle>{{0, tiles_at(0, 1, 2, 2)}}));
  EXPECT_TRUE(marked({5, 5, 5, 9}, 9).empty()) << "no texels";
  EXPECT_EQ(marked({0, 0, 1, 1}, 5), (std::vector<LayerRectangle>{{0, tiles_at(0, 0)}}));
}

TEST(moved_tiles, rectangles_hold_the_marked_tiles_once_and_end_at_the_border) {
  MarkedTiles tiles(300, 2);  // of 128, 128 and 44 columns, and nine times 32 and 12 rows
  tiles.mark(0, {0, 0, 10, 40}, 0);
  tiles.mark(0, {5, 30, 130, 31}, 0);
  tiles.mark(1, {290, 270, 300, 300}, 0);
  EXPECT_EQ(tiles.rectangles(),
            (std::vector<LayerRectangle>{{0, {0, 0, 256, 32}}, {0, {0, 32, 128, 64}}, {1, {256, 256, 300, 300}}}));
}

/// Whether a texel of a layer lies in one of these.
bool is_in(std::span<const LayerRectangle> all, int layer, int x, int y) {
  return std::ranges::any_of(all, [&](const LayerRectangle& r) {
    return r.layer == layer && r.texels.left <= x && x < r.texels.right && r.texels.top <= y && y < r.texels.bottom;
  });
}

/// All numbers of all layers are random.
Texture random_image(GLenum format, int side, int layers, unsigned seed) {
  Texture texture(format, side, side, layers);
  std::mt19937 random(seed);
  std::vector<glm::vec4> texels(std::size_t(side) * side * layers);
  for (glm::vec4& texel : texels)
    for (int c = 0; c < 4; ++c) texel[c] = static_cast<float>(random() % 65536) / 65536;
  glTextureSubImage3D(texture.name(), 0, 0, 0, 0, side, side, layers, GL_RGBA, GL_FLOAT, texels.data());
  return texture;
}

// Of the image that is blurred, what the blur does not read is spoiled. 300 texels end within a tile.
TEST_F(MovedTexels, a_blur_within_rectangles_has_the_bits_of_a_whole_one_there_and_changes_nothing_else) {
  for (const GLenum format : {GL_R32F, GL_RG32F, GL_RGBA32F, GL_RG16F, GL_RGBA16})
    for (const int radius : {2, 13})
      for (const int side : {300, format == GL_RG32F ? 512 : 300}) {
        Blur blur;
        blur.setup({.format = format, .has_layers = true}, Blur::Weights::gaussian, radius);
        MarkedTiles tiles(side, 2);
        tiles.mark(0, {130, 70, 140, 80}, 0);
        tiles.mark(0, {10, 100, 12, 101}, 0);
        tiles.mark(1, {side - 1, side - 1, side, side}, 0);
        const std::vector<LayerRectangle> within = tiles.rectangles();
        const Texture from = random_image(format, side, 2, 1), spoiled = random_image(format, side, 2, 2);
        for (const LayerRectangle& r : within) {
          const int left = std::max(r.texels.left - radius, 0), top = std::max(r.texels.top - radius, 0);
          const int right = std::min(r.texels.right + radius, side), bottom = std::min(r.texels.bottom + radius, side);
          glCopyImageSubData(from.name(), GL_TEXTURE_2D_ARRAY, 0, left, top, r.layer, spoiled.name(), GL_TEXTURE_2D_ARRAY, 0,
                             left, top, r.layer, right - left, bottom - top, 1);
        }
        Texture whole;
        blur.run(from, whole);
        const Texture part = random_image(format, side, 2, 3);
        const auto before = read_texels<glm::vec4>(part, GL_RGBA), wanted = read_texels<glm::vec4>(whole, GL_RGBA);
        blur.run(spoiled, part, within);
        const auto after = read_texels<glm::vec4>(part, GL_RGBA);
        std::size_t wrong = 0;
        for (std::size_t i = 0; i < after.size(); ++i) {
          const int x = static_cast<int>(i) % side, y = static_cast<int>(i) / side % side,
                    layer = static_cast<int>(i) / side / side;
          wrong += after[i] != (is_in(within, layer, x, y) ? wanted : before)[i];
        }
        EXPECT_EQ(wrong, 0u) << std::hex << format << std::dec << ", radius " << radius << ", " << side;
        // A whole one after it is as it was.
        Texture again;
        blur.run(from, again);
        EXPECT_EQ(read_texels<glm::vec4>(again, GL_RGBA), wanted);
      }
}

/// A ground with a box above it, somewhere, whose reach is that of all of them.
Scene with_box(std::mt19937& random) {
  const auto number = [&](float low, float high) { return low + (high - low) * static_cast<float>(random() % 4096) / 4096; };
  Scene scene;
  const glm::vec3 low(number(-4, 3), number(0, 5), number(-4, 3));
  scene.meshes = {small_world::ground(4),
                  small_world::box(low, low + glm::vec3(number(0.01f, 2), number(0.01f, 2), number(0.01f, 2)))};
  scene.meshes[1].reach.add({-4, 0, -4});
  scene.meshes[1].reach.add({5, 7, 5});
  return scene;
}

// The point light is among the boxes, which surround it now and then, and lie across the faces of its cube.
TEST_F(MovedTexels, a_rectangle_around_a_box_holds_all_texels_that_it_covers) {
  const Light lights[] = {{.name = "sun", .kind = DirectionalLight{{0.4f, -1, 0.3f}}},
                          {.name = "point", .kind = PointLight{{0.25f, 2.5f, 0.5f}}},
                          {.name = "spot", .kind = SpotLight{{1, 6, 1}, {-0.1f, -1, 0}, 20, 50}}};
  std::mt19937 random(1);
  const StateGuard guard;
  DepthImages images;
  images.setup();
  double covered = 0, held = 0;
  for (int k = 0; k < 60; ++k) {
    const Scene with = with_box(random);
    Scene without = with;
    without.meshes[1].triangles.clear();
    for (const Light& light : lights) {
      Texture drawn, bare;
      images.build(with);
      const LightCamera camera = fit_to_scene(light, images.boxes(), 256, 3);
      images.draw(camera, drawn);
      images.build(without);
      images.draw(camera, bare);
      const auto a = read_texels<float>(drawn, GL_DEPTH_COMPONENT), b = read_texels<float>(bare, GL_DEPTH_COMPONENT);
      Bounds bounds;
      bounds.add(with.meshes[1].positions);
      std::size_t missed = 0;
      for (const LightImage& image : camera.images) {
        if (image.layer < 0) continue;
        const PixelRectangle r = texels_around(camera, image, bounds);
        held += double(r.right - r.left) * (r.bottom - r.top);
        for (int y = 0; y < 256; ++y)
          for (int x = 0; x < 256; ++x) {
            const std::size_t i = (std::size_t(image.layer) * 256 + y) * 256 + x;
            if (a[i] == b[i]) continue;
            ++covered;
            missed += !(r.left <= x && x < r.right && r.top <= y && y < r.bottom);
          }
      }
      EXPECT_EQ(missed, 0u) << k << " under " << light.name;
    }
    release_inputs();
  }
  EXPECT_GT(covered, 1e5);
  EXPECT_LT(held, 4 * covered) << "it would not be worth it";
}

}  // namespace moved_tiles_test
