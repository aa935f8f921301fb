#include "report/figure/figure_axis.h"

#include <limits>

namespace gnomon {

std::string short_number(double value) {
  static constexpr std::pair<double, const char*> suffixes[] = {{1e9, "G"}, {1e6, "M"}, {1e4, "k"}};
  for (const auto& [least, suffix] : suffixes)
    if (value >= least) return fmt::format("{:.3g}{}", value / (least == 1e4 ? 1e3 : least), suffix);
  return fmt::format("{:.4g}", value);
}

std::string log_tics(double least, double greatest, std::size_t most) {
  // The densest of these that keeps the number of labels.
  using Digits = std::initializer_list<int>;
  // What a double can hold, however small or large the ends of an axis come out.
  constexpr int least_power = -324, greatest_power = std::numeric_limits<double>::max_exponent10;
  const int first =
      static_cast<int>(std::min<double>(greatest_power, std::max<double>(least_power, std::floor(std::log10(least)))));
  const Digits dense{1, 2, 3, 5, 7}, usual{1, 2, 5}, sparse{1, 3}, powers{1};
  std::string text;
  for (const Digits& digits : {dense, usual, sparse, powers}) {
    std::vector<std::string> tics;
    std::size_t labels = 0;
    for (int k = first; k <= greatest_power && std::pow(10, k) <= greatest; ++k)
      for (int digit = 1; digit <= 9; ++digit) {
        const double at = k < 0 ? digit / std::pow(10, -k) : digit * std::pow(10, k);
        if (at < least * 0.999 || at > greatest * 1.001 || !std::isfinite(at)) continue;
        const bool is_labeled = std::ranges::find(digits, digit) != digits.end();
        labels += is_labeled;
        tics.push_back(is_labeled ? fmt::format("{} {}", FigureScript::quoted(short_number(at)), at)
                                  : fmt::format("'' {} 1", at));
      }
    text = fmt::format("({})", joined(tics, ", "));
    if (labels <= most) break;
  }
  return text;
}

std::string value_tics(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
  if (values.empty() || values.front() <= 0) return "";
  for (std::size_t i = 1; i < values.size(); ++i)
    if (std::log(values[i] / values[i - 1]) < share * std::log(values.back() / values.front())) return "";
  std::vector<std::string> tics;
  for (const double value : values) tics.push_back(fmt::format("{} {}", FigureScript::quoted(short_number(value)), value));
  return fmt::format("({})", joined(tics, ", "));
}

bool are_spaced_by_ratio(std::span<const double> values) {
  if (values.size() < 3) return false;
  Extent steps, ratios;
  for (std::size_t k = 1; k < values.size(); ++k) {
    steps.add(values[k] - values[k - 1]);
    ratios.add(std::log(values[k] / values[k - 1]));
  }
  return steps.greatest >= 2 * steps.least && ratios.greatest <= 1.6 * ratios.least;
}

double linear_step(double least, double greatest, std::size_t most) {
  const double span = greatest - least;
  if (!(span > 0)) return 1;
  const double rough = span / static_cast<double>(std::max<std::size_t>(most, 1));
  const double power = std::pow(10, std::floor(std::log10(rough)));
  for (const double digit : {1.0, 2.0, 5.0})
    if (digit * power >= rough * 0.999999) return digit * power;
  return 10 * power;
}

std::vector<std::string> linear_names(double least, double greatest, double step) {
  std::vector<std::string> names;
  const double first = std::ceil(least / step - 1e-6), last = std::floor(greatest / step + 1e-6);
  // Adding 0 makes -0 a 0.
  for (double k = first; k <= last && names.size() < 100; ++k) names.push_back(fmt::format("{:g}", k * step + 0.0));
  return names;
}

std::vector<std::string> names_of_tics(std::string_view tics) {
  std::vector<std::string> names;
  for (std::size_t from; (from = tics.find('\'')) != tics.npos;) {
    tics.remove_prefix(from + 1);
    const std::size_t end = std::min(tics.find('\''), tics.size());
    if (end > 0) names.emplace_back(tics.substr(0, end));
    tics.remove_prefix(std::min(end + 1, tics.size()));
  }
  return names;
}

std::string word_tics(const std::vector<std::string>& words, bool do_turn) {
  std::vector<std::string> all;
  for (std::size_t k = 0; k < words.size(); ++k) all.push_back(fmt::format("{} {}", FigureScript::quoted_tic(words[k]), k));
  return fmt::format("{} ({})", do_turn ? "rotate by 45 right" : "norotate center", joined(all, ", "));
}

namespace {

constexpr double label_height_cm = 0.3, mark_cm = 0.2;

/// A label's box, in cm.
struct LabelBox {
  PanelPoint middle;
  double width, height;
};

/// By how much boxes cover each other along both axes.
double overlap(const LabelBox& a, const LabelBox& b) {
  const double across = (a.width + b.width) / 2 - std::abs(a.middle.x - b.middle.x);
  const double up = (a.height + b.height) / 2 - std::abs(a.middle.y - b.middle.y);
  return across > 0 && up > 0 ? across * up : 0;
}

double outside(const LabelBox& box, const PanelGrid& grid) {
  const auto beyond = [](double middle, double size, double end) {
    return std::max(0.0, size / 2 - middle) + std::max(0.0, middle + size / 2 - end);
  };
  return beyond(box.middle.x, box.width, grid.width_cm) + beyond(box.middle.y, box.height, grid.height_cm);
}

}  // namespace

std::vector<PanelPoint> label_offsets(std::span<const PanelPoint> marks, std::span<const std::string> labels,
                                      std::span<const PanelPoint> all_marks, const PanelGrid& grid) {
  std::vector<PanelPoint> offsets;
  std::vector<LabelBox> placed;
  for (std::size_t k = 0; k < marks.size(); ++k) {
    const double width = FigureScript::text_cm(labels[k]);
    std::optional<PanelPoint> best;
    double least = INFINITY;
    for (const double distance : {0.12, 0.3, 0.55, 0.85})
      for (const auto& [x, y] :
           std::initializer_list<PanelPoint>{{-1, -1}, {1, -1}, {-1, 1}, {1, 1}, {0, -1}, {0, 1}, {-1, 0}, {1, 0}}) {
        const PanelPoint offset{x * (distance + width / 2), y * (distance + label_height_cm / 2)};
        const LabelBox box{{marks[k].x + offset.x, marks[k].y + offset.y}, width, label_height_cm};
        double cost = distance * 0.001 + 10 * outside(box, grid);
        for (const LabelBox& other : placed) cost += 10 * overlap(box, other);
        for (const PanelPoint& mark : all_marks) cost += overlap(box, {mark, mark_cm, mark_cm});
        if (cost >= least) continue;
        least = cost;
        best = offset;
      }
    offsets.push_back(*best);
    placed.push_back({{marks[k].x + best->x, marks[k].y + best->y}, width, label_height_cm});
  }
  return offsets;
}

}  // namespace gnomon
