#include "measure/analysis/analysis_growth.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace gnomon {

namespace {

/// "id:a=1,b=2" with the values of these parameters starred, or without them.
std::string starred(const std::string& scene, const std::set<std::string>& varying) {
  const auto [id, settings] = split_reference(scene);
  std::vector<std::string> parts;
  for (const auto& [key, value] : split_settings(settings))
    if (!varying.contains(key)) parts.push_back(fmt::format("{}={}", key, value));
  for (const std::string& key : varying) parts.push_back(key + "=*");
  return parts.empty() ? id : fmt::format("{}:{}", id, fmt::join(parts, ","));
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
          const bool is_explained =
              std::any_of(differing.begin(), differing.end(), [&](const std::string& key) { return known.contains(key); });
          if (!is_explained) known.insert(differing.begin(), differing.end());
        }
  }
  return growing;
}

/// One series before it is timed: which rows, at which x.
struct Series {
  const Record* first = nullptr;
  Where place;
  std::string setting;
  std::vector<std::pair<double, const Record*>> rows;
};

/// A point's time is the sum of some samples: of one row's stage, or of several rows' stages on the axis `lights`.
struct Points {
  std::vector<Sample> samples;
  std::vector<std::pair<double, std::vector<std::size_t>>> sums;  ///< x and the samples that it sums
};

Growth fit(const Series& series, std::string stage, Points points) {
  Growth growth{.place = series.place, .setting = series.setting, .role = series.first->role, .stage = std::move(stage)};
  std::stable_sort(points.sums.begin(), points.sums.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  const auto sum_of = [](std::span<const double> values, const std::vector<std::size_t>& terms) {
    double sum = 0;
    for (const std::size_t term : terms) sum += values[term];
    return sum;
  };
  std::vector<double> xs;
  std::vector<std::vector<std::size_t>> fitted;
  for (const auto& [x, terms] : points.sums) {
    std::vector<Sample> summed;
    for (const std::size_t term : terms) summed.push_back(points.samples[term]);
    const Measured ms = bootstrap(summed, [](std::span<const double> values) {
      double sum = 0;
      for (const double value : values) sum += value;
      return sum;
    });
    growth.points.push_back({x, ms});
    if (ms.value < clock_ms) {
      ++growth.too_fast;
      continue;
    }
    xs.push_back(x);
    fitted.push_back(terms);
  }
  if (std::set<double>(xs.begin(), xs.end()).size() < least_points) {
    growth.why_not = growth.too_fast > 0 ? "below the clock" : "too few points";
    return growth;
  }
  std::vector<double> ys(xs.size());
  const auto law = [&](std::span<const double> values) {
    for (std::size_t k = 0; k < fitted.size(); ++k) ys[k] = std::max(sum_of(values, fitted[k]), 1e-9);
    return fit_power_law(xs, ys);
  };
  growth.exponent = bootstrap(points.samples, [&](std::span<const double> values) { return law(values).exponent; });
  std::vector<double> values;
  for (const Sample& sample : points.samples) values.push_back(sample.value());
  const PowerLaw best = law(values);
  growth.coefficient = best.coefficient;
  growth.r2 = best.r2;
  return growth;
}

/// The setting without one parameter. A label that names a value of the axis would name one point only.
std::string setting_without(const Record& r, const std::string& parameter) {
  std::vector<std::string> kept;
  bool has_axis = false;
  for (const auto& [key, value] : split_settings(r.settings)) {
    has_axis = has_axis || key == parameter;
    if (key != parameter) kept.push_back(fmt::format("{}={}", key, value));
  }
  if (!has_axis && r.label) return *r.label;
  return kept.empty() ? r.technique : fmt::format("{}:{}", r.technique, fmt::join(kept, ","));
}

void add_stages(const std::vector<Series>& all, Growths& growths) {
  for (const Series& series : all) {
    if (series.rows.size() < 2) {
      ++growths.single;
      continue;
    }
    for (const Stage stage : {Stage::build, Stage::relight, Stage::resolve}) {
      Points points;
      for (const auto& [x, record] : series.rows) {
        Sample sample({record->times(stage)});
        if (!sample.is_timed()) continue;
        points.sums.push_back({x, {points.samples.size()}});
        points.samples.push_back(std::move(sample));
      }
      if (!points.sums.empty()) growths.rows.push_back(fit(series, std::string(name(stage)), std::move(points)));
    }
  }
}

void add_lights(const std::vector<Series>& all, Growths& growths) {
  for (const Series& series : all) {
    if (series.rows.size() < 2) {
      ++growths.single;
      continue;
    }
    for (const char* what : {"relight", "resolve", "total"}) {
      const std::string_view stage = what;
      Points points;
      std::vector<std::size_t> terms;
      if (stage == "total") {
        points.samples.push_back(Sample({series.rows.front().second->times(Stage::build)}));
        terms.push_back(0);
      }
      for (const auto& [x, record] : series.rows) {
        std::vector<ProcessTimes> times;
        if (stage != "resolve") times.push_back(record->times(Stage::relight));
        if (stage != "relight") times.push_back(record->times(Stage::resolve));
        terms.push_back(points.samples.size());
        points.samples.push_back(Sample(std::move(times)));
        points.sums.push_back({x, terms});
      }
      const bool is_timed =
          std::all_of(points.samples.begin(), points.samples.end(), [](const Sample& s) { return s.is_timed(); });
      if (is_timed) growths.rows.push_back(fit(series, std::string(stage), std::move(points)));
    }
  }
}

/// Everything that `--x` can be for these records.
std::vector<std::string> axis_names(std::span<const Record> records) {
  std::set<std::string> names;
  for (const Record& r : records) {
    for (const auto& [parameter, value] : r.parameters.items())
      if (value.is_number()) names.insert(parameter);
    for (const auto& [key, value] : split_settings(split_reference(r.scene).second))
      if (scene_parameter(r.scene, key)) names.insert(key);
  }
  std::vector<std::string> all{"triangles", "pixels", "lights"};
  all.insert(all.end(), names.begin(), names.end());
  return all;
}

}  // namespace

