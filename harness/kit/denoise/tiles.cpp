#include <gnomon/error.h>
#include <gnomon/kit/denoise/tiles.h>
#include <gnomon/kit/parallel.h>
#include <gnomon/kit/vectorized.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace gnomon {

namespace {

constexpr int tile_reach = 8;  // taps to each side

/// exp(-3 i^2 / 81) to each side of the middle, of sum 1.
std::array<float, tile_reach + 1> make_tile_taps() {
  std::array<double, tile_reach + 1> taps{};
  double sum = 0;
  for (int i = 0; i <= tile_reach; ++i) {
    taps[i] = std::exp(-3.0 * i * i / 81);
    sum += i == 0 ? taps[i] : 2 * taps[i];
  }
  std::array<float, tile_reach + 1> result{};
  for (int i = 0; i <= tile_reach; ++i) result[i] = static_cast<float>(taps[i] / sum);
  return result;
}

GNOMON_VECTORIZED void add_tile_row(const float* plane, float weight, int count, float* __restrict sum) {
  for (int i = 0; i < count; ++i) sum[i] += weight * plane[i];
}

constexpr std::size_t mean_rows = 8;  // of a task

}  // namespace

float TileStep::blended(float current, float history) const noexcept {
  const float held = std::clamp(history, low, high);
  return held + blend * (current - held);
}

TileStep tile_step(const TileMoments& before, float current, float mean, float history) noexcept {
  const float spread = std::max(mean - mean * mean, 0.0f), half = std::sqrt(spread) / 2;
  TileStep step;
  step.low = mean - half;
  step.high = mean + half;

  const float length = before.length + 1, off = current - before.mean;
  step.moments.mean = before.mean + off / length;
  step.moments.squares = before.squares + off * (current - step.moments.mean);
  step.variance = length > 1 ? step.moments.squares / (length - 1) : 1;

  // History far from the local mean counts as fewer frames. The variance is then that of the place, more the shorter it is.
  const float far = (history - mean) / std::max(half, 0.001f);
  step.moments.length = length * std::exp(-far * far / 20);
  if (step.moments.length < 16) step.variance = std::max(step.variance, spread) * std::max(16 - step.moments.length, 1.0f);
  step.blend = 0.05f + 0.95f * std::sqrt(std::max(8 - step.moments.length, 0.0f) / 8);
  return step;
}

float darkened(float value, float variance) noexcept { return std::pow(value, std::max(1.2f - variance, 1.0f)); }

void TileMap::make(const FilterGuides& guides, std::span<const float> numerators, std::span<const float> denominators) {
  const int width = guides.width(), height = guides.height();
  const std::size_t size = static_cast<std::size_t>(width) * height,
                    padded = static_cast<std::size_t>(guides.stride()) * height;
  for (const std::size_t given : {numerators.size(), denominators.size()})
    if (given != size) throw Error("a plane has {} pixels, not the {} of the guides", given, size);
  tile_columns_ = (width + 7) / 8;
  word_rows_ = (height + 3) / 4;
  lit_.resize(static_cast<std::size_t>(tile_columns_) * word_rows_);
  dark_.resize(lit_.size());
  uniform_.resize(static_cast<std::size_t>(tile_columns_) * ((height + 7) / 8));
  for (UnsetVector<float>* plane : {&top_, &bottom_}) plane->resize(padded);
  for (UnsetVector<float>* plane : {&across_top_, &across_bottom_, &mean_, &strength_}) plane->resize(size);
  mark(guides, numerators, denominators);
  average(guides, numerators, denominators);
}

