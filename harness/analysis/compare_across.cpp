#include "analysis/compare_across.h"

#include <gnomon/error.h>
#include <gnomon/param.h>

#include <algorithm>
#include <set>

#include "measure/run/suite.h"

namespace gnomon {

namespace {

/// "a=1,b=2" without the part of this parameter.
std::string settings_without(const std::string& settings, const std::string& parameter) {
  std::vector<std::string> parts = parts_outside_braces(settings);
  std::erase_if(parts, [&](const std::string& part) { return part.starts_with(parameter + '='); });
  return joined(parts, ",");
}

}  // namespace

TwoValues parse_two_values(const std::string& text) {
  const std::size_t equals = text.find('='), comma = text.find(',', std::min(equals, text.size()));
  TwoValues across;
  if (equals != std::string::npos && comma != std::string::npos && text.find(',', comma + 1) == std::string::npos)
    across = {text.substr(0, equals), text.substr(equals + 1, comma - equals - 1), text.substr(comma + 1)};
  if (across.parameter.empty() || across.base.empty() || across.contender.empty() || across.base == across.contender)
    throw Error("--across {} is not PARAMETER=A,B with two values of a parameter, as version=r170,r187", text);
  return across;
}

std::vector<Record> rows_across(const std::vector<Record>& records, const std::string& parameter, const std::string& value) {
  std::vector<Record> rows;
  std::set<std::string> parameters, values;
  for (const Record& record : records) {
    for (const auto& [name, unused] : record.parameters.items()) parameters.insert(name);
    const auto found = record.parameters.find(parameter);
    if (found == record.parameters.end()) continue;
    values.insert(plain_text(*found));
    if (plain_text(*found) != value) continue;
    Record& row = rows.emplace_back(record);
    row.job.clear();
    row.settings = settings_without(row.settings, parameter);
    row.parameters.erase(parameter);
  }
  const std::vector<std::string> known(parameters.begin(), parameters.end());
  if (values.empty())
    throw Error("--across {}: no row has this parameter{}", parameter,
                known.empty() ? "" : fmt::format("; did you mean {}?", joined(nearest_words(parameter, known, 3), ", ")));
  if (rows.empty()) throw Error("--across {}={}: no row has this value; there are: {}", parameter, value, joined(values, ", "));
  return rows;
}

}  // namespace gnomon
