#pragma once
#include "analysis/front.h"

namespace gnomon {

/// What a technique pays for an error: the cheapest of its settings that err no more.
struct Enough {
  std::string technique;
  double budget = 0;                   ///< the error's unit
  std::optional<std::size_t> setting;  ///< of the field's candidates; nothing when none errs so little
  std::size_t least = 0;               ///< the candidate of the technique that errs least
};

/// Of each budget in turn all techniques but the baseline, the cheapest first, and at last those of which no setting is enough.
/// Techniques pay for themselves alone, so references are among them. A setting that does not beat the best constant mask is
/// never enough, nor is one without the cost of the field. Of quantities whose direction is "higher" a budget is the least that
/// will do.
std::vector<Enough> find_enough(const Field& field, std::span<const double> budgets, std::string_view direction);

}  // namespace gnomon