void TileMap::mark(const FilterGuides& guides, std::span<const float> numerators, std::span<const float> denominators) {
  const int width = guides.width(), height = guides.height();
  for_blocks(static_cast<std::size_t>(word_rows_), 4, [&](std::size_t begin, std::size_t end) {
    for (int word_row = static_cast<int>(begin); word_row < static_cast<int>(end); ++word_row)
      for (int column = 0; column < tile_columns_; ++column) {
        std::uint32_t lit = 0, dark = 0;
        for (int bit = 0; bit < 32; ++bit) {
          const int x = 8 * column + bit % 8, y = 4 * word_row + bit / 8;
          if (x >= width || y >= height || !guides.counts(x, y)) continue;
          const std::size_t i = static_cast<std::size_t>(y) * width + x;
          const bool is_open = !(denominators[i] > 0);  // nothing was asked: it may be either
          lit |= static_cast<std::uint32_t>(is_open || numerators[i] > 0) << bit;
          dark |= static_cast<std::uint32_t>(is_open || numerators[i] < denominators[i]) << bit;
        }
        const std::size_t word = static_cast<std::size_t>(word_row) * tile_columns_ + column;
        lit_[word] = lit;
        dark_[word] = dark;
      }
  });
  for_blocks(static_cast<std::size_t>((height + 7) / 8), 1, [&](std::size_t begin, std::size_t end) {
    for (int tile_row = static_cast<int>(begin); tile_row < static_cast<int>(end); ++tile_row)
      for (int column = 0; column < tile_columns_; ++column) {
        std::uint32_t lit = 0, dark = 0;
        for (int j = std::max(2 * tile_row - 2, 0); j <= std::min(2 * tile_row + 3, word_rows_ - 1); ++j)
          for (int i = std::max(column - 1, 0); i <= std::min(column + 1, tile_columns_ - 1); ++i) {
            const std::size_t word = static_cast<std::size_t>(j) * tile_columns_ + i;
            lit |= lit_[word];
            dark |= dark_[word];
          }
        const bool is_uniform = lit == 0 || dark == 0;
        uniform_[static_cast<std::size_t>(tile_row) * tile_columns_ + column] = is_uniform ? 1 : 0;
        for (int y = 8 * tile_row; y < std::min(8 * tile_row + 8, height); ++y)
          std::fill_n(&strength_[static_cast<std::size_t>(y) * width + 8 * column], std::min(8, width - 8 * column),
                      is_uniform ? 0.0f : 1.0f);
      }
  });
}

void TileMap::average(const FilterGuides& guides, std::span<const float> numerators, std::span<const float> denominators) {
  const int width = guides.width(), height = guides.height();
  static const std::array<float, tile_reach + 1> taps = make_tile_taps();
  const auto row_of = [width](UnsetVector<float>& plane, int y) { return &plane[static_cast<std::size_t>(y) * width]; };
  const auto across = [&](std::span<const float> from, UnsetVector<float>& padded, UnsetVector<float>& sums, int y) {
    const std::uint32_t* mesh = guides.row(y).mesh;
    const float* source = &from[static_cast<std::size_t>(y) * width];
    float* inner = &padded[guides.at(0, y)];
    std::fill_n(inner - filter_margin, guides.stride(), 0.0f);
    for (int x = 0; x < width; ++x) inner[x] = mesh[x] != no_mesh ? source[x] : 0;
    std::fill_n(row_of(sums, y), width, 0.0f);
    for (int i = -tile_reach; i <= tile_reach; ++i) add_tile_row(inner + i, taps[std::abs(i)], width, row_of(sums, y));
  };
  for_blocks(static_cast<std::size_t>(height), mean_rows, [&](std::size_t begin, std::size_t end) {
    for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y) {
      across(numerators, top_, across_top_, y);
      across(denominators, bottom_, across_bottom_, y);
    }
  });
  // Down the columns; the padded planes hold the sums now.
  for_blocks(static_cast<std::size_t>(height), mean_rows, [&](std::size_t begin, std::size_t end) {
    for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y) {
      float *top = &top_[guides.at(0, y)], *bottom = &bottom_[guides.at(0, y)], *mean = row_of(mean_, y);
      std::fill_n(top, width, 0.0f);
      std::fill_n(bottom, width, 0.0f);
      for (int j = std::max(-tile_reach, -y); j <= std::min(tile_reach, height - 1 - y); ++j) {
        add_tile_row(row_of(across_top_, y + j), taps[std::abs(j)], width, top);
        add_tile_row(row_of(across_bottom_, y + j), taps[std::abs(j)], width, bottom);
      }
      for (int x = 0; x < width; ++x) mean[x] = bottom[x] > 0 ? std::min(top[x] / bottom[x], 1.0f) : 1.0f;
    }
  });
}

std::size_t TileMap::bytes() const {
  return uniform_.size() + (lit_.size() + dark_.size()) * sizeof(std::uint32_t) +
         (top_.size() + bottom_.size() + across_top_.size() + across_bottom_.size() + mean_.size() + strength_.size()) *
             sizeof(float);
}

}  // namespace gnomon
