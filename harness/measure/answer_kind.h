#pragma once
#include <gnomon/scene.h>

#include <cstddef>
#include <string_view>

namespace gnomon {

/// The question at every pixel.
enum class AnswerKind {
  binary,       ///< whether the light arrives
  fraction,     ///< what part of a light with area arrives
  received,     ///< of several lights together, what part of their light the pixel receives
  transmitted,  ///< what part of a light without area arrives, where casters let a part of it through
};
inline constexpr AnswerKind all_answer_kinds[] = {AnswerKind::binary, AnswerKind::fraction, AnswerKind::received,
                                                  AnswerKind::transmitted};
inline constexpr std::string_view answer_kind_names[] = {"binary", "fraction", "received", "transmitted"};
/// Whether causes are told by their part in the error: every pixel that is off has one, not only those that are wrong.
constexpr bool has_cause_errors(AnswerKind kind) { return kind == AnswerKind::fraction || kind == AnswerKind::received; }
constexpr std::string_view name(AnswerKind kind) { return answer_kind_names[static_cast<std::size_t>(kind)]; }

/// That is true under one light.
inline AnswerKind answer_kind(const Scene& scene, const Light& light) {
  if (has_area(light)) return AnswerKind::fraction;
  return scene.has_transmission() ? AnswerKind::transmitted : AnswerKind::binary;
}

}  // namespace gnomon
