// The passes against the same in double on the processor. u = 2^-24 is the rounding of float32.
#include <gnomon/kit/gl/gl_pass.h>
#include <gnomon/kit/gl/image_passes.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "device/context.h"
#include "measure/conformance/gl_state.h"

namespace image_passes_test {
using namespace gnomon;

constexpr double u = 0x1p-24;

class ImagePasses : public testing::Test {
 protected:
  ImagePasses() { process_context(); }
  void TearDown() override { EXPECT_EQ(state_differences(), std::vector<std::string>{}); }
};

/// Texels of all layers, four channels each whatever the format.
struct Image {
  int width = 1, height = 1, layers = 0;
  std::vector<glm::dvec4> texels = std::vector<glm::dvec4>(std::size_t(width) * height * std::max(layers, 1));

  glm::dvec4& at(int x, int y, int layer = 0) { return texels[(std::size_t(layer) * height + y) * width + x]; }
  const glm::dvec4& at(int x, int y, int layer = 0) const { return const_cast<Image&>(*this).at(x, y, layer); }
  /// The same with another value at each place: value(x, y, layer).
  template <class Value>
  Image with(const Value& value) const {
    Image image = *this;
    for (int layer = 0; layer < std::max(layers, 1); ++layer)
      for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) image.at(x, y, layer) = value(x, y, layer);
    return image;
  }
  Image absolute() const {
    return with([&](int x, int y, int layer) { return glm::abs(at(x, y, layer)); });
  }
};

/// Each value is one that float32 has.
Image random_image(int width, int height, int layers, double low, double high, unsigned seed = 1) {
  std::mt19937 random(seed);
  const auto value = [&] { return double(static_cast<float>(low + (high - low) * random() / 4294967296.0)); };
  return Image{width, height, layers}.with([&](int, int, int) { return glm::dvec4(value(), value(), value(), value()); });
}

Texture texture_of(const Image& image, GLenum format, int levels = 1) {
  Texture texture(format, image.width, image.height, image.layers, levels);
  std::vector<glm::vec4> texels(image.texels.begin(), image.texels.end());
  if (image.layers > 0)
    glTextureSubImage3D(texture.name(), 0, 0, 0, 0, image.width, image.height, image.layers, GL_RGBA, GL_FLOAT, texels.data());
  else
    glTextureSubImage2D(texture.name(), 0, 0, 0, image.width, image.height, GL_RGBA, GL_FLOAT, texels.data());
  return texture;
}

Image image_of(const Texture& texture, int level = 0) {
  const auto texels = read_texels<glm::vec4>(texture, GL_RGBA, level);
  return {level_size(texture.width, level), level_size(texture.height, level), texture.layers, {texels.begin(), texels.end()}};
}

/// Each channel of the format is off by at most the share `tolerance` of what `scale` says there.
void expect_near(const Image& is, const Image& wanted, const Image& scale, double tolerance, GLenum format) {
  ASSERT_EQ(is.texels.size(), wanted.texels.size());
  const auto is_in = [&](std::initializer_list<GLenum> formats) { return std::ranges::find(formats, format) != formats.end(); };
  const int channels = is_in({GL_R32F, GL_R16F, GL_R16}) ? 1 : is_in({GL_RG32F, GL_RG16F, GL_RG16}) ? 2 : 4;
  for (std::size_t i = 0; i < is.texels.size(); ++i)
    for (int c = 0; c < channels; ++c)
      ASSERT_LE(std::abs(is.texels[i][c] - wanted.texels[i][c]), tolerance * scale.texels[i][c])
          << i << " of " << is.width << " x " << is.height << " x " << is.layers << ", channel " << c << ": " << is.texels[i][c]
          << " for " << wanted.texels[i][c];
}

/// Calls use(kind, sizes) for every format, without layers and with one, two and three: sizes down to one texel.
void for_each_kind(const std::function<void(const ImageKind&, const std::vector<glm::ivec3>&)>& use) {
  for (const GLenum format : {GL_R32F, GL_RG32F, GL_RGBA32F})
    for (const bool has_layers : {false, true}) {
      std::vector<glm::ivec3> sizes;
      for (const auto& [width, height] : {std::pair(1, 1), {1, 7}, {9, 1}, {2, 2}, {3, 5}, {16, 8}, {37, 23}, {66, 131}})
        sizes.push_back({width, height, has_layers ? 1 + width % 3 : 0});
      use({.format = format, .has_layers = has_layers}, sizes);
    }
}

