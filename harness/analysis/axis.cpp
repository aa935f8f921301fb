#include "analysis/axis.h"

#include <gnomon/registry.h>

#include <algorithm>

#include "measure/scene/time_reference.h"

namespace gnomon {

namespace {

/// "id:a=1,b=2" of these settings but the ones in `varying`, which are left out or starred: "id:a=1,b=*".
std::string fixed(const std::string& id, const std::string& settings, const std::set<std::string>& varying, bool with_stars) {
  std::vector<std::string> parts;
  for (const auto& [key, value] : split_settings(settings))
    if (!varying.contains(key)) parts.push_back(fmt::format("{}={}", key, value));
  if (with_stars)
    for (const std::string& key : varying) parts.push_back(key + "=*");
  return parts.empty() ? id : fmt::format("{}:{}", id, joined(parts, ","));
}

/// A still keeps its time.
std::string starred(const std::string& scene, const std::set<std::string>& varying) {
  const auto [id, settings] = split_reference(scene);
  return fixed(id, settings, varying, true) + scene.substr(without_time(scene).size());
}

/// By scene id, the numeric parameters that change how many triangles the scene has: what one family of scenes differs in.
std::map<std::string, std::set<std::string>> growing_parameters(std::span<const Record> records) {
  using Settings = std::map<std::string, std::string>;
  std::map<std::string, std::map<Settings, std::uint64_t>> families;  // by id, triangles by settings
  for (const Record& r : records) {
    if (!r.scene_facts) continue;
    const auto [id, text] = split_reference(r.scene);
    const auto pairs = split_settings(text);
    families[id][Settings(pairs.begin(), pairs.end())] = r.scene_facts->triangles;
  }
  std::map<std::string, std::set<std::string>> growing;
  for (const auto& [id, members] : families) {
    // Scenes that differ in one parameter show what it does; where all differ in several, all of these count.
    for (const bool is_single : {true, false})
      for (const auto& [a, triangles_a] : members)
        for (const auto& [b, triangles_b] : members) {
          std::set<std::string> differing;
          for (const auto* one : {&a, &b})
            for (const auto& [key, value] : *one) {
              const auto in_a = a.find(key), in_b = b.find(key);
              const bool is_same = in_a != a.end() && in_b != b.end() && in_a->second == in_b->second;
              if (!is_same && scene_parameter(id + ":" + key + "=" + value, key)) differing.insert(key);
            }
          if (triangles_a == triangles_b || differing.empty() || (is_single && differing.size() > 1)) continue;
          std::set<std::string>& known = growing[id];
          const bool is_explained = std::ranges::any_of(differing, [&](const std::string& key) { return known.contains(key); });
          if (!is_explained) known.insert(differing.begin(), differing.end());
        }
  }
  return growing;
}

/// What a series along a parameter of techniques is called: by the label that all of its rows have, else by its settings. A
/// label that some rows have names a value of the axis.
std::string series_name(const AxisSeries& series, const std::string& parameter) {
  const Record& first = *series.rows.front().second;
  const bool share_label =
      first.label && std::ranges::all_of(series.rows, [&](const auto& row) { return row.second->label == first.label; });
  return share_label && series.rows.size() > 1 ? *first.label : fixed(first.technique, first.settings, {parameter}, false);
}

/// Whether the axis is a parameter of techniques. One of scenes may have the same name: what the rows of one technique do not
/// differ in is theirs only where scenes have none.
bool is_of_techniques(std::span<const Record> records, const std::string& axis) {
  std::map<std::string, std::set<std::string>> values;  // by technique
  bool is_of_scenes = false;
  for (const Record& r : records) {
    if (const auto found = r.parameters.find(axis); found != r.parameters.end()) values[r.technique].insert(json_text(*found));
    is_of_scenes = is_of_scenes || scene_parameter(r.scene, axis).has_value();
  }
  return std::ranges::any_of(values, [&](const auto& one) { return one.second.size() > 1 || !is_of_scenes; });
}

const Parameter* row_named(const Parametrized& owner, std::string_view parameter) {
  for (const Parameter* one : owner.parameters())
    if (one->name() == parameter) return one;
  return nullptr;
}

bool is_log(const Parameter& parameter) {
  if (const auto* whole = dynamic_cast<const Number<int>*>(&typed(parameter))) return whole->range().log;
  const auto* number = dynamic_cast<const Number<double>*>(&typed(parameter));
  return number && number->range().log;
}

/// Whether `accepts` takes the parameter of a registered technique of these records; where only scenes have it, of a scene.
bool is_declared(std::span<const Record> records, const std::string& parameter,
                 const std::function<bool(const Parameter&)>& accepts) {
  std::set<std::string> ids;
  const bool is_of_technique = is_of_techniques(records, parameter);
  for (const Record& r : records) ids.insert(is_of_technique ? r.technique : split_reference(r.scene).first);
  const auto is_among = [&](const auto& entries) {
    return std::ranges::any_of(entries, [&](const auto& entry) {
      if (!ids.contains(entry.id)) return false;
      const auto owner = entry.make();
      const Parameter* row = row_named(*owner, parameter);
      return row && accepts(*row);
    });
  };
  return is_of_technique ? is_among(registry().techniques()) : is_among(registry().scenes());
}

}  // namespace

std::map<std::string, std::string> scene_families(std::span<const Record> records) {
  const std::map<std::string, std::set<std::string>> growing = growing_parameters(records);
  std::map<std::string, std::string> families;
  for (const Record& r : records) {
    const auto found = growing.find(split_reference(r.scene).first);
    families[r.scene] = found == growing.end() ? r.scene : starred(r.scene, found->second);
  }
  return families;
}

std::vector<std::string> numeric_parameters(std::span<const Record> records) {
  std::set<std::string> names;
  for (const Record& r : records) {
    for (const auto& [parameter, value] : r.parameters.items())
      if (value.is_number()) names.insert(parameter);
    for (const auto& [key, value] : split_settings(split_reference(r.scene).second))
      if (scene_parameter(r.scene, key)) names.insert(key);
  }
  return {names.begin(), names.end()};
}

std::string parameter_unit(std::span<const Record> records, const std::string& parameter) {
  std::string unit;
  is_declared(records, parameter, [&](const Parameter& row) {
    unit = row.unit();
    return !unit.empty();
  });
  return unit;
}

bool is_log_parameter(std::span<const Record> records, const std::string& parameter) {
  return is_declared(records, parameter, is_log);
}

std::vector<AxisSeries> join_series(std::span<const Record> records, const std::string& axis,
                                    const std::function<bool(const Record&)>& takes) {
  const bool is_of_technique = is_of_techniques(records, axis);
  const std::map<std::string, std::string> families = scene_families(records);

  // Rows of several lights together contain their cost; without any, lights are taken one by one.
  const bool has_together =
      axis == "lights" && std::ranges::find(records, AnswerKind::received, &Record::answer) != records.end();
  std::vector<AxisSeries> all;
  std::map<std::pair<Place, std::string>, std::size_t> places;  // series by what they are equal in
  for (const Record& r : records) {
    if (!takes(r)) continue;
    Place place = place_of(r);
    std::string key = setting_key(r);
    std::optional<double> x;
    if (axis == "triangles") {
      if (r.scene_facts) x = static_cast<double>(r.scene_facts->triangles);
      place.scene = families.at(r.scene);
    } else if (axis == "pixels") {
      x = static_cast<double>(r.width) * r.height;
      place.width = place.height = 0;
    } else if (axis == "lights") {
      place.light.clear();
      x = 1;
    } else if (is_of_technique) {
      const auto found = r.parameters.find(axis);
      if (found != r.parameters.end() && found->is_number()) x = found->get<double>();
      Json rest = r.parameters;
      rest.erase(axis);
      key = r.technique + json_text(rest);
    } else {
      x = scene_parameter(r.scene, axis);
      place.scene = starred(r.scene, {axis});
    }
    if (!x) continue;
    const auto [found, is_new] = places.try_emplace({place, key}, all.size());
    if (is_new) all.push_back({.place = place, .setting = setting_name(r), .role = r.role, .rows = {}});
    AxisSeries& series = all[found->second];
    if (axis == "lights") x = static_cast<double>(has_together ? light_count(r) : series.rows.size() + 1);
    if (has_together && std::ranges::find(series.rows, *x, &std::pair<double, const Record*>::first) != series.rows.end())
      continue;
    series.rows.emplace_back(*x, &r);
  }
  if (is_of_technique)
    for (AxisSeries& series : all) series.setting = series_name(series, axis);
  return all;
}

}  // namespace gnomon
