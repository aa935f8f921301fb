#include "measure/record/record.h"

#include <cmath>
#include <limits>

namespace gnomon {

std::string_view name(Status status) {
  static constexpr std::string_view names[] = {"ok", "unsupported", "failed"};
  return names[static_cast<int>(status)];
}

std::string_view name(Role role) {
  static constexpr std::string_view names[] = {"contender", "baseline", "reference"};
  return names[static_cast<int>(role)];
}

namespace {

// --- values to JSON ---------------------------------------------------------------------------------------------------

/// JSON has no NaN and no infinity: null.
Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

template <class T>
Json or_null(const std::optional<T>& value) {
  return value ? Json(*value) : Json(nullptr);
}

// --- JSON to values ---------------------------------------------------------------------------------------------------

[[noreturn]] void refuse(std::string_view field, const Json& value, std::string_view allowed) {
  throw Error("{} = {} is not {}", field, value.dump(-1, ' ', false, Json::error_handler_t::replace), allowed);
}

void read(std::string_view field, const Json& value, std::string& into) {
  if (!value.is_string()) refuse(field, value, "text");
  into = value.get<std::string>();
}
void read(std::string_view field, const Json& value, double& into) {
  if (!value.is_number()) refuse(field, value, "a number");
  into = value.get<double>();
}
void read(std::string_view field, const Json& value, bool& into) {
  if (!value.is_boolean()) refuse(field, value, "true or false");
  into = value.get<bool>();
}
void read(std::string_view field, const Json& value, std::uint64_t& into) {
  const bool is_whole = value.is_number_unsigned() || (value.is_number_integer() && value.get<std::int64_t>() >= 0);
  if (!is_whole) refuse(field, value, "a whole number, 0 or more");
  into = value.get<std::uint64_t>();
}
void read(std::string_view field, const Json& value, int& into) {
  std::uint64_t whole = 0;
  read(field, value, whole);
  if (whole > std::numeric_limits<int>::max()) refuse(field, value, "below 2147483648");
  into = static_cast<int>(whole);
}
void read(std::string_view field, const Json& value, Json& into) {
  if (!value.is_object()) refuse(field, value, "an object");
  into = value;
}

/// One word of a closed set.
template <class Enum>
void read_word(std::string_view field, const Json& value, Enum& into, std::initializer_list<Enum> all) {
  std::string allowed;
  for (const Enum word : all) {
    if (value.is_string() && value.get_ref<const std::string&>() == name(word)) return void(into = word);
    allowed += fmt::format("{}{}", allowed.empty() ? "one of " : ", ", name(word));
  }
  refuse(field, value, allowed);
}
void read(std::string_view field, const Json& value, Status& into) {
  read_word(field, value, into, {Status::ok, Status::unsupported, Status::failed});
}
void read(std::string_view field, const Json& value, Truth& into) {
  read_word(field, value, into, {Truth::shape, Truth::mesh});
}
void read(std::string_view field, const Json& value, Role& into) {
  read_word(field, value, into, {Role::contender, Role::baseline, Role::reference});
}
void read(std::string_view field, const Json& value, Support::Kind& into) {
  using enum Support::Kind;
  read_word(field, value, into, {full, approximate, unsupported});
}

template <class Value, class... Rest>
void read(std::string_view field, const Json& value, std::map<std::string, Value, Rest...>& into);
void read(std::string_view field, const Json& value, Count& into);
void read(std::string_view field, const Json& value, Record::GlInputs& into);
void read(std::string_view field, const Json& value, Record::SceneFacts& into);

template <class T>
void read(std::string_view field, const Json& value, std::optional<T>& into) {
  if (value.is_null()) return void(into = std::nullopt);
  read(field, value, into.emplace());
}
/// Null elements are left out: a time that was not taken.
template <class T>
void read(std::string_view field, const Json& value, std::vector<T>& into) {
  if (!value.is_array()) refuse(field, value, "an array");
  into.clear();
  for (const Json& element : value)
    if (!element.is_null()) read(field, element, into.emplace_back());
}
/// Null elements stay: a value that is not defined at its place.
template <class T>
void read(std::string_view field, const Json& value, std::vector<std::optional<T>>& into) {
  if (!value.is_array()) refuse(field, value, "an array");
  into.clear();
  for (const Json& element : value) read(field, element, into.emplace_back());
}
template <class Value, class... Rest>
void read(std::string_view field, const Json& value, std::map<std::string, Value, Rest...>& into) {
  if (!value.is_object()) refuse(field, value, "an object");
  for (const auto& [key, element] : value.items()) read(fmt::format("{}.{}", field, key), element, into[key]);
}

/// Takes fields out of an object; what is left at the end was not known.
class Fields {
 public:
  Fields(const Json& json, std::string prefix) : json_(json), prefix_(std::move(prefix)) {
    if (!json.is_object()) refuse(prefix_.empty() ? "the record" : prefix_, json, "an object");
  }
  /// Absent or null: `into` keeps its value.
  template <class T>
  void take(const char* key, T& into) {
    const auto found = json_.find(key);
    if (found == json_.end()) return;
    if (!found->is_null()) read(prefix_.empty() ? key : fmt::format("{}.{}", prefix_, key), *found, into);
    json_.erase(found);
  }
  template <class T>
  void require(const char* key, T& into) {
    if (!json_.contains(key) || json_[key].is_null()) throw Error("{} is missing", key);
    take(key, into);
  }
  const Json& rest() const { return json_; }