glm::dvec4 clamped(const Image& image, int x, int y, int layer) {
  return image.at(std::clamp(x, 0, image.width - 1), std::clamp(y, 0, image.height - 1), layer);
}

Image blurred(const Image& image, Blur::Weights weights, int radius) {
  std::vector<double> each;
  double sum = 0;
  for (int d = -radius; d <= radius; ++d) {
    const double s = radius / 2.0;
    each.push_back(weights == Blur::Weights::box ? 1 : std::exp(-d * d / (2 * s * s)));
    sum += each.back();
  }
  const auto mean = [&](const auto& texel) {
    glm::dvec4 total(0);
    for (int d = -radius; d <= radius; ++d) total += each[d + radius] / sum * texel(d);
    return total;
  };
  const Image rows =
      image.with([&](int x, int y, int layer) { return mean([&](int d) { return clamped(image, x + d, y, layer); }); });
  return rows.with([&](int x, int y, int layer) { return mean([&](int d) { return clamped(rows, x, y + d, layer); }); });
}

/// The largest in each window.
Image largest(const Image& image, int radius) {
  const auto along = [&](const Image& of, int dx, int dy) {
    return of.with([&](int x, int y, int layer) {
      glm::dvec4 most(0);
      for (int d = -radius; d <= radius; ++d) most = glm::max(most, clamped(of, x + dx * d, y + dy * d, layer));
      return most;
    });
  };
  return along(along(image, 1, 0), 0, 1);
}

TEST_F(ImagePasses, a_blur_is_the_weighted_mean_of_its_window) {
  for_each_kind([](const ImageKind& kind, const std::vector<glm::ivec3>& sizes) {
    for (const Blur::Weights weights : {Blur::Weights::box, Blur::Weights::gaussian}) {
      const int radius = kind.has_layers ? 3 : kind.format == GL_RG32F ? 1 : 10;
      Blur blur;
      blur.setup(kind, weights, radius);
      Texture to;
      for (const glm::ivec3& size : sizes) {
        const Image image = random_image(size.x, size.y, size.z, -1, 3);
        blur.run(texture_of(image, kind.format), to);
        // The weights are rounded once, each product and each sum, of 2 radius + 1 of them, once: twice 2 radius + 3 roundings.
        expect_near(image_of(to), blurred(image, weights, radius), largest(image.absolute(), radius), 2 * (2 * radius + 3) * u,
                    kind.format);
        EXPECT_EQ(blur.bytes(), to.bytes);
      }
    }
  });
}

TEST_F(ImagePasses, a_blur_of_the_largest_radius_and_of_huge_values_that_cancel) {
  Blur blur;
  blur.setup({.format = GL_RG32F}, Blur::Weights::gaussian, Blur::most_radius);
  const Image image = random_image(70, 41, 0, -1e37, 1e37);
  Texture to;
  blur.run(texture_of(image, GL_RG32F), to);
  expect_near(image_of(to), blurred(image, Blur::Weights::gaussian, 32), largest(image.absolute(), 32), 2 * 67 * u, GL_RG32F);
}

TEST_F(ImagePasses, a_blur_spreads_one_texel_by_the_products_of_its_weights) {
  // Box of radius 2: 1/25 in five by five. Of a texel in the corner the border repeats it: along each axis the places 0, 1, 2
  // have it three times, twice and once in their windows.
  Blur blur;
  blur.setup({.format = GL_R32F}, Blur::Weights::box, 2);
  Image image{12, 9};
  image.at(0, 0).x = 1;
  image.at(8, 5).x = 1;
  Texture to;
  blur.run(texture_of(image, GL_R32F), to);
  const Image is = image_of(to);
  for (int y = 0; y < 9; ++y)
    for (int x = 0; x < 12; ++x) {
      const double corner = std::max(3 - x, 0) * std::max(3 - y, 0) / 25.0;
      const double middle = std::abs(x - 8) <= 2 && std::abs(y - 5) <= 2 ? 1 / 25.0 : 0;
      EXPECT_NEAR(is.at(x, y).x, corner + middle, 14 * u) << x << " " << y;
    }
}

