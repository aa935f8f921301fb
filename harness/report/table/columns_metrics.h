#pragma once
#include <cmath>
#include <optional>

#include "report/table/columns.h"

namespace gnomon {

/// Nothing, NaN and infinity are null.
template <class T>
Cell number(const std::optional<T>& value) {
  return value && std::isfinite(static_cast<double>(*value)) ? Cell{.value = static_cast<double>(*value)} : Cell{};
}

/// All metrics, against the headline truth and against each.
void add_metrics(std::vector<Column>& columns);
/// Of a row of several lights the error of the one that is worst.
void add_worst_light(std::vector<Column>& columns);

}  // namespace gnomon
