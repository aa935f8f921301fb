#pragma once
#include <gnomon/registry.h>

#include "measure/cause/causes.h"

namespace gnomon {

/// A technique has at most so many: each needs a color that people can distinguish from all others.
inline constexpr std::size_t most_own_causes = 32;
/// The smallest distance in CIE Lab of such a cause's color from every other cause's and from the grays of error pictures, also
/// for people without one kind of cone. 2.3 is just noticeable side by side.
inline constexpr double least_color_distance = 10;

/// The k-th cause of a technique's own, in the order of its data sheet.
constexpr Cause own_cause(std::size_t k) { return static_cast<Cause>(static_cast<std::size_t>(Cause::unexplained) + 1 + k); }
/// The rows of a technique's own causes. They refer to the texts of the data sheet.
std::vector<CauseInfo> own_causes(const About& about);
/// The common causes, then these.
std::vector<CauseInfo> with_common(std::span<const CauseInfo> own);
/// The one of this name. Throws Error with the name and those that there are.
Cause own_cause_named(std::string_view name, std::span<const CauseInfo> own);

/// Throws Error on the first cause that conflicts with the others: its id is no plain name, `none`, one of the common causes,
/// or there twice; it has no sentence; its color is too near to another one; or another technique has a cause of this id with
/// another sentence or color.
void check_own_causes(std::span<const TechniqueEntry> techniques);

}  // namespace gnomon