TEST_F(ImagePasses, weights_of_a_blur_sum_up_to_one) {
  for (const Blur::Weights weights : {Blur::Weights::box, Blur::Weights::gaussian})
    for (int radius = 1; radius <= Blur::most_radius; ++radius) {
      const std::vector<float> each = blur_weights(weights, radius);
      ASSERT_EQ(each.size(), std::size_t(radius) + 1);
      double sum = each[0];
      for (int d = 1; d <= radius; ++d) {
        sum += 2.0 * each[d];
        EXPECT_TRUE(weights == Blur::Weights::box ? each[d] == each[0] : each[d] < each[d - 1]);
      }
      EXPECT_NEAR(sum, 1, u) << radius;  // each is rounded by at most u of itself
    }
  EXPECT_NEAR(blur_weights(Blur::Weights::gaussian, 4)[2] / blur_weights(Blur::Weights::gaussian, 4)[0], std::exp(-0.5), 1e-6);
}

TEST_F(ImagePasses, passes_may_write_where_they_read) {
  const Image image = random_image(45, 19, 2, 0, 1);
  const ImageKind kind{.format = GL_RGBA32F, .has_layers = true};
  Texture same = texture_of(image, kind.format), other;
  Blur blur;
  blur.setup(kind, Blur::Weights::gaussian, 4);
  blur.run(same, other);
  blur.run(same, same);
  EXPECT_EQ(image_of(same).texels, image_of(other).texels);
  SummedAreaTable table;
  table.setup(kind);
  table.run(same, other);
  table.run(same, same);
  EXPECT_EQ(image_of(same).texels, image_of(other).texels);
}

TEST_F(ImagePasses, a_blur_reads_what_was_drawn_just_before_and_leaves_levels_alone) {
  const Program program("gray", full_screen_vertex, "layout(location = 0) out vec4 color; void main() { color = vec4(0.5); }");
  Texture image = texture_of(random_image(31, 14, 1, 0, 1), GL_R32F, 3);
  const Framebuffer framebuffer = make_framebuffer();
  Blur blur;
  blur.setup({.format = GL_R32F, .has_layers = true}, Blur::Weights::box, 2);
  for (const bool again : {false, true}) {
    {
      const StateGuard guard;
      glNamedFramebufferTextureLayer(framebuffer.name(), GL_COLOR_ATTACHMENT0, image.name(), 0, 0);
      glBindFramebuffer(GL_FRAMEBUFFER, framebuffer.name());
      glViewport(0, 0, image.width, image.height);
      glUseProgram(program.name());
      draw_full_screen();
    }
    blur.run(image, image);
    for (const glm::dvec4& texel : image_of(image).texels) ASSERT_NEAR(texel.x, 0.5, 7 * u) << again;
  }
  EXPECT_EQ(image.levels, 3);
}

TEST_F(ImagePasses, what_cannot_be_set_up_is_refused) {
  Blur blur;
  for (const int radius : {0, -1, 33})
    EXPECT_THROW(blur.setup({.format = GL_R32F}, Blur::Weights::box, radius), Error) << radius;
  EXPECT_THROW(blur.setup({.format = GL_R8}, Blur::Weights::box, 1), Error);
  EXPECT_THROW(MipChain().setup({.format = GL_R32UI}), Error);
  EXPECT_THROW(SummedAreaTable().setup({.format = GL_DEPTH_COMPONENT32F}), Error);
  // Whole numbers have no means, and 16 bits no sums.
  EXPECT_THROW(blur.setup({.format = GL_RG32UI}, Blur::Weights::box, 1), Error);
  EXPECT_THROW(MipChain().setup({.format = GL_RGBA32UI}), Error);
  for (const GLenum format : {GL_R16, GL_RGBA16F}) EXPECT_THROW(SummedAreaTable().setup({.format = format}), Error);
}

