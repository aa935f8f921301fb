#include "report/figure/figure_names.h"

#include <gnomon/error.h>

#include <algorithm>
#include <set>

namespace gnomon {

namespace {

struct SettingParts {
  std::string technique;            ///< or a label, which has no values
  std::vector<std::string> values;  ///< "bias=slope"
};

SettingParts parts_of_setting(const std::string& setting) {
  const std::size_t colon = setting.find(':');
  if (colon == setting.npos) return {setting, {}};
  SettingParts parts{setting.substr(0, colon), {}};
  for (std::size_t from = colon + 1; from <= setting.size();) {
    const std::size_t end = std::min(setting.find(',', from), setting.size());
    const std::string part = setting.substr(from, end - from);
    // A value may hold commas.
    if (part.find('=') == part.npos && !parts.values.empty())
      parts.values.back() += "," + part;
    else
      parts.values.push_back(part);
    from = end + 1;
  }
  return parts;
}

std::string key_of(const std::string& value) { return value.substr(0, value.find('=')); }

/// Settings without what they share.
struct SharedParts {
  std::string technique;            ///< empty: they have several
  std::vector<std::string> values;  ///< that all have
  std::vector<SettingParts> rest;

  std::string heading() const {
    if (technique.empty()) return joined(values, ", ");
    return technique + (values.empty() ? "" : ": " + joined(values, ", "));
  }
};

SharedParts share(const std::vector<std::string>& settings) {
  SharedParts shared;
  for (const std::string& setting : settings) shared.rest.push_back(parts_of_setting(setting));
  if (std::set<std::string>(settings.begin(), settings.end()).size() < 2) return shared;
  const std::vector<std::string> candidates = shared.rest.front().values;
  for (const std::string& value : candidates) {
    const auto has_it = [&](const SettingParts& parts) { return std::ranges::find(parts.values, value) != parts.values.end(); };
    if (!std::ranges::all_of(shared.rest, has_it)) continue;
    shared.values.push_back(value);
    for (SettingParts& parts : shared.rest) std::erase(parts.values, value);
  }
  // A setting of which nothing else is left keeps its technique for a name.
  const std::string technique = shared.rest.front().technique;
  if (std::ranges::all_of(shared.rest,
                          [&](const SettingParts& parts) { return parts.technique == technique && !parts.values.empty(); }))
    shared.technique = technique;
  return shared;
}

std::string with_technique(const SharedParts& shared, const SettingParts& parts, const std::string& values) {
  if (!shared.technique.empty()) return values;
  return parts.technique + (values.empty() ? "" : ": " + values);
}

}  // namespace

ShortNames without_shared(const std::vector<std::string>& settings) {
  const SharedParts shared = share(settings);
  ShortNames names{shared.heading(), {}};
  if (names.heading.empty()) return {"", settings};
  for (const SettingParts& parts : shared.rest)
    names.names.push_back(with_technique(shared, parts, joined(parts.values, ", ")));
  return names;
}

ShortNames values_alone(const std::vector<std::string>& settings) {
  const SharedParts shared = share(settings);
  std::vector<std::pair<std::string, std::vector<std::string>>> keys;  // of each technique, in the order of the settings
  ShortNames names;
  for (const SettingParts& parts : shared.rest) {
    std::vector<std::string> own, values;
    for (const std::string& value : parts.values) {
      own.push_back(key_of(value));
      values.push_back(value.substr(std::min(own.back().size() + 1, value.size())));
    }
    const auto known = std::ranges::find(keys, parts.technique, [](const auto& one) { return one.first; });
    if (known == keys.end())
      keys.emplace_back(parts.technique, own);
    else if (known->second != own)
      return without_shared(settings);
    names.names.push_back(with_technique(shared, parts, joined(values, ", ")));
  }
  std::vector<std::string> headings;
  if (!shared.values.empty()) headings.push_back(shared.heading());
  for (const auto& [technique, own] : keys)
    if (!own.empty())
      headings.push_back((headings.empty() || shared.technique.empty() ? technique + ": " : "") + joined(own, ", "));
  names.heading = joined(headings, "; ");
  return names;
}

}  // namespace gnomon
