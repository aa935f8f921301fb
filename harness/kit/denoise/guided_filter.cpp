#include <gnomon/error.h>
#include <gnomon/kit/denoise/filters.h>
#include <gnomon/kit/parallel.h>
#include <gnomon/kit/vectorized.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace gnomon {

namespace {

constexpr int filter_chunk_size = 64;   // pixels of a row at once: their sums stay in the first cache
constexpr std::size_t filter_rows = 8;  // of a task
using FilterChunk = std::array<float, filter_chunk_size>;

/// Pixels of a row: those that are filtered, or those that a tap looks at.
struct FilterSide {
  FilterGuides::Row guides;
  const float* value;
};

FilterSide moved_side(const FilterSide& side, std::ptrdiff_t by) {
  const FilterGuides::Row& g = side.guides;
  return {{g.px + by, g.py + by, g.pz + by, g.nx + by, g.ny + by, g.nz + by, g.per_footprint + by, g.mesh + by},
          side.value + by};
}

constexpr std::size_t planes_at_once = 4;

/// Of each pixel of a chunk: the weight of the tap at hand, and sums over taps so far.
struct FilterSums {
  alignas(64) FilterChunk weight, whole, variance;
  alignas(64) std::array<FilterChunk, planes_at_once> planes;
};

/// Weights of one tap, their sum, and those of two planes under them: in one loop, because a second one would read the weights
/// again. `across` and `down` are the tap's weights by distance.
GNOMON_VECTORIZED void weigh_tap(const FilterSide& middle, const FilterSide& tap, const float* per_deviation,
                                 const float* across, const float* down, bool is_sharp, int count, const float* first,
                                 const float* second, FilterSums& __restrict sums) {
  const FilterGuides::Row p = middle.guides, q = tap.guides;
  const float *value_p = middle.value, *value_q = tap.value;
  for (int i = 0; i < count; ++i) {
    const float dx = q.px[i] - p.px[i], dy = q.py[i] - p.py[i], dz = q.pz[i] - p.pz[i];
    const float apart = std::fabs(p.nx[i] * dx + p.ny[i] * dy + p.nz[i] * dz) * p.per_footprint[i];
    const float e = apart + std::fabs(value_p[i] - value_q[i]) * per_deviation[i];
    const float turn = p.nx[i] * q.nx[i] + p.ny[i] * q.ny[i] + p.nz[i] * q.nz[i];
    const float n1 = turn > 0 ? turn : 0, n2 = n1 * n1, n4 = n2 * n2, n8 = n4 * n4, n16 = n8 * n8, n32 = n16 * n16;
    const float n64 = n32 * n32, normal = is_sharp ? n64 * n64 : n32;
    const float product = across[i] * down[i] * normal / (1 + e * (1 + e * (0.5f + e * (1.0f / 6))));
    const float weight = p.mesh[i] == q.mesh[i] ? product : 0;
    sums.weight[i] = weight;
    sums.whole[i] += weight;
    sums.planes[0][i] += weight * first[i];
    sums.planes[1][i] += weight * second[i];
  }
}

GNOMON_VECTORIZED void add_weighted(const float* weight, const float* plane, int count, float* __restrict sum) {
  for (int i = 0; i < count; ++i) sum[i] += weight[i] * plane[i];
}

GNOMON_VECTORIZED void add_tap_variance(const float* weight, const float* denominator, const float* variance, int count,
                                        float* __restrict sum) {
  for (int i = 0; i < count; ++i) {
    const float w = weight[i] * denominator[i];
    sum[i] += w * w * variance[i];
  }
}

/// sum / whole where `changes` is not 0.
GNOMON_VECTORIZED void divide_sums(const float* sum, const float* whole, const float* changes, const float* before, int count,
                                   float* __restrict after) {
  for (int i = 0; i < count; ++i) {
    const float mean = sum[i] / (whole[i] > 0 ? whole[i] : 1);
    after[i] = ((changes[i] != 0) & (whole[i] > 0)) ? mean : before[i];
  }
}

/// A level of a run: planes start at pixel (0, 0) and have margins.
struct FilterLevel {
  const FilterGuides& guides;
  const FilterRule& rule;
  int step;
  std::span<const UnsetVector<float>> now;  ///< denominators, numerators
  std::span<UnsetVector<float>> next;
  const UnsetVector<float>& variance;
  UnsetVector<float>& variance_next;
  const UnsetVector<float>&value, &per_deviation;
  std::span<const float> strength;