/// The next level in double: the last texel of an odd side takes three, of a single one one.
Image halved(const Image& image) {
  return Image{level_size(image.width, 1), level_size(image.height, 1), image.layers}.with([&](int x, int y, int layer) {
    const auto end = [](int place, int size) { return 2 * place + 3 >= size ? size : 2 * place + 2; };
    glm::dvec4 sum(0);
    int count = 0;
    for (int j = 2 * y; j < end(y, image.height); ++j)
      for (int i = 2 * x; i < end(x, image.width); ++i, ++count) sum += image.at(i, j, layer);
    return sum / double(count);
  });
}

TEST_F(ImagePasses, each_level_is_the_mean_of_what_it_stands_for) {
  for_each_kind([](const ImageKind& kind, const std::vector<glm::ivec3>& sizes) {
    MipChain chain;
    chain.setup(kind);
    for (const glm::ivec3& size : sizes) {
      Image wanted = random_image(size.x, size.y, size.z, -1, 3), scale = wanted.absolute();
      const int levels = level_count(size.x, size.y);
      const Texture texture = texture_of(wanted, kind.format, levels);
      chain.run(texture);
      for (int level = 1; level < levels; ++level) {
        // Two sums, each rounded once, of four values; at the edge eight sums and a division.
        wanted = halved(wanted);
        scale = halved(scale);
        expect_near(image_of(texture, level), wanted, scale, level * 0x1p-21, kind.format);
      }
      EXPECT_EQ(image_of(texture, levels - 1).texels.size(), std::size_t(std::max(size.z, 1)));
    }
  });
}

TEST_F(ImagePasses, the_last_texel_of_an_odd_side_takes_three) {
  // Of 0 1 2 3 4 5 12: the means of 0 1 and 2 3, and that of 4 5 12. Then of 0.5 2.5 7 all three.
  Image row{7, 1};
  for (int x = 0; x < 7; ++x) row.at(x, 0).x = x < 6 ? x : 12;
  const Texture texture = texture_of(row, GL_R32F, 3);
  MipChain chain;
  chain.setup({.format = GL_R32F});
  chain.run(texture);
  EXPECT_EQ(image_of(texture, 1).at(0, 0).x, 0.5);
  EXPECT_EQ(image_of(texture, 1).at(1, 0).x, 2.5);
  EXPECT_EQ(image_of(texture, 1).at(2, 0).x, 7);
  EXPECT_NEAR(image_of(texture, 2).at(0, 0).x, 10 / 3.0, 1e-6);
  EXPECT_EQ(texture.bytes, (7 + 3 + 1) * 4u);
}

TEST_F(ImagePasses, levels_of_huge_values_that_cancel_stay_finite) {
  const Image image = random_image(40, 40, 0, -0x1p124, 0x1p124);
  const Texture texture = texture_of(image, GL_RGBA32F, 2);
  MipChain chain;
  chain.setup({.format = GL_RGBA32F});
  chain.run(texture);
  expect_near(image_of(texture, 1), halved(image), halved(image.absolute()), 0x1p-21, GL_RGBA32F);
}

TEST_F(ImagePasses, only_levels_that_are_there_are_counted) {
  EXPECT_EQ(level_count(1, 1), 1);
  EXPECT_EQ(level_count(2, 1), 2);
  EXPECT_EQ(level_count(3, 3), 2);
  EXPECT_EQ(level_count(1023, 4), 10);
  EXPECT_EQ(level_count(1024, 1024), 11);
  Texture texture;
  texture.fit(GL_R32F, 8, 4, 2, 4);
  EXPECT_EQ(texture.bytes, 2 * (32 + 8 + 2 + 1) * 4u);
  const GLuint name = texture.name();
  texture.fit(GL_R32F, 8, 4, 2, 4);
  EXPECT_EQ(texture.name(), name);
  texture.fit(GL_RG32F, 8, 4, 2, 4);
  EXPECT_EQ(texture.format, GLenum{GL_RG32F});
}

