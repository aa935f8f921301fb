#pragma once
#include <gnomon/technique.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <utility>

namespace gnomon {

/// A count without unit.
template <class Number>
Count count_of(std::string name, Number value) {
  return {std::move(name), static_cast<double>(value), ""};
}
/// A count without unit of what queries met in a tree.
template <class Number>
Count count_by_tree(std::string name, Number value) {
  return {std::move(name), static_cast<double>(value), "", Count::Together::sum, true};
}
/// A count without unit that says how far something went: of several objects the largest.
template <class Number>
Count most_of(std::string name, Number value) {
  return {std::move(name), static_cast<double>(value), "", Count::Together::largest};
}
/// `sum` for each of `count`, which may be none.
inline Count mean_of(std::string name, std::uint64_t sum, std::uint64_t count) {
  return {std::move(name), static_cast<double>(sum) / static_cast<double>(std::max<std::uint64_t>(count, 1)), "",
          Count::Together::mean};
}

}  // namespace gnomon