PowerLaw fit_power_law(std::span<const double> x, std::span<const double> y) {
  assert(x.size() == y.size() && x.size() >= 2);
  const auto n = static_cast<double>(x.size());
  double mean_x = 0, mean_y = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    mean_x += std::log(x[i]) / n;
    mean_y += std::log(y[i]) / n;
  }
  double xx = 0, xy = 0, yy = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double dx = std::log(x[i]) - mean_x, dy = std::log(y[i]) - mean_y;
    xx += dx * dx;
    xy += dx * dy;
    yy += dy * dy;
  }
  assert(xx > 0);
  const double exponent = xy / xx;
  // What float noise leaves of a constant is no variance.
  const bool is_constant = yy <= n * 1e-24;
  return {exponent, std::exp(mean_y - exponent * mean_x), is_constant ? 1 : xy * xy / (xx * yy)};
}

std::map<std::string, std::string> scene_families(std::span<const Record> records) {
  const std::map<std::string, std::set<std::string>> growing = growing_parameters(records);
  std::map<std::string, std::string> families;
  for (const Record& r : records) {
    const auto found = growing.find(split_reference(r.scene).first);
    families[r.scene] = found == growing.end() ? r.scene : starred(r.scene, found->second);
  }
  return families;
}

Growths find_growth(std::span<const Record> records, const std::string& axis) {
  const std::vector<std::string> names = axis_names(records);
  if (std::find(names.begin(), names.end(), axis) == names.end())
    throw Error("there is no axis {}; did you mean {}? There are: {}", axis, nearest_word(axis, names), fmt::join(names, ", "));
  const bool is_of_technique =
      std::any_of(records.begin(), records.end(), [&](const Record& r) { return r.parameters.contains(axis); });
  const std::map<std::string, std::string> families = scene_families(records);

  std::vector<Series> all;
  std::map<std::pair<Where, std::string>, std::size_t> places;  // series by what they are equal in
  for (const Record& r : records) {
    if (r.status != Status::ok) continue;
    Where place = where_of(r);
    std::string setting = setting_name(r), key = setting_key(r);
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
      setting = setting_without(r, axis);
      Json rest = r.parameters;
      rest.erase(axis);
      key = r.technique + rest.dump();
    } else {
      x = scene_parameter(r.scene, axis);
      place.scene = starred(r.scene, {axis});
    }
    if (!x || !(*x > 0)) continue;
    const auto [found, is_new] = places.try_emplace({place, key}, all.size());
    if (is_new) all.push_back({&r, place, setting, {}});
    Series& series = all[found->second];
    if (axis == "lights") x = static_cast<double>(series.rows.size() + 1);
    series.rows.emplace_back(*x, &r);
  }

  Growths growths{.axis = axis, .unit = axis == "pixels" ? "px" : "", .rows = {}, .single = 0};
  axis == "lights" ? add_lights(all, growths) : add_stages(all, growths);
  return growths;
}

}  // namespace gnomon