Image summed_up(const Image& image, const glm::dvec4& offset = glm::dvec4(0)) {
  Image sums = image;
  for (int layer = 0; layer < std::max(image.layers, 1); ++layer)
    for (int y = 0; y < image.height; ++y) {
      glm::dvec4 row(0);
      for (int x = 0; x < image.width; ++x) {
        row += image.at(x, y, layer) - offset;
        sums.at(x, y, layer) = row + (y > 0 ? sums.at(x, y - 1, layer) : glm::dvec4(0));
      }
    }
  return sums;
}

TEST_F(ImagePasses, a_table_holds_the_sums_from_the_first_corner_on) {
  for_each_kind([](const ImageKind& kind, const std::vector<glm::ivec3>& sizes) {
    SummedAreaTable table;
    table.setup(kind);
    Texture to;
    for (const glm::ivec3& size : sizes) {
      const Image image = random_image(size.x, size.y, size.z, -1, 3);
      table.run(texture_of(image, kind.format), to);
      // Compensated sums of rows and of columns are off by 2 u of their absolute values each; eight u leave room for u squared.
      expect_near(image_of(to), summed_up(image), summed_up(image.absolute()), 0x1p-21, kind.format);
    }
  });
}

TEST_F(ImagePasses, sums_of_whole_numbers_are_exact) {
  // All sums are below 64 * 64 * 15 < 2^24, where float32 has every whole number.
  const Image image = random_image(64, 64, 0, 0, 15).with([](int x, int y, int) { return glm::dvec4((x * 7 + y * 5) % 16); });
  SummedAreaTable table;
  table.setup({.format = GL_RGBA32F});
  Texture to;
  table.run(texture_of(image, GL_RGBA32F), to);
  EXPECT_EQ(image_of(to).texels, summed_up(image).texels);
}

TEST_F(ImagePasses, long_sums_are_compensated) {
  // Plain float32 sums of 16384 times 0.1 in a row, or a column, are off by 1e-5 of themselves and more; the bound is 4.8e-7.
  float plain = 0;
  for (int i = 0; i < 16384; ++i) plain += 0.1f;
  ASSERT_GT(std::abs(plain - 16384 * double(0.1f)), 20 * 0x1p-21 * 16384 * 0.1);
  for (const bool along_x : {false, true}) {
    const Image image = Image{along_x ? 16384 : 3, along_x ? 3 : 16384}.with([](int, int, int) { return glm::dvec4(0.1f); });
    SummedAreaTable table;
    table.setup({.format = GL_R32F});
    Texture to;
    table.run(texture_of(image, GL_R32F), to);
    expect_near(image_of(to), summed_up(image), summed_up(image), 0x1p-21, GL_R32F);
  }
}

TEST_F(ImagePasses, an_offset_in_the_middle_of_the_values_makes_the_error_smaller) {
  // Values of 0.5 +- 0.001: the absolute values that count are 500 times as small, and so is the bound.
  const Image image = random_image(200, 150, 0, 0.499, 0.501);
  const glm::vec4 offset(0.5f);
  const Image rest = image.with([&](int x, int y, int) { return glm::abs(image.at(x, y) - glm::dvec4(offset)); });
  SummedAreaTable table;
  table.setup({.format = GL_RG32F});
  Texture to;
  table.run(texture_of(image, GL_RG32F), to, offset);
  expect_near(image_of(to), summed_up(image, offset), summed_up(rest), 0x1p-21, GL_RG32F);
}

TEST_F(ImagePasses, sums_of_huge_values_that_cancel_are_off_by_a_share_of_the_huge_ones) {
  const Image image = random_image(90, 61, 0, -1, 1).with([](int x, int y, int) {
    return glm::dvec4((x + y) % 2 ? 0x1p80 : -0x1p80, x % 3 ? 1 : -0x1p40, y % 2 ? 1e30f : -1e30f, 1e-30f);
  });
  SummedAreaTable table;
  table.setup({.format = GL_RGBA32F});
  Texture to;
  table.run(texture_of(image, GL_RGBA32F), to);
  expect_near(image_of(to), summed_up(image), summed_up(image.absolute()), 0x1p-21, GL_RGBA32F);
}

}  // namespace image_passes_test
