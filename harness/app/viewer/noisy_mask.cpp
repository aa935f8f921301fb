#include "app/viewer/noisy_mask.h"

#include <gnomon/kit/parallel.h>

#include <algorithm>
#include <cmath>

namespace gnomon::viewer {

namespace {

/// What a mask does along a few pixels: the sizes of its steps added up, and that from end to end.
struct Steps {
  float all = 0, change = 0;
  Steps& operator+=(const Steps& other) {
    all += other.all;
    change += other.change;
    return *this;
  }
};

/// A mask in pixels of its frame, with the surface that each is of.
class NoiseSearch {
 public:
  explicit NoiseSearch(const ComposeSide& side)
      : width_(side.frame->gbuffer.width), height_(side.frame->gbuffer.height), surface_(size()), visibility_(size()) {
    const GBuffer& gbuffer = side.frame->gbuffer;
    for_rows([&](int x, int y) {
      const std::size_t i = index(x, y);
      const bool faces_light = !gbuffer.is_background(i) && side.frame->received[i] > 0;
      surface_[i] = faces_light ? gbuffer.mesh[i] : no_mesh;
      if (faces_light) visibility_[i] = visibility_at(side, gbuffer, x, y);
    });
  }

  /// A mask that only rises or falls along a line has steps as large in all as its whole change; so has an edge. Steps of noise
  /// are some four times that, along rows and columns alike. A thin shadow has such steps across it, but not along it.
  std::vector<char> noisy() const {
    constexpr float least = 0.02f;  // of the steps of a line: no contour follows less
    constexpr float times = 2;      // that the steps are of the whole change
    const std::vector<Steps> rows = sums_around({1, 0}), columns = sums_around({0, 1});
    const auto is_noise = [](const Steps& sum) { return sum.all > least * lines_around && sum.all > times * sum.change; };
    std::vector<char> is_noisy(size());
    for_rows([&](int x, int y) {
      const std::size_t i = index(x, y);
      is_noisy[i] = surface_[i] != no_mesh && is_noise(rows[i]) && is_noise(columns[i]);
    });
    return is_noisy;
  }

  std::vector<float> means(const std::vector<char>& is_noisy) const {
    std::vector<float> means(size());
    for_rows([&](int x, int y) {
      bool is_wanted = is_noisy[index(x, y)];
      for (const glm::ivec2& beside : {glm::ivec2(x - 1, y), {x + 1, y}, {x, y - 1}, {x, y + 1}})
        is_wanted = is_wanted || (is_inside(beside) && is_noisy[index(beside.x, beside.y)]);
      if (is_wanted) means[index(x, y)] = mean_at(x, y);
    });
    return means;
  }

 private:
  static constexpr int line_reach = 2;  // pixels to each side along a row or a column
  static constexpr int around = 3;      // pixels to each side whose lines are added
  static constexpr float lines_around = (2 * around + 1) * (2 * around + 1);

  std::size_t size() const { return static_cast<std::size_t>(width_) * height_; }
  std::size_t index(int x, int y) const { return static_cast<std::size_t>(y) * width_ + x; }
  bool is_inside(const glm::ivec2& p) const { return p.x >= 0 && p.y >= 0 && p.x < width_ && p.y < height_; }

  template <class Work>
  void for_rows(const Work& work) const {
    for_blocks(height_, 16, [&](std::size_t begin, std::size_t end) {
      for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y)
        for (int x = 0; x < width_; ++x) work(x, y);
    });
  }

  Steps line_at(int x, int y, const glm::ivec2& way) const {
    const std::size_t here = index(x, y);
    Steps line;
    float first = visibility_[here], last = first;
    bool is_begun = false;
    for (int k = -line_reach; k <= line_reach; ++k) {
      const glm::ivec2 p = glm::ivec2(x, y) + k * way;
      if (!is_inside(p) || surface_[index(p.x, p.y)] != surface_[here]) continue;
      const float v = visibility_[index(p.x, p.y)];
      if (is_begun)
        line.all += std::abs(v - last);
      else
        first = v;
      last = v;
      is_begun = true;
    }
    line.change = std::abs(last - first);
    return line;
  }

  /// Of the lines through all pixels around each.
  std::vector<Steps> sums_around(const glm::ivec2& way) const {
    std::vector<Steps> lines(size()), across(size());
    for_rows([&](int x, int y) {
      if (surface_[index(x, y)] != no_mesh) lines[index(x, y)] = line_at(x, y, way);
    });
    for_rows([&](int x, int y) {
      for (int column = std::max(x - around, 0); column <= std::min(x + around, width_ - 1); ++column)
        across[index(x, y)] += lines[index(column, y)];
    });
    for_rows([&](int x, int y) {
      lines[index(x, y)] = {};
      for (int row = std::max(y - around, 0); row <= std::min(y + around, height_ - 1); ++row)
        lines[index(x, y)] += across[index(x, row)];
    });
    return lines;
  }

  float mean_at(int x, int y) const {
    constexpr int reach = NoisyMask::mean_reach;
    float sum = 0, count = 0;
    for (int row = std::max(y - reach, 0); row <= std::min(y + reach, height_ - 1); ++row)
      for (int column = std::max(x - reach, 0); column <= std::min(x + reach, width_ - 1); ++column) {
        if (surface_[index(column, row)] != surface_[index(x, y)]) continue;
        sum += visibility_[index(column, row)];
        ++count;
      }
    return sum / count;
  }

  int width_, height_;
  std::vector<std::uint32_t> surface_;  // the mesh; no_mesh of the background and of what faces away from the light
  std::vector<float> visibility_;
};

}  // namespace

NoisyMask find_noise(const ComposeSide& side) {
  if (!side.frame->has_shares()) return {};
  const NoiseSearch search(side);
  std::vector<char> is_noisy = search.noisy();
  if (std::ranges::find(is_noisy, char{1}) == is_noisy.end()) return {};
  std::vector<float> mean = search.means(is_noisy);
  return {std::move(is_noisy), std::move(mean)};
}

}  // namespace gnomon::viewer
