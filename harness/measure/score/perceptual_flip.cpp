// LDR-FLIP. Source: Andersson, Nilsson, Akenine-Moller, Oskarsson, Astrom, Fairchild 2020. Two paths meet in every pixel:
// colors as seen through the contrast sensitivity of the eye, and edges and points of the lightness, which strengthen the
// difference of the colors. All filters are products of one in x and one in y, or sums of such.
#include <bit>
#include <glm/glm.hpp>

#include "measure/score/perceptual.h"
#include "measure/score/perceptual_tiles.h"

namespace gnomon {

namespace {

constexpr double pixels_per_degree = 67;
constexpr double pi = 3.14159265358979323846;

using Weights = std::vector<float>;

/// Computed at the first use.
template <class Table>
const Table& table() {
  static const Table made;
  return made;
}

template <class Value>
Weights tabulate(int radius, const Value& value) {
  Weights weights;
  for (int k = -radius; k <= radius; ++k) weights.push_back(static_cast<float>(value(static_cast<double>(k))));
  return weights;
}

/// sqrt(pi / b) exp(-pi^2 x^2 / b) with x in degrees, as one factor of a product that sums to `total`. The paper's domain is
/// `radius`; ends below 1e-8 of the middle are cut off, since float32 cannot see them.
struct Sensitivity {
  int radius;
  double b;
  double value(double k) const { return std::exp(-pi * pi * (k / pixels_per_degree) * (k / pixels_per_degree) / b); }
  double sum() const {
    double total = 0;
    for (int k = -radius; k <= radius; ++k) total += value(k);
    return total;
  }
  Weights weights(double total) const {
    int reach = radius;
    while (reach > 0 && value(reach) < 1e-8) --reach;
    const double scale = std::sqrt(total) / sum();
    return tabulate(reach, [&](double k) { return scale * value(k); });
  }
};

/// The weights of the filters, one for each pixel; none of them reaches further than `reach`.
struct Filters {
  int reach = 0;
  Weights achromatic, red_green, blue_yellow[2];
  Weights smooth, slope, curve;  ///< of the features: edges are slope by smooth, points curve by smooth

  Filters() {
    // Every channel is filtered over the domain of the widest Gaussian.
    const int radius = static_cast<int>(std::ceil(3 * std::sqrt(0.04 / (2 * pi * pi)) * pixels_per_degree));
    achromatic = Sensitivity{radius, 0.0047}.weights(1);
    red_green = Sensitivity{radius, 0.0053}.weights(1);
    const Sensitivity wide{radius, 0.04}, narrow{radius, 0.025};
    const double volume_wide = 34.1 * std::sqrt(pi / 0.04) * wide.sum() * wide.sum();
    const double volume_narrow = 13.5 * std::sqrt(pi / 0.025) * narrow.sum() * narrow.sum();
    blue_yellow[0] = wide.weights(volume_wide / (volume_wide + volume_narrow));
    blue_yellow[1] = narrow.weights(volume_narrow / (volume_wide + volume_narrow));

    const double sigma = 0.5 * 0.082 * pixels_per_degree;
    const int feature_radius = static_cast<int>(std::ceil(3 * sigma));
    const auto gaussian = [&](double k) { return std::exp(-k * k / (2 * sigma * sigma)); };
    double gaussian_sum = 0, slope_sum = 0, above = 0, below = 0;
    const auto curvature = [&](double k) { return (k * k / (sigma * sigma) - 1) * gaussian(k); };
    for (int k = -feature_radius; k <= feature_radius; ++k) {
      gaussian_sum += gaussian(k);
      slope_sum += std::max(0.0, -k * gaussian(k));
      above += std::max(0.0, curvature(k));
      below += std::max(0.0, -curvature(k));
    }
    // Positive weights sum to 1 and negative ones to -1 in the product.
    smooth = tabulate(feature_radius, [&](double k) { return gaussian(k) / gaussian_sum; });
    slope = tabulate(feature_radius, [&](double k) { return -k * gaussian(k) / slope_sum; });
    curve = tabulate(feature_radius, [&](double k) { return curvature(k) / (curvature(k) > 0 ? above : below); });
    reach = std::max(radius, feature_radius);
  }
};

/// Between linear sRGB and XYZ relative to the white of sRGB (D65), in which every coordinate of white is 1.
struct Colors {
  float to_xyz[3][3], to_rgb[3][3];
  std::array<float, 256> linear;

