#pragma once
#include <span>
#include <string>

#include "measure/picture/picture.h"
#include "measure/picture/shading.h"
#include "measure/score/metrics.h"

namespace gnomon {

/// A kind of error as pictures and legends show it.
struct ErrorKind {
  Color color;
  std::string label;  ///< "false dark", "peter panning"
};
/// The causes, in their order; without causes false dark and false lit, in the colors of acne and of peter-panning.
std::span<const ErrorKind> error_kinds(bool with_causes);

/// Which of these kinds a pixel is, with causes where the evidence has them; -1 where it is untested, right, or has no cause.
inline int error_kind(const Evidence& evidence, std::size_t i) {
  if (evidence.classes[i] != PixelClass::T) return -1;
  if (!evidence.causes.empty()) return static_cast<int>(evidence.causes[i]) - 1;  // Cause::none is 0
  if (!evidence.is_wrong(i)) return -1;
  return evidence.mask[i] < evidence.reference[i] ? 0 : 1;
}

/// The scene in dim gray, wrong tested pixels in the color of their cause over it (of false dark and false lit where the
/// evidence has no causes), and below it a legend with the share of each in T. The evidence has scene, G-buffer and light.
Picture draw_errors(const Evidence& evidence, const std::string& title);

}  // namespace gnomon