  bool by_value() const { return rule.value_deviations > 0; }
};

/// Weights of taps by distance, of each pixel of a chunk, and in `changes` 1 where a pixel is filtered at all. How many are.
GNOMON_VECTORIZED int lay_filter_taps(const std::uint32_t* mesh, const float* strength, bool is_narrow, int count,
                                      float* __restrict none, float* __restrict one, float* __restrict two,
                                      float* __restrict changes) {
  int changed = 0;
  for (int i = 0; i < count; ++i) {
    const float wanted = strength[i], part = mesh[i] != no_mesh ? wanted : 0, s = part / 4,
                rest = 1 - 2 * s;  // twice (s, rest, s)
    none[i] = is_narrow ? 1 : rest * rest + 2 * (s * s);
    one[i] = is_narrow ? part * (2.0f / 3) : 2 * (s * rest);
    two[i] = s * s;
    changes[i] = part > 0 ? 1.0f : 0.0f;
    changed += part > 0;
  }
  return changed;
}

constexpr FilterChunk full_filter_strength = [] {
  FilterChunk ones{};
  for (float& one : ones) one = 1;
  return ones;
}();

/// Sums under all taps of planes first .. first + held - 1, at most planes_at_once, and of variance beside the first of all.
void sum_taps(const FilterLevel& level, int x, int y, int count, const std::array<FilterChunk, 3>& taps, std::size_t first,
              std::size_t held, FilterSums& sums) {
  const FilterSide middle = moved_side({level.guides.row(y), &level.value[level.guides.at(0, y)]}, x);
  const float* per_deviation = &level.per_deviation[level.guides.at(x, y)];
  const std::size_t second = first + (held > 1 ? 1 : 0);  // one alone is summed up twice
  const int reach = level.rule.reach;
  for (int j = -reach; j <= reach; ++j) {
    const int row = y + j * level.step;
    if (row < 0 || row >= level.guides.height()) continue;
    const FilterSide beside = moved_side({level.guides.row(row), &level.value[level.guides.at(0, row)]}, x);
    for (int i = -reach; i <= reach; ++i) {
      const std::ptrdiff_t by = static_cast<std::ptrdiff_t>(i) * level.step;
      const std::size_t from = static_cast<std::size_t>(static_cast<std::ptrdiff_t>(level.guides.at(x, row)) + by);
      weigh_tap(middle, moved_side(beside, by), per_deviation, taps[std::abs(i)].data(), taps[std::abs(j)].data(),
                level.rule.sharp_normals, count, &level.now[first][from], &level.now[second][from], sums);
      for (std::size_t k = 2; k < held; ++k)
        add_weighted(sums.weight.data(), &level.now[first + k][from], count, sums.planes[k].data());
      if (level.by_value() && first == 0)
        add_tap_variance(sums.weight.data(), &level.now[0][from], &level.variance[from], count, sums.variance.data());
    }
  }
}

void filter_chunk(const FilterLevel& level, int x, int y, int count) {
  const std::size_t at = level.guides.at(x, y), planes = level.now.size();
  std::array<FilterChunk, 3> taps;
  FilterChunk changes;
  const float* strength = level.strength.empty() ? full_filter_strength.data()
                                                 : &level.strength[static_cast<std::size_t>(y) * level.guides.width() + x];
  const int changed = lay_filter_taps(level.guides.row(y).mesh + x, strength, level.rule.reach == 1, count, taps[0].data(),
                                      taps[1].data(), taps[2].data(), changes.data());
  // Followers beyond the first few find the same weights again.
  for (std::size_t first = 0; first < planes; first += planes_at_once) {
    const std::size_t held = std::min(planes_at_once, planes - first);
    FilterSums sums{};
    if (changed > 0) sum_taps(level, x, y, count, taps, first, held, sums);
    for (std::size_t k = 0; k < held; ++k)
      divide_sums(sums.planes[k].data(), sums.whole.data(), changes.data(), &level.now[first + k][at], count,
                  &level.next[first + k][at]);
    if (!level.by_value() || first > 0) continue;
    FilterChunk squares;
    for (int i = 0; i < count; ++i) squares[i] = sums.planes[0][i] * sums.planes[0][i];
    divide_sums(sums.variance.data(), squares.data(), changes.data(), &level.variance[at], count, &level.variance_next[at]);
  }
}

void clear_filter_margins(UnsetVector<float>& plane, std::size_t row_start, int width) {
  std::fill_n(&plane[row_start] - filter_margin, filter_margin, 0.0f);
  std::fill_n(&plane[row_start] + width, filter_margin, 0.0f);
}

/// Adds a row's part of sums over 3x3 pixels that count, of weights (1/4, 1/8, 1/16), and of the weights. `side` is 1/4 in the
/// middle row and 1/8 beside it. The variance of pixels that do not count is 0.
GNOMON_VECTORIZED void blur_variance(const std::uint32_t* mesh, const float* variance, float side, int count,
                                     float* __restrict sum, float* __restrict whole) {
  for (int i = 0; i < count; ++i) {
    const float left = mesh[i - 1] != no_mesh ? 0.5f : 0, middle = mesh[i] != no_mesh ? 1.0f : 0;
    const float right = mesh[i + 1] != no_mesh ? 0.5f : 0;
    sum[i] += side * (left * variance[i - 1] + middle * variance[i] + right * variance[i + 1]);
    whole[i] += side * (left + middle + right);
  }
}

/// Ratios, 1/2 where there is none, and blurred variances.
GNOMON_VECTORIZED void rate_values(const float* numerator, const float* denominator, const float* whole, int count,
                                   float* __restrict value, float* __restrict variance) {
  for (int i = 0; i < count; ++i) {
    const float ratio = numerator[i] / (denominator[i] > 0 ? denominator[i] : 1);
    value[i] = denominator[i] > 0 ? ratio : 0.5f;
    const float mean = variance[i] / (whole[i] > 0 ? whole[i] : 1);
    variance[i] = mean > 0 ? mean : 0;
  }
}

void check_filter_planes(const FilterGuides& guides, const FilterPlanes& planes, std::span<const float> strength,
                         bool by_value) {
  const std::size_t size = static_cast<std::size_t>(guides.width()) * guides.height();
  const auto check_size = [&](std::size_t given, const char* what) {
    if (given != size) throw Error("{} has {} pixels, not the {} of the guides", what, given, size);
  };
  check_size(planes.denominators.size(), "the plane of denominators");
  if (planes.numerators.empty()) throw Error("a filter has 0 planes of numerators, not 1 or more");
  for (const std::span<float> plane : planes.numerators) check_size(plane.size(), "a plane of numerators");
  if (by_value) check_size(planes.variance.size(), "the plane of variances");
  if (!strength.empty()) check_size(strength.size(), "the plane of strengths");
}

}  // namespace

