// Passes over images of 16 bits a number, and sums of whole numbers, against the same in double on the processor.
#include <gnomon/kit/gl/image_passes.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "device/context.h"
#include "measure/conformance/gl_state.h"

namespace image_formats_test {
using namespace gnomon;

class ImageFormats : public testing::Test {
 protected:
  ImageFormats() { process_context(); }
  void TearDown() override { EXPECT_EQ(state_differences(), std::vector<std::string>{}); }
};

constexpr int width = 37, height = 23, layers = 2;
constexpr GLenum small_formats[] = {GL_R16F, GL_RG16F, GL_RGBA16F, GL_R16, GL_RG16, GL_RGBA16};

/// Red of every texel as it is stored, 0.1 .. 1.
struct Stored {
  Texture texture;
  std::vector<float> texels;
  double at(int x, int y, int layer) const {
    return texels[(std::size_t(layer) * height + std::clamp(y, 0, height - 1)) * width + std::clamp(x, 0, width - 1)];
  }
};

Stored random_texels(GLenum format, int levels) {
  std::mt19937 random(3);
  std::vector<glm::vec4> texels(std::size_t(width) * height * layers);
  for (glm::vec4& texel : texels) texel = glm::vec4(0.1f + 0.9f * static_cast<float>(random()) / 4294967296.0f);
  Texture texture(format, width, height, layers, levels);
  glTextureSubImage3D(texture.name(), 0, 0, 0, 0, width, height, layers, GL_RGBA, GL_FLOAT, texels.data());
  std::vector<float> stored = read_texels<float>(texture, GL_RED);
  return {std::move(texture), std::move(stored)};
}

/// What `count` stores of values up to 1 round off, beside float32.
double tolerance(GLenum format, int count) {
  const StoredRounding rounding = stored_rounding(format);
  EXPECT_GT(rounding.absolute, 0);
  return count * (rounding.absolute + rounding.share) + 1e-5;
}

TEST_F(ImageFormats, texels_have_the_bytes_of_their_bits) {
  for (const auto& [format, bytes] : {std::pair{GL_R16F, 2u}, {GL_RG16F, 4u}, {GL_RGBA16F, 8u}, {GL_R16, 2u}, {GL_RGBA16, 8u}})
    EXPECT_EQ(Texture(static_cast<GLenum>(format), 4, 2, 3).bytes, 24 * bytes);
  for (const GLenum format : {GL_R32F, GL_RGBA32F, GL_RG32UI}) {
    EXPECT_EQ(stored_rounding(format).absolute, 0);
    EXPECT_EQ(stored_rounding(format).share, 0);
  }
}

TEST_F(ImageFormats, a_blur_of_16_bits_is_off_by_two_stores) {
  for (const GLenum format : small_formats) {
    const Stored image = random_texels(format, 1);
    Blur blur;
    blur.setup({.format = format, .has_layers = true}, Blur::Weights::box, 2);
    Texture to;
    blur.run(image.texture, to);
    EXPECT_EQ(to.format, format);
    const std::vector<float> is = read_texels<float>(to, GL_RED);
    for (int layer = 0; layer < layers; ++layer)
      for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
          double mean = 0;
          for (int k = 0; k < 25; ++k) mean += image.at(x + k % 5 - 2, y + k / 5 - 2, layer) / 25;
          ASSERT_NEAR(is[(std::size_t(layer) * height + y) * width + x], mean, tolerance(format, 2)) << std::hex << format;
        }
  }
}

TEST_F(ImageFormats, each_level_of_16_bits_is_one_store_more) {
  for (const GLenum format : small_formats) {
    const Stored image = random_texels(format, 3);
    MipChain chain;
    chain.setup({.format = format, .has_layers = true});
    chain.run(image.texture);
    for (int level = 1; level < 3; ++level) {
      const std::vector<float> is = read_texels<float>(image.texture, GL_RED, level);
      const int texels = 1 << level, columns = width >> level, rows = height >> level;
      for (int layer = 0; layer < layers; ++layer)
        for (int y = 0; y < rows - 1; ++y)  // the last ones stand for more
          for (int x = 0; x < columns - 1; ++x) {
            double mean = 0;
            for (int k = 0; k < texels * texels; ++k)
              mean += image.at(x * texels + k % texels, y * texels + k / texels, layer) / (texels * texels);
            ASSERT_NEAR(is[(std::size_t(layer) * rows + y) * columns + x], mean, tolerance(format, level))
                << std::hex << format;
          }
    }
  }
}

// Sums far above 2^32 wrap around; the difference of four of them is the sum over the box all the same, to the last bit.
TEST_F(ImageFormats, sums_of_whole_numbers_are_exact_where_the_box_is_below_all_that_32_bits_hold) {
  for (const auto& [format, channels] : {std::pair{GL_R32UI, 1}, {GL_RG32UI, 2}, {GL_RGBA32UI, 4}}) {
    std::mt19937 random(5);
    std::vector<glm::uvec4> texels(std::size_t(width) * height * layers);
    for (glm::uvec4& texel : texels) texel = {random() >> 5, random() >> 5, random() >> 5, random() >> 5};  // below 2^27
    Texture image(static_cast<GLenum>(format), width, height, layers), to;
    glTextureSubImage3D(image.name(), 0, 0, 0, 0, width, height, layers, GL_RGBA_INTEGER, GL_UNSIGNED_INT, texels.data());
    SummedAreaTable table;
    table.setup({.format = static_cast<GLenum>(format), .has_layers = true});
    table.run(image, to);
    std::vector<glm::uvec4> sums(texels.size());
    glGetTextureImage(to.name(), 0, GL_RGBA_INTEGER, GL_UNSIGNED_INT, static_cast<GLsizei>(sums.size() * sizeof(glm::uvec4)),
                      sums.data());
    const auto at = [&](const std::vector<glm::uvec4>& of, int x, int y, int layer) {
      return x < 0 || y < 0 ? glm::uvec4(0) : of[(std::size_t(layer) * height + y) * width + x];
    };
    std::uint64_t largest = 0;
    for (int layer = 0; layer < layers; ++layer)
      for (int y = 4; y < height; ++y)
        for (int x = 4; x < width; ++x) {
          glm::u64vec4 direct(0);
          for (int k = 0; k < 25; ++k) direct += glm::u64vec4(at(texels, x - k % 5, y - k / 5, layer));
          const glm::uvec4 box =
              at(sums, x, y, layer) - at(sums, x - 5, y, layer) - at(sums, x, y - 5, layer) + at(sums, x - 5, y - 5, layer);
          for (int c = 0; c < channels; ++c) {
            ASSERT_EQ(box[c], direct[c]) << x << ' ' << y << ' ' << c;
            largest = std::max(largest, std::uint64_t(direct[c]));
          }
        }
    EXPECT_GT(largest, 1u << 30);
  }
}

}  // namespace image_formats_test
