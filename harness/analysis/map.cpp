#include "analysis/map.h"

#include <algorithm>
#include <charconv>
#include <cstring>
#include <map>

namespace gnomon {

namespace {

using Values = std::map<std::string, std::string>;  // by parameter

std::string text_of(const Json& value) { return value.is_string() ? value.get<std::string>() : value.dump(); }

std::optional<double> number_of(const std::string& text) {
  double value = 0;
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
  return code == std::errc{} && end == text.data() + text.size() ? std::optional(value) : std::nullopt;
}

/// "1.0" and "1" are the same number: the shorter one is shown.
std::string shown_value(const Json& value) {
  if (!value.is_number()) return text_of(value);
  return fmt::format("{}", value.get<double>());
}

/// One setting of a technique: its parameters and what it measured where.
struct Setting {
  Values values;
  std::map<Place, double> measured;
};

/// Values of one parameter in the order that people expect.
std::vector<std::string> ordered(std::vector<std::string> values) {
  const bool are_numbers = std::all_of(values.begin(), values.end(), [](const auto& v) { return number_of(v).has_value(); });
  if (are_numbers)
    std::stable_sort(values.begin(), values.end(), [](const auto& a, const auto& b) { return *number_of(a) < *number_of(b); });
  return values;
}

/// Different values of a parameter among settings, ordered.
std::vector<std::string> values_of(const std::vector<Setting>& settings, const std::string& parameter) {
  std::vector<std::string> values;
  for (const Setting& setting : settings) {
    const auto found = setting.values.find(parameter);
    if (found != setting.values.end() && std::find(values.begin(), values.end(), found->second) == values.end())
      values.push_back(found->second);
  }
  return ordered(std::move(values));
}

/// Numeric parameters by their number of values, most first; the order of declaration breaks ties.
std::vector<std::string> natural_axes(const std::vector<Setting>& settings, const std::vector<std::string>& declared,
                                      std::span<const std::string> taken) {
  std::vector<std::pair<std::size_t, std::string>> candidates;
  for (const std::string& parameter : declared) {
    if (std::find(taken.begin(), taken.end(), parameter) != taken.end()) continue;
    const std::vector<std::string> values = values_of(settings, parameter);
    if (values.size() > 1 && number_of(values.front())) candidates.emplace_back(values.size(), parameter);
  }
  std::stable_sort(candidates.begin(), candidates.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  std::vector<std::string> names;
  for (const auto& [count, parameter] : candidates) names.push_back(parameter);
  return names;
}

void make_technique_maps(const std::string& technique, const std::vector<Setting>& settings,
                         const std::vector<std::string>& declared, const MapOptions& options, std::vector<Map>& maps) {
  std::string x = options.x, y = options.y;
  const std::vector<std::string> natural = natural_axes(settings, declared, std::vector{x, y, options.facet});
  std::size_t next = 0;
  if (x.empty() && next < natural.size()) x = natural[next++];
  if (y.empty() && next < natural.size() && options.x.empty()) y = natural[next++];
  std::vector<std::string> varying;
  for (const std::string& parameter : declared)
    if (values_of(settings, parameter).size() > 1) varying.push_back(parameter);
  const auto varies = [&](const std::string& p) { return std::find(varying.begin(), varying.end(), p) != varying.end(); };
  if (x.empty() && !varying.empty()) x = varying.front();
  if (!varies(x)) return;  // this technique was not swept along this axis
  if (!varies(y)) y.clear();

  std::set<Place> common;
  for (const auto& [place, value] : settings.front().measured) common.insert(place);
  for (const Setting& setting : settings)
    std::erase_if(common, [&](const Place& place) { return !setting.measured.contains(place); });
  if (common.empty()) return;

  std::vector<std::string> facets;
  if (!options.facet.empty() && varies(options.facet)) facets.push_back(options.facet);
  for (const std::string& parameter : varying)
    if (parameter != x && parameter != y && parameter != options.facet) facets.push_back(parameter);

  const std::size_t first_map = maps.size();
  std::map<std::vector<std::string>, std::vector<const Setting*>> by_facet;
  std::vector<std::vector<std::string>> order;
  for (const Setting& setting : settings) {
    std::vector<std::string> key;
    for (const std::string& facet : facets) key.push_back(setting.values.at(facet));
    if (!by_facet.contains(key)) order.push_back(key);
    by_facet[key].push_back(&setting);
  }
  for (const auto& key : order) {
    const std::vector<const Setting*>& members = by_facet[key];
    std::vector<Setting> copies;
    for (const Setting* member : members) copies.push_back({member->values, {}});
    Map map{.technique = technique,
            .facet = {},
            .x = x,
            .y = y,
            .xs = values_of(copies, x),
            .ys = {""},
            .cells = {},
            .places = common.size()};
    for (std::size_t i = 0; i < facets.size(); ++i) map.facet.emplace_back(facets[i], key[i]);
    if (!y.empty()) map.ys = values_of(copies, y);
    map.cells.resize(map.xs.size() * map.ys.size());
    for (const Setting* member : members) {
      double sum = 0;
      for (const Place& place : common) sum += member->measured.at(place);
      const auto index = [](const std::vector<std::string>& values, const std::string& value) {
        return static_cast<std::size_t>(std::find(values.begin(), values.end(), value) - values.begin());
      };
      const std::size_t row = y.empty() ? 0 : index(map.ys, member->values.at(y));
      map.cells[row * map.xs.size() + index(map.xs, member->values.at(x))].value = sum / static_cast<double>(common.size());
    }
    maps.push_back(std::move(map));
  }

  std::optional<double> best;
  const std::string_view direction = better(options.metric);
  if (direction.empty()) return;
  const auto beats = [&](double a, double b) { return direction == "higher" ? a > b : a < b; };
  for (std::size_t i = first_map; i < maps.size(); ++i)
    for (const Map::Cell& cell : maps[i].cells)
      if (cell.value && (!best || beats(*cell.value, *best))) best = cell.value;
  for (std::size_t i = first_map; i < maps.size(); ++i)
    for (Map::Cell& cell : maps[i].cells) cell.is_best = cell.value && cell.value == best;
}

}  // namespace

std::vector<Map> make_maps(std::span<const Record> records, const MapOptions& options) {
  require_quantity(records, options.metric);
  const std::pair<const char*, const std::string&> axes[] = {
      {"--x", options.x}, {"--y", options.y}, {"--facet", options.facet}};
  for (const auto& [first, parameter] : axes)
    for (const auto& [second, again] : axes)
      if (std::strcmp(first, second) != 0 && !parameter.empty() && parameter == again)
        throw Error("{} and {} are both {}; each wants a parameter of its own", first, second, parameter);
  std::vector<std::string> techniques, known{"scene", "light"};
  std::map<std::string, std::vector<std::string>> declared;  // by technique, parameters in their order
  std::map<std::string, std::map<std::string, Setting>> settings;
  std::map<std::string, std::vector<std::string>> order;  // of the settings of a technique
  const std::set<std::string> wanted{options.x, options.y, options.facet};
  for (const Record& r : records) {
    const std::optional<double> value = quantity(r, options.metric);
    if (r.status != Status::ok || !value) continue;
    if (!declared.contains(r.technique)) techniques.push_back(r.technique);
    std::vector<std::string>& parameters = declared[r.technique];
    const auto declare = [&](const std::string& parameter) {
      if (std::find(parameters.begin(), parameters.end(), parameter) == parameters.end()) parameters.push_back(parameter);
      if (std::find(known.begin(), known.end(), parameter) == known.end()) known.push_back(parameter);
    };
    Values values;
    for (const auto& [parameter, one] : r.parameters.items()) {
      declare(parameter);
      values[parameter] = shown_value(one);
    }
    // A scene or light that is an axis is no part of the mean.
    Place place = place_of(r);
    const std::pair<const char*, std::string&> parts_of_place[] = {{"scene", place.scene}, {"light", place.light}};
    for (const auto& [axis, part] : parts_of_place) {
      if (!wanted.contains(axis)) continue;
      declare(axis);
      values[axis] = std::exchange(part, "");
    }
    std::string key;
    for (const auto& [parameter, one] : values) key += fmt::format("{}={}\n", parameter, one);
    Setting& setting = settings[r.technique][key];
    if (setting.measured.empty()) order[r.technique].push_back(key);
    setting.values = std::move(values);
    setting.measured[place] = *value;
  }
  for (const std::string& name : {options.x, options.y, options.facet})
    if (!name.empty() && std::find(known.begin(), known.end(), name) == known.end())
      throw Error("there is no parameter {}; did you mean {}? There are: {}", name, nearest_word(name, known),
                  fmt::join(known, ", "));

  std::vector<Map> maps;
  for (const std::string& technique : techniques) {
    std::vector<Setting> all;
    for (const std::string& key : order[technique]) all.push_back(settings[technique][key]);
    // Every setting must have every parameter: records of two versions may differ in them.
    for (const std::string& parameter : declared[technique])
      for (Setting& setting : all) setting.values.try_emplace(parameter, "-");
    if (all.size() > 1) make_technique_maps(technique, all, declared[technique], options, maps);
  }
  if (maps.empty())
    throw Error("there is nothing to map: no technique has two settings that finished the same scenes{}; {}",
                options.x.empty() ? "" : fmt::format(" and differ in {}", options.x),
                how_to_sweep(options.x.empty() ? "PARAMETER" : options.x));
  return maps;
}

}  // namespace gnomon