void GuidedFilter::resize(int width, int height, std::size_t numerator_count) {
  const std::size_t size = static_cast<std::size_t>(width + 2 * filter_margin) * height;
  if (now_.size() < numerator_count + 1) {
    now_.resize(numerator_count + 1);
    next_.resize(numerator_count + 1);
  }
  for (std::vector<UnsetVector<float>>* planes : {&now_, &next_})
    for (UnsetVector<float>& plane : *planes) plane.resize(size);
  for (UnsetVector<float>* plane : {&variance_now_, &variance_next_, &value_, &per_deviation_}) plane->resize(size);
  strength_.resize(static_cast<std::size_t>(width) * height);
  width_ = width;
  height_ = height;
}

void GuidedFilter::load(const FilterGuides& guides, const FilterPlanes& planes, bool by_value) {
  if (width_ != guides.width() || height_ != guides.height() || now_.size() <= planes.numerators.size())
    resize(guides.width(), guides.height(), planes.numerators.size());
  const auto row_of = [&](std::span<const float> from, int y, UnsetVector<float>& to) {
    const std::uint32_t* mesh = guides.row(y).mesh;
    const float* source = &from[static_cast<std::size_t>(y) * width_];
    float* target = &to[guides.at(0, y)];
    for (int x = 0; x < width_; ++x) target[x] = mesh[x] != no_mesh ? source[x] : 0;
    clear_filter_margins(to, guides.at(0, y), width_);
  };
  for_blocks(static_cast<std::size_t>(height_), filter_rows, [&](std::size_t begin, std::size_t end) {
    for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y) {
      row_of(planes.denominators, y, now_[0]);
      for (std::size_t k = 0; k < planes.numerators.size(); ++k) row_of(planes.numerators[k], y, now_[k + 1]);
      for (std::size_t k = 0; k <= planes.numerators.size(); ++k) clear_filter_margins(next_[k], guides.at(0, y), width_);
      const std::size_t start = guides.at(0, y) - filter_margin, length = static_cast<std::size_t>(guides.stride());
      std::fill_n(&value_[start], length, 0.0f);
      std::fill_n(&per_deviation_[start], length, 0.0f);
      if (!by_value) continue;
      row_of(planes.variance, y, variance_now_);
      clear_filter_margins(variance_next_, guides.at(0, y), width_);
      for (int x = 0; x < width_; ++x)
        if (guides.counts(x, y) && !(now_[0][guides.at(x, y)] > 0)) variance_now_[guides.at(x, y)] = 0.25f;
    }
  });
}

