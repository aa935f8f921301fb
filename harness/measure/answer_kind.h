#pragma once
#include <cstddef>
#include <string_view>

namespace gnomon {

/// The question at every pixel.
enum class AnswerKind {
  binary,    ///< whether the light arrives
  fraction,  ///< what part of the light arrives
  received,  ///< of several lights together, what part of their light the pixel receives
};
inline constexpr AnswerKind all_answer_kinds[] = {AnswerKind::binary, AnswerKind::fraction, AnswerKind::received};
inline constexpr std::string_view answer_kind_names[] = {"binary", "fraction", "received"};
constexpr std::string_view name(AnswerKind kind) { return answer_kind_names[static_cast<std::size_t>(kind)]; }

}  // namespace gnomon
