// SSIM. Source: Wang, Bovik, Sheikh, Simoncelli 2004, equations 13 to 17. In double: with values near 1, variances near 0 are
// differences of nearly equal numbers.
#include "measure/score/perceptual.h"
#include "measure/score/perceptual_tiles.h"

namespace gnomon {

namespace {

constexpr int radius = 5;

/// The window is the product of this with itself.
const std::vector<double>& window() {
  static const auto weights = [] {
    std::vector<double> w;
    for (int k = -radius; k <= radius; ++k) w.push_back(std::exp(-k * k / (2 * 1.5 * 1.5)));
    const double sum = std::accumulate(w.begin(), w.end(), 0.0);
    for (double& weight : w) weight /= sum;
    return w;
  }();
  return weights;
}

/// Sum of the local similarities of a tile all of whose windows lie in the picture.
GNOMON_VECTORIZED double similarity(const Picture& reference, const Picture& test, const Tile& tile) {
  const int width = tile.width() + 2 * radius, height = tile.height() + 2 * radius;
  Layer<double> a(width, height), b(width, height), aa(width, height), bb(width, height), ab(width, height);
  for (int y = 0; y < height; ++y) {
    const std::size_t begin = (static_cast<std::size_t>(tile.y0 - radius + y) * reference.width + tile.x0 - radius) * 3;
    const std::uint8_t *r = &reference.rgb[begin], *t = &test.rgb[begin];
    const std::size_t row = static_cast<std::size_t>(y) * width;
    for (int x = 0; x < width; ++x) {
      const double va = (0.2126 * r[3 * x] + 0.7152 * r[3 * x + 1] + 0.0722 * r[3 * x + 2]) / 255;
      const double vb = (0.2126 * t[3 * x] + 0.7152 * t[3 * x + 1] + 0.0722 * t[3 * x + 2]) / 255;
      a.values[row + x] = va;
      b.values[row + x] = vb;
      aa.values[row + x] = va * va;
      bb.values[row + x] = vb * vb;
      ab.values[row + x] = va * vb;
    }
  }
  const Layer<double> mean_a = along_y(along_x(a, window()), window()), mean_b = along_y(along_x(b, window()), window());
  const Layer<double> mean_aa = along_y(along_x(aa, window()), window()), mean_bb = along_y(along_x(bb, window()), window());
  const Layer<double> mean_ab = along_y(along_x(ab, window()), window());
  constexpr double c1 = 0.01 * 0.01, c2 = 0.03 * 0.03;
  double sum = 0;
  for (std::size_t i = 0; i < mean_a.values.size(); ++i) {
    const double ma = mean_a.values[i], mb = mean_b.values[i];
    const double variances = mean_aa.values[i] - ma * ma + mean_bb.values[i] - mb * mb,
                 covariance = mean_ab.values[i] - ma * mb;
    sum += (2 * ma * mb + c1) * (2 * covariance + c2) / ((ma * ma + mb * mb + c1) * (variances + c2));
  }
  return sum;
}

}  // namespace

std::optional<double> ssim(const Picture& reference, const Picture& test) {
  require_same_size(reference, test);
  const Tile inner{radius, radius, reference.width - radius, reference.height - radius};
  if (inner.width() < 1 || inner.height() < 1) return std::nullopt;
  const double sum = sum_over_tiles(inner, [&](const Tile& tile) {
    if (is_same(reference, test, tile, radius)) return static_cast<double>(tile.width()) * tile.height();
    return similarity(reference, test, tile);
  });
  return sum / (static_cast<double>(inner.width()) * inner.height());
}

void require_same_size(const Picture& a, const Picture& b) {
  if (a.width != b.width || a.height != b.height)
    throw Error("pictures of {}x{} and {}x{} cannot be compared; their sizes must be equal", a.width, a.height, b.width,
                b.height);
}

}  // namespace gnomon