  Colors() {
    // Columns are the primaries.
    const glm::dmat3 xyz(10135552 / 24577794.0, 2613072 / 12288897.0, 1425312 / 73733382.0,  //
                         8788810 / 24577794.0, 8788810 / 12288897.0, 8788810 / 73733382.0,   //
                         4435075 / 24577794.0, 887015 / 12288897.0, 70074185 / 73733382.0);
    const glm::dvec3 white = xyz * glm::dvec3(1);
    glm::dmat3 relative = xyz;
    for (int c = 0; c < 3; ++c) relative[c] /= white;
    const glm::dmat3 back = glm::inverse(relative);
    for (int row = 0; row < 3; ++row)
      for (int column = 0; column < 3; ++column) {
        to_xyz[row][column] = static_cast<float>(relative[column][row]);
        to_rgb[row][column] = static_cast<float>(back[column][row]);
      }
    for (int i = 0; i < 256; ++i) {
      const double s = i / 255.0;
      linear[i] = static_cast<float>(s > 0.04045 ? std::pow((s + 0.055) / 1.055, 2.4) : s / 12.92);
    }
  }
};

/// Cube root of 0 .. 1 without a branch, so that it vectorizes: a third of the exponent, then Halley's method twice, which
/// triples the digits each time. Error below 2.2e-7 of the root (tried on every 64th float of
/// 0.008 .. 1; smaller arguments take the straight part of L*).
[[gnu::always_inline]] inline float cube_root(float t) {
  float y = std::bit_cast<float>(static_cast<std::int32_t>(static_cast<float>(std::bit_cast<std::int32_t>(t)) * (1.0f / 3)) +
                                 709921077);
  for (int step = 0; step < 2; ++step) {
    const float cube = y * y * y;
    y *= (cube + 2 * t) / (2 * cube + t);
  }
  return y;
}

/// L*a*b* of relative XYZ, its chroma scaled by 0.01 L* (Hunt): colors of dark things differ less.
struct Lab {
  float l, a, b;
};
[[gnu::always_inline]] inline Lab hunt_lab(float x, float y, float z) {
  constexpr float d = 6.0f / 29;
  const auto f = [](float t) __attribute__((always_inline)) {
    const float root = cube_root(t > d * d * d ? t : d * d * d), straight = t / (3 * d * d) + 4.0f / 29;
    return t > d * d * d ? root : straight;
  };
  const float fx = f(x), fy = f(y), fz = f(z), l = 116 * fy - 16;
  return {l, 0.01f * l * 500 * (fx - fy), 0.01f * l * 200 * (fy - fz)};
}

[[gnu::always_inline]] inline float hyab(const Lab& p, const Lab& q) {
  const float a = p.a - q.a, b = p.b - q.b;
  return std::abs(p.l - q.l) + std::sqrt(a * a + b * b);
}

/// What the eye makes of one tile of a picture: colors, and the strength of edges and points.
struct Percept {
  Layer<float> l, a, b, edges, points;
};

GNOMON_VECTORIZED Percept perceive(const Picture& picture, const Tile& tile) {
  const Filters& filter = table<Filters>();
  const Colors& color = table<Colors>();
  const auto& xyz = color.to_xyz;
  const auto& rgb = color.to_rgb;
  const int reach = filter.reach, width = tile.width() + 2 * reach, height = tile.height() + 2 * reach;

  // The opponent space Y Cx Cz is linear in XYZ; its scales and offset cancel, so y, x - y and y - z are filtered.
  Layer<float> lightness(width, height), red_green(width, height), blue_yellow(width, height);
  for (int y = 0; y < height; ++y) {
    const int from_y = std::clamp(tile.y0 - reach + y, 0, picture.height - 1);
    const std::uint8_t* from = &picture.rgb[static_cast<std::size_t>(from_y) * picture.width * 3];
    for (int x = 0; x < width; ++x) {
      const std::uint8_t* p = from + 3 * std::clamp(tile.x0 - reach + x, 0, picture.width - 1);
      const float r = color.linear[p[0]], g = color.linear[p[1]], b = color.linear[p[2]];
      const float cx = xyz[0][0] * r + xyz[0][1] * g + xyz[0][2] * b, cy = xyz[1][0] * r + xyz[1][1] * g + xyz[1][2] * b;
      const float cz = xyz[2][0] * r + xyz[2][1] * g + xyz[2][2] * b;
      lightness.row(y)[x] = cy;
      red_green.row(y)[x] = cx - cy;
      blue_yellow.row(y)[x] = cy - cz;
    }
  }
  const auto both = [&](const Layer<float>& plane, const Weights& in_x, const Weights& in_y) {
    return along_y(along_x(plane, in_x, reach - static_cast<int>(in_x.size()) / 2), in_y,
                   reach - static_cast<int>(in_y.size()) / 2);
  };
  Percept seen{both(lightness, filter.achromatic, filter.achromatic), both(red_green, filter.red_green, filter.red_green),
               both(blue_yellow, filter.blue_yellow[0], filter.blue_yellow[0]), both(lightness, filter.slope, filter.smooth),
               both(lightness, filter.curve, filter.smooth)};
  const Layer<float> narrow = both(blue_yellow, filter.blue_yellow[1], filter.blue_yellow[1]);
  const Layer<float> smooth = along_x(lightness, filter.smooth, reach - static_cast<int>(filter.smooth.size()) / 2);
  const int margin = reach - static_cast<int>(filter.slope.size()) / 2;
  const Layer<float> edges_y = along_y(smooth, filter.slope, margin), points_y = along_y(smooth, filter.curve, margin);

  float *sl = seen.l.values.data(), *sa = seen.a.values.data(), *sb = seen.b.values.data();
  float *edge = seen.edges.values.data(), *point = seen.points.values.data();
  const float *n = narrow.values.data(), *ey = edges_y.values.data(), *py = points_y.values.data();
  const std::size_t count = seen.l.values.size();
  const auto unit = [](float v) { return v < 0 ? 0.0f : v > 1 ? 1.0f : v; };
  for (std::size_t i = 0; i < count; ++i) {
    const float cy = sl[i], cx = cy + sa[i], cz = cy - (sb[i] + n[i]);
    const float r = unit(rgb[0][0] * cx + rgb[0][1] * cy + rgb[0][2] * cz);
    const float g = unit(rgb[1][0] * cx + rgb[1][1] * cy + rgb[1][2] * cz);
    const float b = unit(rgb[2][0] * cx + rgb[2][1] * cy + rgb[2][2] * cz);
    const Lab lab = hunt_lab(xyz[0][0] * r + xyz[0][1] * g + xyz[0][2] * b, xyz[1][0] * r + xyz[1][1] * g + xyz[1][2] * b,
                             xyz[2][0] * r + xyz[2][1] * g + xyz[2][2] * b);
    sl[i] = lab.l;
    sa[i] = lab.a;
    sb[i] = lab.b;
  }
  for (std::size_t i = 0; i < count; ++i) {
    edge[i] = std::sqrt(edge[i] * edge[i] + ey[i] * ey[i]);
    point[i] = std::sqrt(point[i] * point[i] + py[i] * py[i]);
  }
  return seen;
}

constexpr float color_exponent = 0.7f;

/// Differences of colors brought to 0 .. 1: below 0.4 of the largest difference, green against blue, they take 0 .. 0.95.
float redistribute(float difference) {
  static const float largest = [] {
    const auto& xyz = table<Colors>().to_xyz;
    return std::pow(hyab(hunt_lab(xyz[0][1], xyz[1][1], xyz[2][1]), hunt_lab(xyz[0][2], xyz[1][2], xyz[2][2])), color_exponent);
  }();
  const float knee = 0.4f * largest;
  return difference < knee ? 0.95f / knee * difference : 0.95f + (difference - knee) / (largest - knee) * 0.05f;
}

double noticed(const Picture& reference, const Picture& test, const Tile& tile) {
  const Percept r = perceive(reference, tile), t = perceive(test, tile);
  double sum = 0;
  for (std::size_t i = 0; i < r.l.values.size(); ++i) {
    const float distance = hyab({r.l.values[i], r.a.values[i], r.b.values[i]}, {t.l.values[i], t.a.values[i], t.b.values[i]});
    if (distance == 0) continue;
    const float color = std::min(1.0f, redistribute(std::pow(distance, color_exponent)));
    const float feature =
        std::max(std::abs(r.edges.values[i] - t.edges.values[i]), std::abs(r.points.values[i] - t.points.values[i]));
    sum += std::pow(color, 1 - std::min(1.0f, std::sqrt(feature * std::sqrt(0.5f))));
  }
  return sum;
}

}  // namespace

std::optional<double> flip(const Picture& reference, const Picture& test) {
  require_same_size(reference, test);
  if (reference.width < 1 || reference.height < 1) return std::nullopt;
  const double sum = sum_over_tiles({0, 0, reference.width, reference.height}, [&](const Tile& tile) {
    return is_same(reference, test, tile, table<Filters>().reach) ? 0.0 : noticed(reference, test, tile);
  });
  return sum / (static_cast<double>(reference.width) * reference.height);
}

}  // namespace gnomon
