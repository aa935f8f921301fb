#pragma once
#include "measure/picture/picture.h"
#include "measure/picture/shading.h"
#include "measure/score/metrics.h"

namespace gnomon {

/// A kind of error as pictures and legends show it.
struct ErrorKind {
  Color color;
  std::string label;  ///< "false dark", "peter panning"
};
/// The causes, in their order, the common ones and those of the technique's own; without causes false dark and false lit, in
/// the colors of acne and of peter-panning: under a light with area too dark and too light.
std::vector<ErrorKind> error_kinds(bool with_causes, bool is_soft = false, std::span<const CauseInfo> own = {});
/// Those of an evidence.
inline std::vector<ErrorKind> error_kinds(const Evidence& evidence, bool is_soft) {
  return error_kinds(!evidence.causes.empty(), is_soft, evidence.own_causes);
}

/// The strength of a color shows the size of an error under a light with area: from `least` on the kind's color has this
/// weight. The same in every picture, so that pictures can be compared.
struct ErrorStep {
  double least, weight;
};
inline constexpr std::array<ErrorStep, 4> error_steps{{{0.01, 0.3}, {0.03, 0.5}, {0.1, 0.75}, {0.3, 1}}};

/// How a pixel is shown.
struct ErrorMark {
  int kind = -1;      ///< of error_kinds, with causes where the evidence has them; -1: none
  double weight = 1;  ///< of the kind's color over the scene's gray
};

/// Whether errors are differences of shares, not wrong pixels: under a light with area, and of several lights together; behind
/// glass where no causes are known, which only wrong pixels have.
inline bool is_soft(const Evidence& evidence) {
  return has_cause_errors(evidence.kind) || (evidence.kind == AnswerKind::transmitted && evidence.causes.empty());
}

/// The kind of a pixel's error, however small; with causes -1 where it has none.
inline int kind_of(const Evidence& evidence, std::size_t i) {
  if (!evidence.causes.empty()) return static_cast<int>(evidence.causes[i]) - 1;  // Cause::none is 0
  return evidence.mask[i] < evidence.reference[i] ? 0 : 1;
}

/// A pixel has none where it is untested, has no cause though causes are known, and where it is right: under a light with area
/// off by less than the first step.
inline ErrorMark error_mark(const Evidence& evidence, std::size_t i, bool is_soft) {
  if (evidence.classes[i] != PixelClass::T) return {};
  const float difference = evidence.mask[i] - evidence.reference[i];
  double weight = is_soft ? 0 : evidence.is_wrong(i);
  if (is_soft)
    for (const ErrorStep& step : error_steps)
      if (std::abs(difference) >= step.least) weight = step.weight;
  return weight > 0 ? ErrorMark{kind_of(evidence, i), weight} : ErrorMark{};
}

/// The color of a mark over a gray.
inline Color marked(std::uint8_t gray, const Color& color, double weight) {
  Color mixed;
  for (std::size_t c = 0; c < mixed.size(); ++c)
    mixed[c] = static_cast<std::uint8_t>(std::lround(gray + weight * (static_cast<int>(color[c]) - gray)));
  return mixed;
}

/// The scene in dim gray, over it wrong tested pixels in the color of their cause (of false dark and false lit where the
/// evidence has no causes), and below it a legend with the share of each in T, largest first. Under a light with area every
/// tested pixel that is off, as strongly as it is; the legend says error, floor, and what the colors mean. Of several channels
/// a pixel shows the one that errs most there. The evidence has scene and G-buffer, and its light or the light received of
/// several.
Picture draw_errors(const Evidence& evidence, const std::string& title);

}  // namespace gnomon
