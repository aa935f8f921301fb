#include "measure/score/error_picture.h"

#include <algorithm>
#include <functional>

#include "measure/cause/own_causes.h"
#include "measure/picture/legend.h"

namespace gnomon {

std::vector<ErrorKind> error_kinds(bool with_causes, bool is_soft, std::span<const CauseInfo> own) {
  const auto color = [](Cause cause) { return cause_infos()[static_cast<std::size_t>(cause) - 1].color; };
  if (!with_causes)
    return {{color(Cause::acne), is_soft ? "too dark" : "false dark"},
            {color(Cause::peter_panning), is_soft ? "too light" : "false lit"}};
  std::vector<ErrorKind> kinds;
  for (const CauseInfo& info : with_common(own)) {
    kinds.push_back({info.color, std::string(info.name)});
    std::ranges::replace(kinds.back().label, '_', ' ');
  }
  return kinds;
}

namespace {

/// What the pixels of T add up to.
struct Sums {
  double tested = 0, error = 0, floor = 0;  ///< pixels, |mask - reference|, and what the reference's own noise makes of that
  std::vector<double> marked;               ///< pixels by kind
  std::vector<double> errors;               ///< of |mask - reference| by kind, those below the first step too
};

Sums add_up(const Evidence& e, std::span<const ErrorMark> marks, std::size_t kinds) {
  Sums sums{.marked = std::vector<double>(kinds), .errors = std::vector<double>(kinds)};
  for (std::size_t i = 0; i < marks.size(); ++i) {
    if (e.classes[i] != PixelClass::T) continue;
    const double error = std::abs(static_cast<double>(e.mask[i]) - e.reference[i]);
    ++sums.tested;
    sums.error += error;
    if (!e.reference_half.empty()) sums.floor += std::abs(static_cast<double>(e.reference_half[i]) - e.reference[i]);
    if (marks[i].kind >= 0) ++sums.marked[marks[i].kind];
    if (const int kind = kind_of(e, i); kind >= 0) sums.errors[kind] += error;
  }
  return sums;
}

/// The kinds that occur, largest first; equal ones in their order.
std::vector<std::size_t> by_size(std::span<const double> sizes) {
  std::vector<std::size_t> kinds;
  for (std::size_t k = 0; k < sizes.size(); ++k)
    if (sizes[k] > 0) kinds.push_back(k);
  std::ranges::stable_sort(kinds, std::greater<>(), [&](std::size_t k) { return sizes[k]; });
  return kinds;
}

/// The share of each kind in T.
void add_wrong(PictureLegend& legend, std::span<const ErrorKind> kinds, const Sums& sums) {
  for (const std::size_t k : by_size(sums.marked))
    legend.add(kinds[k].color, kinds[k].label + " " + percent(sums.marked[k] / sums.tested));
  if (std::ranges::max(sums.marked) == 0) legend.add(std::nullopt, "no tested pixel is wrong");
}

/// The error and what it is made of, then the scale of the colors.
void add_soft(PictureLegend& legend, std::span<const ErrorKind> kinds, const Sums& sums, const Evidence& e) {
  if (sums.tested == 0) return legend.add(std::nullopt, "no pixel is tested");
  const std::string floor = e.reference_half.empty() ? "" : ", floor " + percent(sums.floor / sums.tested);
  legend.add(std::nullopt,
             (e.channels.empty() ? "error " : "error of the worst channel ") + percent(sums.error / sums.tested) + floor);
  for (const std::size_t k : by_size(sums.errors))
    legend.add(kinds[k].color, kinds[k].label + " " + percent(sums.errors[k] / sums.error) + " of it");
  constexpr std::uint8_t gray = 128;
  if (std::ranges::max(sums.marked) == 0)
    return legend.add(std::nullopt, "no tested pixel is off by " + percent(error_steps.front().least));
  const auto strongest = static_cast<std::size_t>(std::ranges::max_element(sums.errors) - sums.errors.begin());
  for (const ErrorStep& step : error_steps)
    legend.add(marked(gray, kinds[strongest].color, step.weight),
               fmt::format("{}{:.0f} %{}", &step == &error_steps.front() ? "off by " : "", 100 * step.least,
                           &step == &error_steps.back() ? " or more" : ""));
}

}  // namespace

Picture draw_errors(const Evidence& evidence, const std::string& title) {
  const GBuffer& gbuffer = *evidence.gbuffer;
  const bool soft = is_soft(evidence);
  const std::vector<ErrorKind> kinds = error_kinds(evidence, soft);
  std::vector<ErrorMark> marks(gbuffer.size());
  for (std::size_t i = 0; i < gbuffer.size(); ++i) marks[i] = error_mark(evidence, i, soft);
  const Sums sums = add_up(evidence, marks, kinds.size());
  PictureLegend legend(gbuffer.width);
  if (!title.empty()) legend.add(std::nullopt, title);
  soft ? add_soft(legend, kinds, sums, evidence) : add_wrong(legend, kinds, sums);

  const std::vector<float> lit(gbuffer.size(), 1.0f);
  const Picture shaded = evidence.light ? shade(*evidence.scene, gbuffer, *evidence.light, lit)
                                        : shade(*evidence.scene, gbuffer, evidence.received, lit);
  Picture picture{gbuffer.width, gbuffer.height, std::vector<std::uint8_t>(3 * gbuffer.size())};
  for (std::size_t i = 0; i < gbuffer.size(); ++i) {
    const std::uint8_t* s = &shaded.rgb[3 * i];
    const std::uint8_t level = dimmed({s[0], s[1], s[2]}, evidence.classes[i] == PixelClass::T);
    const Color color =
        marks[i].kind >= 0 ? marked(level, kinds[marks[i].kind].color, marks[i].weight) : Color{level, level, level};
    std::ranges::copy(color, &picture.rgb[3 * i]);
  }
  return with_legend(std::move(picture), legend);
}

}  // namespace gnomon
