// Looks for one change of the whole reference that makes it the mask.
#include "measure/cause/whole_mask.h"

#include <gnomon/kit/parallel.h>

#include <algorithm>
#include <set>

#include "measure/cause/soft_causes.h"

namespace gnomon {

namespace {

/// Rows of the picture. Changes are fitted on some and made of all.
struct Rows {
  int begin, end;
};
/// What a change makes of the reference in these rows, every pixel of them; NaN where that is undefined.
using Made = std::vector<float>;

/// What the mask is compared with.
std::span<const float> truth_of(const Attribution& a) {
  return a.reference.kind == AnswerKind::fraction ? SoftTruth(a).share : a.reference.mask;
}

class Finder {
 public:
  explicit Finder(const Attribution& a) : a_(a) {}

  std::optional<WholeMask> find() {
    if (error_before_.back() == 0) return std::nullopt;
    std::vector<WholeMask> candidates{best_shift(), best_blur()};
    if (has_levels()) candidates.push_back(best_gamma());
    for (const Change change : {Change::upside_down, Change::mirrored, Change::turned, Change::inverted})
      candidates.push_back({.change = change});
    WholeMask* best = nullptr;
    for (WholeMask& candidate : candidates) {
      candidate.explained = explained(candidate, fitted_);
      if (!best || candidate.explained > best->explained) best = &candidate;
    }
    best->changed = make(*best, {0, height_});
    best->explained = explained(best->changed, {0, height_});
    if (best->explained < least_explained) return std::nullopt;
    return std::move(*best);
  }

 private:
  using Change = WholeMask::Change;

  /// Whether a power would change the reference, and in more than one way: 0 and 1 stay what they are, and of one or two
  /// shares behind glass any error is some power.
  bool has_levels() const {
    if (a_.reference.kind != AnswerKind::transmitted) return a_.reference.kind != AnswerKind::binary;
    std::set<float> levels;
    for (std::size_t i = 0; i < truth_.size() && levels.size() < 3; ++i)
      if (is_tested(i) && truth_[i] > 0 && truth_[i] < 1) levels.insert(truth_[i]);
    return levels.size() >= 3;
  }
  bool is_tested(std::size_t i) const { return a_.reference.classes[i] == PixelClass::T; }
  std::size_t at(int x, int y) const { return static_cast<std::size_t>(y) * width_ + x; }
  double error(std::size_t i) const { return std::abs(static_cast<double>(a_.mask[i]) - truth_[i]); }

  /// The median of the mask over the pixels of a class; 0 where there are none.
  float median_of_mask(PixelClass of) const {
    std::vector<float> values;
    for (std::size_t i = 0; i < a_.mask.size(); ++i)
      if (a_.reference.classes[i] == of) values.push_back(a_.mask[i]);
    if (values.empty()) return 0;
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::ranges::nth_element(values, middle);
    return *middle;
  }

  /// The reference. Over background and over surfaces turned from the light, where it has no answer, the median of the mask
  /// there, whatever its maker writes.
  std::vector<float> whole_picture() const {
    std::vector<float> picture(truth_.begin(), truth_.end());
    for (const PixelClass of : {PixelClass::B, PixelClass::F}) {
      const float value = median_of_mask(of);
      for (std::size_t i = 0; i < picture.size(); ++i)
        if (a_.reference.classes[i] == of) picture[i] = value;
    }
    return picture;
  }

  /// The sum of errors above each row, and of all.
  std::vector<double> errors_before_rows() const {
    std::vector<double> before(height_ + 1, 0);
    for (int y = 0; y < height_; ++y) {
      before[y + 1] = before[y];
      for (std::size_t i = at(0, y); i < at(0, y + 1); ++i)
        if (is_tested(i)) before[y + 1] += error(i);
    }
    return before;
  }

  /// About a million pixels.
  Rows rows_with_most_error() const {
    const int count = std::min(height_, std::max(64, (1 << 20) / width_));
    const auto held = [&](int y) { return error_before_[y + count] - error_before_[y]; };
    int best = 0;
    for (int y = 0; y + count <= height_; ++y)
      if (held(y) > held(best)) best = y;
    return {best, best + count};
  }

  double explained(const WholeMask& change, Rows rows) const { return explained(make(change, rows), rows); }
  /// The share of the error that goes with this in the reference's place. Minus infinity where too much of it is at pixels of
  /// which nothing is known, and where the mask is as near to one value everywhere: a black mask is not an inverted one.
  double explained(const Made& made, Rows rows) const {
    std::vector<glm::dvec3> sums(rows.end - rows.begin, glm::dvec3(0));  // of each row: before, after, from one value
    for_blocks(sums.size(), 16, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin * width_; k < end * width_; ++k) {
        const std::size_t i = at(0, rows.begin) + k;
        if (!is_tested(i) || std::isnan(made[k])) continue;
        const double v = a_.mask[i];
        sums[k / width_] += glm::dvec3(error(i), std::abs(v - made[k]), std::abs(v - one_value_));
      }
    });
    glm::dvec3 sum(0);
    for (const glm::dvec3& row : sums) sum += row;
    const double before = sum.x, after = sum.y, from_one_value = sum.z;
    const bool is_known = before > 0 && 2 * before >= error_before_[rows.end] - error_before_[rows.begin];
    return is_known && after <= (1 - least_explained) * from_one_value ? 1 - after / before : -INFINITY;
  }