 private:
  Json json_;
  std::string prefix_;
};

void read(std::string_view field, const Json& value, Count& into) {
  Fields fields(value, std::string(field));
  fields.take("name", into.name);
  std::optional<double> number;
  fields.take("value", number);
  into.value = number.value_or(std::numeric_limits<double>::quiet_NaN());
  fields.take("unit", into.unit);
}
void read(std::string_view field, const Json& value, Record::GlInputs& into) {
  Fields fields(value, std::string(field));
  fields.take("input_bytes", into.input_bytes);
  fields.take("upload_ms", into.upload_ms);
}
void read(std::string_view field, const Json& value, Record::SceneFacts& into) {
  Fields fields(value, std::string(field));
  fields.take("meshes", into.meshes);
  fields.take("triangles", into.triangles);
  fields.take("closed", into.closed);
  fields.take("boundary_edges", into.boundary_edges);
  fields.take("nonmanifold_edges", into.nonmanifold_edges);
  fields.take("misoriented_edges", into.misoriented_edges);
  fields.take("degenerate", into.degenerate);
}

}  // namespace

std::string setting_key(const Record& r) { return r.technique + (r.settings.empty() ? "" : ":" + r.settings); }

std::string setting_name(const Record& r) { return r.label ? *r.label : setting_key(r); }

std::string title(const Record& r) {
  return fmt::format("{} {}{}{} {}", r.scene, r.light, r.path.empty() ? "" : " ", r.path, setting_key(r));
}

std::string context_text(const Record& record, std::string_view key) {
  const auto found = record.context.find(key);
  if (found == record.context.end() || found->is_null()) return "";
  return found->is_string() ? found->get<std::string>() : found->dump();
}

std::optional<double> Record::metric(Truth of, std::string_view name) const {
  const auto against = metrics.find(of);
  if (against == metrics.end()) return std::nullopt;
  const auto found = against->second.find(name);
  return found == against->second.end() ? std::nullopt : found->second;
}

void to_json(Json& json, const Record& r) {
  json = Json::object();
  json["schema"] = record_schema;
  json["job"] = r.job;
  json["suite"] = r.suite;
  json["scene"] = r.scene;
  json["light"] = r.light;
  json["light_kind"] = r.light_kind;
  json["view"] = r.view;
  json["technique"] = r.technique;
  json["settings"] = r.settings;
  json["label"] = or_null(r.label);
  json["role"] = name(r.role);
  json["parameters"] = r.parameters;
  json["width"] = r.width;
  json["height"] = r.height;
  json["truth"] = name(r.truth);
  json["path"] = r.path;
  json["place"] = r.place;
  json["status"] = name(r.status);
  json["support"] = r.support ? Json(name(*r.support)) : Json(nullptr);
  json["reason"] = r.reason;

  Json& stages = json["stages"] = Json::object();
  for (std::size_t stage = 0; stage < r.stages.size(); ++stage) {
    if (r.stages[stage].empty()) continue;
    stages[std::string(stage_names[stage])] = r.stages[stage];
  }
  json["iterations"] = r.iterations;
  json["stop"] = r.stop;
  Json& counts = json["counts"] = Json::array();
  for (const Count& count : r.counts)
    counts.push_back({{"name", count.name}, {"value", number(count.value)}, {"unit", count.unit}});
  json["bytes"] = or_null(r.bytes);
  json["peak_bytes"] = or_null(r.peak_bytes);
  json["gl"] = r.gl ? Json{{"input_bytes", r.gl->input_bytes}, {"upload_ms", number(r.gl->upload_ms)}} : Json(nullptr);

  json["classes"] = r.classes;
  Json& metrics = json["metrics"] = Json::object();
  for (const auto& [truth, values] : r.metrics) {
    Json& against = metrics[std::string(name(truth))] = Json::object();
    for (const auto& [metric, value] : values) against[metric] = value ? number(*value) : Json(nullptr);
  }
  json["causes"] = or_null(r.causes);
  Json& frames = json["frames"] = Json::object();
  for (const auto& [metric, values] : r.frames) {
    Json& series = frames[metric] = Json::array();
    for (const auto& value : values) series.push_back(value ? number(*value) : Json(nullptr));
  }
  json["mask"] = or_null(r.mask);
  json["error_picture"] = or_null(r.error_picture);
  json["shaded_picture"] = or_null(r.shaded_picture);

  json["scene_facts"] = nullptr;
  if (const auto& facts = r.scene_facts)
    json["scene_facts"] = {{"meshes", facts->meshes},
                           {"triangles", facts->triangles},
                           {"closed", facts->closed},
                           {"boundary_edges", facts->boundary_edges},
                           {"nonmanifold_edges", facts->nonmanifold_edges},
                           {"misoriented_edges", facts->misoriented_edges},
                           {"degenerate", facts->degenerate}};
  json["notes"] = r.notes;
  json["context"] = r.context;
  json["seconds"] = or_null(r.seconds);
  for (const auto& [key, value] : r.unknown.items()) json[key] = value;
}

void from_json(const Json& json, Record& record) {
  Record r;
  Fields fields(json, "");
  int schema = 0;
  fields.require("schema", schema);
  if (schema < 1 || schema > record_schema) throw Error("schema = {} is outside 1 .. {}", schema, record_schema);
  fields.take("job", r.job);
  fields.take("suite", r.suite);
  fields.require("scene", r.scene);
  fields.take("light", r.light);
  fields.take("light_kind", r.light_kind);
  fields.take("view", r.view);
  fields.require("technique", r.technique);
  fields.take("settings", r.settings);
  fields.take("label", r.label);
  fields.take("role", r.role);
  fields.take("parameters", r.parameters);
  fields.take("width", r.width);
  fields.take("height", r.height);
  fields.take("truth", r.truth);
  fields.take("path", r.path);
  fields.take("place", r.place);
  fields.require("status", r.status);
  fields.take("support", r.support);
  fields.take("reason", r.reason);

  std::map<std::string, ProcessTimes> stages;
  fields.take("stages", stages);
  for (std::size_t stage = 0; stage < r.stages.size(); ++stage) r.stages[stage] = stages[std::string(stage_names[stage])];
  fields.take("iterations", r.iterations);
  fields.take("stop", r.stop);
  fields.take("counts", r.counts);
  fields.take("bytes", r.bytes);
  fields.take("peak_bytes", r.peak_bytes);
  fields.take("gl", r.gl);
  fields.take("classes", r.classes);
  std::map<std::string, Metrics> metrics;
  fields.take("metrics", metrics);
  for (const Truth truth : {Truth::shape, Truth::mesh})
    if (const auto found = metrics.find(std::string(name(truth))); found != metrics.end()) r.metrics[truth] = found->second;
  fields.take("causes", r.causes);
  fields.take("frames", r.frames);
  fields.take("mask", r.mask);
  fields.take("error_picture", r.error_picture);
  fields.take("shaded_picture", r.shaded_picture);
  fields.take("scene_facts", r.scene_facts);
  fields.take("notes", r.notes);
  fields.take("context", r.context);
  fields.take("seconds", r.seconds);
  r.unknown = fields.rest();
  record = std::move(r);
}

std::string record_line(const Record& record) {
  // Text from outside (paths, an importer's message) may not be UTF-8: what is not becomes U+FFFD.
  return Json(record).dump(-1, ' ', false, Json::error_handler_t::replace) + '\n';
}

}  // namespace gnomon
