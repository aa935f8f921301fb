#include "analysis/map.h"

#include <cmath>

#include "analysis/in_order.h"
#include "measure/counted.h"

namespace gnomon {

namespace {

using Values = std::map<std::string, std::string>;  // by parameter

/// "1.0" and "1" are the same number: the shorter one is shown.
std::string shown_value(const Json& value) {
  if (!value.is_number()) return plain_text(value);
  return fmt::format("{}", value.get<double>());
}

/// What a setting measured in a place.
struct Measured {
  double value = 0;
  bool is_fraction = false;  ///< the answer, where the light is part of the place
  double gain = 0;           ///< over the best constant mask; infinite where the record does not say
};

/// One setting of a technique: its parameters and what it measured where.
struct Setting {
  Values values;
  std::map<Place, Measured> measured;
};

/// Different values of a parameter among settings: numbers by size, words by appearance.
std::vector<std::string> values_of(const std::vector<Setting>& settings, const std::string& parameter) {
  std::vector<std::string> values;
  for (const Setting& setting : settings)
    if (const auto found = setting.values.find(parameter); found != setting.values.end()) add_once(values, found->second);
  if (std::ranges::all_of(values, [](const auto& v) { return number_from(v).has_value(); }))
    std::ranges::stable_sort(values, {}, [](const auto& v) { return *number_from(v); });
  return values;
}

/// Numeric parameters by their number of values, most first; the order of declaration breaks ties.
std::vector<std::string> natural_axes(const std::vector<Setting>& settings, const std::vector<std::string>& declared,
                                      std::span<const std::string> taken) {
  std::vector<std::pair<std::size_t, std::string>> candidates;
  for (const std::string& parameter : declared) {
    if (std::ranges::find(taken, parameter) != taken.end()) continue;
    const std::vector<std::string> values = values_of(settings, parameter);
    if (values.size() > 1 && number_from(values.front())) candidates.emplace_back(values.size(), parameter);
  }
  std::ranges::stable_sort(candidates, [](const auto& a, const auto& b) { return a.first > b.first; });
  std::vector<std::string> names;
  for (const auto& [count, parameter] : candidates) names.push_back(parameter);
  return names;
}

/// What the maps of one technique show: parameters along x and y (empty: none), and those that its maps differ in. x
/// is empty where the technique was not swept along the requested axis.
struct Axes {
  std::string x, y;
  std::vector<std::string> facets;
};

Axes choose_axes(const std::vector<Setting>& settings, const std::vector<std::string>& declared, const MapOptions& options) {
  Axes axes{.x = options.x, .y = options.y, .facets = {}};
  const std::vector<std::string> natural = natural_axes(settings, declared, std::vector{axes.x, axes.y, options.facet});
  std::size_t next = 0;
  if (axes.x.empty() && next < natural.size()) axes.x = natural[next++];
  if (axes.y.empty() && next < natural.size() && options.x.empty()) axes.y = natural[next++];
  std::vector<std::string> varying;
  for (const std::string& parameter : declared)
    if (values_of(settings, parameter).size() > 1) varying.push_back(parameter);
  const auto varies = [&](const std::string& p) { return std::ranges::find(varying, p) != varying.end(); };
  if (axes.x.empty() && !varying.empty()) axes.x = varying.front();
  if (!varies(axes.x)) return {};
  if (!varies(axes.y)) axes.y.clear();
  if (!options.facet.empty() && varies(options.facet)) axes.facets.push_back(options.facet);
  for (const std::string& parameter : varying)
    if (parameter != axes.x && parameter != axes.y && parameter != options.facet) axes.facets.push_back(parameter);
  return axes;
}

/// The map of the settings that are alike in their facets.
Map make_map(const std::vector<Setting>& members, const Axes& axes, const std::set<Place>& places) {
  Map map;
  map.x = axes.x;
  map.y = axes.y;
  map.xs = values_of(members, axes.x);
  map.ys = axes.y.empty() ? std::vector<std::string>{""} : values_of(members, axes.y);
  map.cells.resize(map.xs.size() * map.ys.size());
  map.places = places.size();
  for (const Place& place : places) map.places_with_fractions += members.front().measured.at(place).is_fraction;
  for (const std::string& facet : axes.facets) map.facet.emplace_back(facet, members.front().values.at(facet));
  for (const Setting& member : members) {
    double sum = 0, gain = 0;
    for (const Place& place : places) {
      sum += member.measured.at(place).value;
      gain += member.measured.at(place).gain;
    }
    const std::size_t row = axes.y.empty() ? 0 : index_of(map.ys, member.values.at(axes.y));
    Map::Cell& cell = map.cells[row * map.xs.size() + index_of(map.xs, member.values.at(axes.x))];
    cell.value = sum / static_cast<double>(places.size());
    cell.may_be_best = gain > 0;
  }
  return map;
}

/// A line for each place that means leave out, the first few of many, with a setting that has no value there.
std::vector<std::string> notes_on_missing(const std::vector<Setting>& settings, const Axes& axes,
                                          const std::set<Place>& places) {
  constexpr std::size_t most = 6;
  std::vector<Place> all;
  for (const Setting& setting : settings)
    for (const auto& [place, measured] : setting.measured) add_once(all, place);
  std::vector<std::string> named{axes.x};
  if (!axes.y.empty()) named.push_back(axes.y);
  named.insert(named.end(), axes.facets.begin(), axes.facets.end());
  const auto name_of = [&named](const Setting& setting) {
    std::vector<std::string> parts;
    for (const std::string& parameter : named) parts.push_back(fmt::format("{}={}", parameter, setting.values.at(parameter)));
    return joined(parts, ",");
  };
  std::vector<std::string> notes;
  std::size_t missing = 0;
  for (const Place& place : all) {
    if (places.contains(place) || ++missing > most) continue;
    std::vector<std::string> without;
    for (const Setting& setting : settings)
      if (!setting.measured.contains(place)) without.push_back(name_of(setting));
    notes.push_back(fmt::format("not among the {}: {} (no value of {}{})", counted(places.size(), "place{s}"),
                                title(place, all), without.front(),
                                without.size() > 1 ? ", and of " + counted(without.size() - 1, "more setting{s}") : ""));
  }
  if (missing > most) notes.push_back("and " + counted(missing - most, "more place{s}"));
  return notes;
}

/// Marks the cells that no other one of these maps is better than.
void mark_best(std::span<Map> maps, std::string_view direction) {
  if (direction.empty()) return;
  std::optional<double> best;
  for (const Map& map : maps)
    for (const Map::Cell& cell : map.cells)
      if (cell.value && cell.may_be_best && (!best || is_better(direction, *cell.value, *best))) best = cell.value;
  for (Map& map : maps)
    for (Map::Cell& cell : map.cells) cell.is_best = cell.may_be_best && cell.value && cell.value == best;
}

void make_technique_maps(const std::string& technique, const std::vector<Setting>& settings,
                         const std::vector<std::string>& declared, const MapOptions& options, std::vector<Map>& maps) {
  const Axes axes = choose_axes(settings, declared, options);
  if (axes.x.empty()) return;
  const std::set<Place> places = common_places(settings, &Setting::measured);
  if (places.empty()) return;
  const std::size_t first_map = maps.size();
  std::vector<std::pair<std::vector<std::string>, std::vector<Setting>>> by_facet;  // in order of appearance
  for (const Setting& setting : settings) {
    std::vector<std::string> key;
    for (const std::string& facet : axes.facets) key.push_back(setting.values.at(facet));
    value_of_key(by_facet, key).push_back(setting);
  }
  for (const auto& [key, members] : by_facet) {
    maps.push_back(make_map(members, axes, places));
    maps.back().technique = technique;
  }
  maps[first_map].notes = notes_on_missing(settings, axes, places);
  mark_best(std::span(maps).subspan(first_map), better(options.metric));
}

/// The rows of one technique as settings, in order of appearance, with the parameters that any of them has.
struct TechniqueRows {
  std::string id;
  std::vector<std::string> parameters = {};
  std::vector<std::string> order = {};           ///< keys of `settings`
  std::map<std::string, Setting> settings = {};  ///< by all values
};

/// Throws Error on a parameter that is named for two axes.
void require_different_axes(const MapOptions& options) {
  const std::pair<std::string_view, const std::string&> axes[] = {
      {"--x", options.x}, {"--y", options.y}, {"--facet", options.facet}};
  for (const auto& [first, parameter] : axes)
    for (const auto& [second, again] : axes)
      if (first != second && !parameter.empty() && parameter == again)
        throw Error("{} and {} are both {}; each needs a parameter of its own", first, second, parameter);
}

/// Enters a row, which has the metric. A scene or light that is an axis is no part of the place that a mean is taken over.
void add_row(const Record& r, const std::string& metric, const std::set<std::string>& axes, TechniqueRows& technique) {
  Values values;
  for (const auto& [parameter, one] : r.parameters.items()) {
    add_once(technique.parameters, parameter);
    values[parameter] = shown_value(one);
  }
  Place place = place_of(r);
  const std::pair<const char*, std::string&> parts_of_place[] = {{"scene", place.scene}, {"light", place.light}};
  for (const auto& [axis, part] : parts_of_place) {
    if (!axes.contains(axis)) continue;
    add_once(technique.parameters, std::string(axis));
    values[axis] = std::exchange(part, "");
  }
  std::string key;
  for (const auto& [parameter, one] : values) key += fmt::format("{}={}\n", parameter, one);
  Setting& setting = technique.settings[key];
  if (setting.measured.empty()) technique.order.push_back(key);
  setting.values = std::move(values);
  setting.measured[place] = {*quantity(r, metric), r.answer == AnswerKind::fraction && !place.light.empty(),
                             gain_over_constant(r, metric).value_or(INFINITY)};
}

}  // namespace

std::string Map::facet_text() const {
  std::vector<std::string> parts;
  for (const auto& [name, value] : facet) parts.push_back(fmt::format("{}={}", name, value));
  return joined(parts, ", ");
}

std::string places_text(const Map& map) {
  const std::size_t with_area = map.places_with_fractions;
  return fmt::format(
      "{}{}", counted(map.places, "place{s}"),
      with_area == 0 || with_area == map.places ? "" : fmt::format(", {} of them under lights with area", with_area));
}

std::vector<Map> make_maps(std::span<const Record> records, const MapOptions& options) {
  require_quantity(records, options.metric);
  require_different_axes(options);
  std::vector<TechniqueRows> techniques;
  const std::set<std::string> axes{options.x, options.y, options.facet};
  for (const Record& r : records) {
    if (r.status != Status::ok || !quantity(r, options.metric)) continue;
    const auto found = std::ranges::find(techniques, r.technique, &TechniqueRows::id);
    TechniqueRows& rows = found == techniques.end() ? techniques.emplace_back(TechniqueRows{.id = r.technique}) : *found;
    add_row(r, options.metric, axes, rows);
  }
  std::vector<std::string> known{"scene", "light"};
  for (const TechniqueRows& technique : techniques)
    for (const std::string& parameter : technique.parameters) add_once(known, parameter);
  for (const std::string& name : {options.x, options.y, options.facet})
    if (!name.empty()) require_word("there is no parameter", name, known);

  std::vector<Map> maps;
  for (TechniqueRows& technique : techniques) {
    std::vector<Setting> all;
    for (const std::string& key : technique.order) all.push_back(std::move(technique.settings[key]));
    // Every setting must have every parameter: records of two versions may differ in them.
    for (const std::string& parameter : technique.parameters)
      for (Setting& setting : all) setting.values.try_emplace(parameter, "-");
    if (all.size() > 1) make_technique_maps(technique.id, all, technique.parameters, options, maps);
  }
  if (maps.empty())
    throw Error("there is nothing to map: no technique has two settings that finished the same scenes{}; {}",
                options.x.empty() ? "" : fmt::format(" and differ in {}", options.x),
                how_to_sweep(options.x.empty() ? "PARAMETER" : options.x));
  return maps;
}

}  // namespace gnomon