  Made make(const WholeMask& change, Rows rows) const {
    const auto each = [&](const auto& value) {
      Made made(at(0, rows.end) - at(0, rows.begin));
      for_blocks(rows.end - rows.begin, 16, [&](std::size_t begin, std::size_t end) {
        for (std::size_t row = begin; row < end; ++row)
          for (int x = 0; x < width_; ++x) made[row * width_ + x] = value(x, rows.begin + static_cast<int>(row));
      });
      return made;
    };
    switch (change.change) {
      case Change::shift:
        return each([&](int x, int y) { return between(x - change.shift.x, y - change.shift.y); });
      case Change::gamma:
        return each([&](int x, int y) { return static_cast<float>(std::pow(truth_[at(x, y)], change.gamma)); });
      case Change::blur:
        return blurred(change.sigma, rows);
      case Change::upside_down:
        return each([&](int x, int y) { return answer(x, height_ - 1 - y); });
      case Change::mirrored:
        return each([&](int x, int y) { return answer(width_ - 1 - x, y); });
      case Change::turned:
        return each([&](int x, int y) { return answer(width_ - 1 - x, height_ - 1 - y); });
      case Change::inverted:
        return each([&](int x, int y) { return 1 - answer(x, y); });
    }
    return {};
  }

  float answer(int x, int y) const { return x < 0 || y < 0 || x >= width_ || y >= height_ ? NAN : picture_[at(x, y)]; }
  /// Bilinear, of the neighbors that have weight.
  float between(double x, double y) const {
    const int left = static_cast<int>(std::floor(x)), top = static_cast<int>(std::floor(y));
    const double u = x - left, v = y - top;
    double sum = 0;
    for (int k = 0; k < 4; ++k)
      if (const double weight = (k % 2 ? u : 1 - u) * (k / 2 ? v : 1 - v); weight > 0)
        sum += weight * answer(left + k % 2, top + k / 2);
    return static_cast<float>(sum);
  }

  /// The mean of what is around, weighted by a Gaussian; what is beside the picture has no weight.
  Made blurred(double sigma, Rows rows) const {
    constexpr int band = 256;  // rows: what is held beside the outcome
    Made made;
    for (int y = rows.begin; y < rows.end; y += band) {
      const Made some = blurred_band(sigma, {y, std::min(y + band, rows.end)});
      made.insert(made.end(), some.begin(), some.end());
    }
    return made;
  }
  Made blurred_band(double sigma, Rows rows) const {
    const int reach = static_cast<int>(std::ceil(3 * sigma));
    std::vector<double> weights;
    for (int k = -reach; k <= reach; ++k) weights.push_back(std::exp(-k * k / (2 * sigma * sigma)));
    const Rows read{std::max(0, rows.begin - reach), std::min(height_, rows.end + reach)};
    // Along the rows: sums of answers and of weights.
    std::vector<glm::dvec2> sums(at(0, read.end) - at(0, read.begin));
    for_blocks(read.end - read.begin, 16, [&](std::size_t begin, std::size_t end) {
      for (std::size_t row = begin; row < end; ++row)
        for (int x = 0; x < width_; ++x) {
          glm::dvec2 sum(0);
          for (int j = std::max(0, x - reach); j <= std::min(width_ - 1, x + reach); ++j)
            sum += weights[j - x + reach] * glm::dvec2(picture_[at(j, read.begin + static_cast<int>(row))], 1);
          sums[row * width_ + x] = sum;
        }
    });
    Made made(at(0, rows.end) - at(0, rows.begin));
    for_blocks(rows.end - rows.begin, 16, [&](std::size_t begin, std::size_t end) {
      for (std::size_t row = begin; row < end; ++row) {
        const int y = rows.begin + static_cast<int>(row);
        std::vector<glm::dvec2> column(width_, glm::dvec2(0));
        for (int j = std::max(read.begin, y - reach); j <= std::min(read.end - 1, y + reach); ++j)
          for (int x = 0; x < width_; ++x) column[x] += weights[j - y + reach] * sums[at(x, j - read.begin)];
        for (int x = 0; x < width_; ++x) made[row * width_ + x] = static_cast<float>(column[x].x / column[x].y);
      }
    });
    return made;
  }

