#pragma once
#include <string>
#include <vector>

#include "measure/record/record.h"

namespace gnomon {

/// Two values of a parameter whose rows are compared with each other: two versions of an engine, two filters.
struct TwoValues {
  std::string parameter;
  std::string base, contender;  ///< values, as records have them
};

/// Reads "version=r170,r187". Throws Error on another form and on equal values.
TwoValues parse_two_values(const std::string& text);

/// The rows in which the parameter has this value, without the parameter, so that compare matches them with those of another
/// value. Labels stay. Throws Error, with what there is, where no row has the parameter or the value.
std::vector<Record> rows_across(const std::vector<Record>& records, const std::string& parameter, const std::string& value);

}  // namespace gnomon