void GuidedFilter::store(const FilterGuides& guides, const FilterPlanes& planes, bool by_value) const {
  const auto row_of = [&](const UnsetVector<float>& from, int y, std::span<float> to) {
    const std::uint32_t* mesh = guides.row(y).mesh;
    const float* source = &from[guides.at(0, y)];
    float* target = &to[static_cast<std::size_t>(y) * width_];
    for (int x = 0; x < width_; ++x)
      if (mesh[x] != no_mesh) target[x] = source[x];
  };
  for_blocks(static_cast<std::size_t>(height_), filter_rows, [&](std::size_t begin, std::size_t end) {
    for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y) {
      row_of(now_[0], y, planes.denominators);
      for (std::size_t k = 0; k < planes.numerators.size(); ++k) row_of(now_[k + 1], y, planes.numerators[k]);
      if (by_value) row_of(variance_now_, y, planes.variance);
    }
  });
}

void GuidedFilter::look_at_values(const FilterGuides& guides, const FilterRule& rule) {
  const auto look = [&](int x, int y, int count) {
    const std::size_t at = guides.at(x, y);
    FilterChunk variance{}, whole{};
    for (int j = std::max(y - 1, 0); j <= std::min(y + 1, height_ - 1); ++j)
      blur_variance(guides.row(j).mesh + x, &variance_now_[guides.at(x, j)], j == y ? 0.25f : 0.125f, count, variance.data(),
                    whole.data());
    rate_values(&now_[1][at], &now_[0][at], whole.data(), count, &value_[at], variance.data());
    for (int i = 0; i < count; ++i) {
      const float scale = rule.value_deviations * std::sqrt(variance[i]) + rule.value_floor;
      per_deviation_[at + i] = 1 / std::max(scale, 1e-30f);  // finite where the floor is 0
    }
  };
  for_blocks(static_cast<std::size_t>(height_), filter_rows, [&](std::size_t begin, std::size_t end) {
    for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y)
      for (int x = 0; x < width_; x += filter_chunk_size) look(x, y, std::min(filter_chunk_size, width_ - x));
  });
}

void GuidedFilter::run_level(const FilterGuides& guides, const FilterRule& rule, int level, std::size_t numerator_count,
                             std::span<const float> strength) {
  const bool by_value = rule.value_deviations > 0;
  if (by_value) look_at_values(guides, rule);
  const std::size_t planes = numerator_count + 1;
  const FilterLevel at_level{guides,        rule,           1 << level, {now_.data(), planes}, {next_.data(), planes},
                             variance_now_, variance_next_, value_,     per_deviation_,        strength};
  for_blocks(static_cast<std::size_t>(height_), filter_rows, [&](std::size_t begin, std::size_t end) {
    for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y)
      for (int x = 0; x < width_; x += filter_chunk_size) filter_chunk(at_level, x, y, std::min(filter_chunk_size, width_ - x));
  });
  now_.swap(next_);
  if (by_value) variance_now_.swap(variance_next_);
}

void GuidedFilter::run(const FilterGuides& guides, const FilterRule& rule, int first, int last, const FilterPlanes& planes,
                       std::span<const float> strength) {
  const bool by_value = rule.value_deviations > 0;
  if (first < 0 || last < first || last > most_filter_levels)
    throw Error("filter levels {} .. {} are not within 0 .. {}", first, last, most_filter_levels);
  if (rule.reach != 1 && rule.reach != 2) throw Error("a filter's reach of {} taps is neither 1 nor 2", rule.reach);
  check_filter_planes(guides, planes, strength, by_value);
  load(guides, planes, by_value);
  for (int level = first; level < last; ++level) run_level(guides, rule, level, planes.numerators.size(), strength);
  store(guides, planes, by_value);
}

void GuidedFilter::run_by_sigma(const FilterGuides& guides, std::span<const float> sigma, const FilterPlanes& planes) {
  const std::size_t size = static_cast<std::size_t>(guides.width()) * guides.height();
  if (sigma.size() != size) throw Error("the plane of sigmas has {} pixels, not the {} of the guides", sigma.size(), size);
  check_filter_planes(guides, planes, {}, false);
  load(guides, planes, false);
  float widest = 0;
  for (std::size_t i = 0; i < size; ++i) widest = std::max(widest, sigma[i]);
  float done = 0, part = 1;  // of sigma^2, by the levels below; of this level
  for (int level = 0; level < most_filter_levels && widest * widest > done; ++level) {
    for (std::size_t i = 0; i < size; ++i) strength_[i] = std::clamp((sigma[i] * sigma[i] - done) / part, 0.0f, 1.0f);
    run_level(guides, atrous_rule, level, planes.numerators.size(), strength_);
    done += part;
    part *= 4;
  }
  store(guides, planes, false);
}

std::size_t GuidedFilter::bytes() const {
  std::size_t count = variance_now_.size() + variance_next_.size() + value_.size() + per_deviation_.size() + strength_.size();
  for (std::size_t k = 0; k < now_.size(); ++k) count += now_[k].size() + next_[k].size();
  return count * sizeof(float);
}

}  // namespace gnomon