  /// The best whole number of pixels; and between pixels, where either mask has more than two values.
  WholeMask best_shift() const {
    WholeMask best{.change = Change::shift, .explained = -INFINITY};
    const auto try_at = [&](const glm::dvec2& shift) {
      WholeMask there{.change = Change::shift, .shift = shift};
      if (shift == glm::dvec2(0) || std::max(std::abs(shift.x), std::abs(shift.y)) > most_shift) return false;
      there.explained = explained(there, fitted_);
      if (there.explained <= best.explained) return false;
      best = std::move(there);
      return true;
    };
    for (int dy = -most_shift; dy <= most_shift; ++dy)
      for (int dx = -most_shift; dx <= most_shift; ++dx) try_at({dx, dy});
    if (a_.reference.kind == AnswerKind::binary && std::ranges::all_of(a_.mask, [](float v) { return v == 0 || v == 1; }))
      return best;
    for (double step = 0.5; step >= 1.0 / 32; step /= 2)
      for (bool is_better = true; is_better;) {
        is_better = false;
        const glm::dvec2 center = best.shift;
        for (int k = 0; k < 9; ++k)
          if (k != 4) is_better |= try_at(center + step * glm::dvec2(k % 3 - 1, k / 3 - 1));
      }
    return best;
  }

  WholeMask best_gamma() const { return best_along({.change = Change::gamma}, &WholeMask::gamma, 0.2, 5); }
  WholeMask best_blur() const { return best_along({.change = Change::blur}, &WholeMask::sigma, 0.25, most_sigma); }
  /// Of numbers from `least` to `most` the one that explains the most: a few in equal ratios, then between the best one's
  /// neighbors by thirds.
  WholeMask best_along(WholeMask change, double WholeMask::*number, double least, double most) const {
    constexpr int count = 12, thirds = 12;
    const double ratio = std::pow(most / least, 1.0 / (count - 1));
    const auto explained_by = [&](double value) {
      change.*number = value;
      return explained(change, fitted_);
    };
    int best = 0;
    std::vector<double> found;
    for (int k = 0; k < count; ++k) {
      found.push_back(explained_by(least * std::pow(ratio, k)));
      if (found[k] > found[best]) best = k;
    }
    double low = least * std::pow(ratio, std::max(best - 1, 0)), high = least * std::pow(ratio, std::min(best + 1, count - 1));
    for (int k = 0; k < thirds; ++k) {
      const double a = low + (high - low) / 3, b = high - (high - low) / 3;
      if (explained_by(a) > explained_by(b))
        high = b;
      else
        low = a;
    }
    change.*number = (low + high) / 2;
    return change;
  }

  const Attribution& a_;
  const int width_ = a_.gbuffer.width, height_ = a_.gbuffer.height;
  const std::span<const float> truth_ = truth_of(a_);
  const std::vector<float> picture_ = whole_picture();
  const double one_value_ = median_of_mask(PixelClass::T);  ///< nearest to all tested pixels of the mask
  const std::vector<double> error_before_ = errors_before_rows();
  const Rows fitted_ = rows_with_most_error();
};

/// One change is one row, in the order of WholeMask::Change.
struct ChangeRow {
  std::string_view name;
  Cause cause = Cause::none;
  std::string_view words = {};  ///< where they depend on no number
};
constexpr ChangeRow change_rows[] = {
    {"shift", Cause::mask_shift},
    {"gamma", Cause::mask_gamma},
    {"blur", Cause::mask_blur},
    {"upside_down", Cause::none, "upside down"},
    {"mirrored", Cause::none, "mirrored, left to right"},
    {"turned", Cause::none, "turned by 180 degrees"},
    {"inverted", Cause::none, "inverted (1 must be lit, 0 in shadow)"},
};
const ChangeRow& row_of(WholeMask::Change change) { return change_rows[static_cast<std::size_t>(change)]; }

}  // namespace

bool WholeMask::explains(const Attribution& a, std::size_t i) const {
  const auto off = [&](float truth) { return std::abs(static_cast<double>(a.mask[i]) - truth); };
  return cause() != Cause::none && off(changed[i]) < off(truth_of(a)[i]) / 2;  // never of a NaN
}

std::string_view name(WholeMask::Change change) { return row_of(change).name; }

Cause WholeMask::cause() const { return row_of(change).cause; }

std::string WholeMask::words() const {
  if (change == Change::gamma) return fmt::format("raised to the power {:.2f}, as by a gamma curve", gamma);
  if (change == Change::blur) return fmt::format("blurred, by a filter of {:.2g} px standard deviation", sigma);
  if (change != Change::shift) return std::string(row_of(change).words);
  const auto part = [](double by, const char* back, const char* forth) {
    return by == 0 ? "" : fmt::format("{:.4g} px {}", std::abs(by), by < 0 ? back : forth);
  };
  const std::string across = part(shift.x, "left", "right"), along = part(shift.y, "up", "down");
  return fmt::format("shifted by {}{}{}", across, across.empty() || along.empty() ? "" : " and ", along);
}

std::optional<WholeMask> find_whole_mask(const Attribution& attribution) { return Finder(attribution).find(); }

}  // namespace gnomon
