#include "measure/submission/numbers.h"

#include <cmath>

#include "measure/images/image_files.h"
#include "measure/paths.h"
#include "measure/scene/toml_table.h"
#include "measure/score/metrics.h"

namespace gnomon {

namespace fs = std::filesystem;

namespace {

constexpr std::string_view all_keys[] = {"status", "support", "reason",  "parameters", "counts", "bytes",       "lights",
                                         "answer", "classes", "metrics", "causes",     "frames", "cause_errors"};
constexpr std::string_view mask_keys[] = {"lights", "classes", "metrics"};
constexpr std::string_view cause_keys[] = {"causes", "cause_errors"};

/// Values by path: of objects and arrays those within, and of arrays how many.
void flatten(const Json& value, const std::string& path, std::map<std::string, Json>& into) {
  if (value.is_object()) {
    for (const auto& [key, part] : value.items()) flatten(part, path.empty() ? key : path + "." + key, into);
  } else if (value.is_array()) {
    for (std::size_t k = 0; k < value.size(); ++k) flatten(value[k], fmt::format("{}[{}]", path, k), into);
    into[path + "[]"] = value.size();
  } else {
    into[path] = value;
  }
}

/// Whether it belongs to these members, of the row or of one of its lights.
bool is_of(std::string_view path, std::span<const std::string_view> keys) {
  const auto begins = [&](std::string_view key) {
    return path.starts_with(key) && (path.size() == key.size() || path[key.size()] == '.' || path[key.size()] == '[');
  };
  if (std::ranges::any_of(keys, begins)) return true;
  const std::size_t dot = path.find('.');
  return path.starts_with("lights[") && dot != path.npos && is_of(path.substr(dot + 1), keys);
}

/// The last name of a path: "error" of "lights[0].metrics.error" and of "frames.error[3]".
std::string_view last_name(std::string_view path) {
  const std::string_view last = path.substr(path.rfind('.') + 1);
  return last.substr(0, last.find('['));
}

/// Whether this program lacks the metric of a path: a newer one made the record.
bool is_of_unknown_metric(std::string_view path) {
  constexpr std::string_view of_metrics[] = {"metrics", "frames"};
  return is_of(path, of_metrics) &&
         std::ranges::find(metric_infos(), last_name(path), &MetricInfo::name) == metric_infos().end();
}

std::map<std::string, Json> numbers_of(const Record& record) {
  const Json all = record;
  std::map<std::string, Json> flat;
  for (const std::string_view key : all_keys) flatten(all[key], std::string(key), flat);
  return flat;
}

std::vector<NumberDifference> differences_of(const Record& a, const Record& b, std::span<const std::string_view> keys) {
  const std::map<std::string, Json> then = numbers_of(a), now = numbers_of(b);
  const bool same_settings = a.settings == b.settings;
  std::vector<NumberDifference> result;
  const auto value = [](const std::map<std::string, Json>& of, const std::string& path) -> std::optional<Json> {
    const auto found = of.find(path);
    if (found != of.end()) return found->second;
    return is_of(path, cause_keys) ? std::optional<Json>(0) : std::nullopt;
  };
  const auto compare = [&](const std::string& path) {
    if (!is_of(path, keys)) return;
    const std::optional<Json> before = value(then, path), after = value(now, path);
    const auto text = [](const std::optional<Json>& of) { return of ? plain_text(*of) : "-"; };
    if (before != after) result.push_back({path, text(before), text(after)});
  };
  for (const auto& [path, before] : then)
    if (now.contains(path) || !is_of_unknown_metric(path)) compare(path);
  for (const auto& [path, after] : now) {
    constexpr std::string_view later[] = {"metrics", "frames"}, parameters[] = {"parameters"};
    const bool is_later = is_of(path, later) || (same_settings && is_of(path, parameters));
    if (!then.contains(path) && !after.is_null() && !is_later) compare(path);
  }
  return result;
}

bool is_untested(std::string_view path) {
  const std::string_view last = last_name(path);
  return last.starts_with("displacement_") || last.starts_with("wrong_rate_edge_") || last == "wrong_rate_all" ||
         last == "ssim" || last == "flip";
}

}  // namespace

std::vector<NumberDifference> number_differences(const Record& then, const Record& now) {
  return differences_of(then, now, all_keys);
}

std::vector<NumberDifference> mask_differences(const Record& then, const Record& now, bool with_causes) {
  std::vector<NumberDifference> result = differences_of(then, now, mask_keys);
  // Of a row of several lights their causes are among `lights`.
  std::erase_if(result, [](const NumberDifference& one) { return is_of(one.path, cause_keys); });
  if (with_causes)
    for (NumberDifference& one : differences_of(then, now, cause_keys)) result.push_back(std::move(one));
  return result;
}

std::vector<NumberDifference> of_tested_pixels(std::vector<NumberDifference> differences) {
  std::erase_if(differences, [](const NumberDifference& one) { return is_untested(one.path); });
  return differences;
}

std::string first_of(std::span<const NumberDifference> differences) {
  constexpr std::size_t most = 3;
  std::vector<std::string> shown;
  for (const NumberDifference& one : differences.first(std::min(most, differences.size()))) shown.push_back(one.text());
  return joined(shown, ", ") + (differences.size() > most ? fmt::format(" and {} more", differences.size() - most) : "");
}

std::size_t pixels_apart(const Record& record, const fs::path& a, const fs::path& b, double threshold) {
  std::size_t most = 0;
  for (const std::string& light : light_names(record)) {
    const std::vector<float> first = read_exr(a, light + ".V", record.width, record.height);
    const std::vector<float> second = read_exr(b, light + ".V", record.width, record.height);
    std::size_t count = 0;
    for (std::size_t i = 0; i < first.size(); ++i) count += !(std::abs(double{first[i]} - double{second[i]}) <= threshold);
    most = std::max(most, count);
  }
  return most;
}

DriverDifferences::DriverDifferences(const fs::path& file) {
  const toml::table toml = read_toml("list of drivers", file);
  const Table table(toml, file, "drivers", {"mask", "validation"});
  for (const toml::table* const one : table.tables("mask")) {
    const Table mask(*one, file, "mask", {"scene", "light", "technique", "settings", "pixels", "reason"});
    constexpr int most = 1 << 28;
    pixels_[{mask.text("scene"), mask.text("light"), mask.text("technique"), mask.text("settings")}] =
        static_cast<std::size_t>(mask.integer("pixels", 0, 0, most));
  }
}

DriverDifferences DriverDifferences::shipped() {
  const fs::path root = data_root();
  for (const char* const name : {"tests/data/drivers.toml", "drivers.toml"})
    if (fs::exists(root / name)) return DriverDifferences(root / name);
  return {};
}

std::size_t DriverDifferences::pixels_of(const Record& record) const {
  const auto found = pixels_.find({record.scene, record.light, record.technique, record.settings});
  return found == pixels_.end() ? 0 : found->second;
}

}  // namespace gnomon
