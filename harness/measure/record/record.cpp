#include "measure/record/record.h"

#include <cmath>
#include <cstdlib>
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

template <class T>
Json written(const T& value) {
  return value;
}
/// JSON has no NaN and no infinity: null.
Json written(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }
Json written(Status value) { return name(value); }
Json written(Role value) { return name(value); }
Json written(Truth value) { return name(value); }
Json written(Support::Kind value) { return name(value); }
Json written(const Count& count) { return {{"name", count.name}, {"value", written(count.value)}, {"unit", count.unit}}; }
Json written(const Record::GlInputs& gl) { return {{"input_bytes", gl.input_bytes}, {"upload_ms", written(gl.upload_ms)}}; }
Json written(const Record::SceneFacts& facts) {
  return {{"meshes", facts.meshes},
          {"triangles", facts.triangles},
          {"closed", facts.closed},
          {"boundary_edges", facts.boundary_edges},
          {"nonmanifold_edges", facts.nonmanifold_edges},
          {"misoriented_edges", facts.misoriented_edges},
          {"degenerate", facts.degenerate}};
}
template <class T>
Json written(const std::optional<T>& value) {
  return value ? written(*value) : Json(nullptr);
}
template <class T>
Json written(const std::vector<std::optional<T>>& values) {
  Json array = Json::array();
  for (const std::optional<T>& value : values) array.push_back(written(value));
  return array;
}
Json written(const Counts& counts) {
  Json array = Json::array();
  for (const Count& count : counts) array.push_back(written(count));
  return array;
}
std::string key_of(const std::string& key) { return key; }
std::string key_of(Truth truth) { return std::string(name(truth)); }
template <class Key, class Value, class... Rest>
Json written(const std::map<Key, Value, Rest...>& map) {
  Json object = Json::object();
  for (const auto& [key, value] : map) object[key_of(key)] = written(value);
  return object;
}
/// Stages that were timed, by name.
Json written(const decltype(Record::stages)& stages) {
  Json object = Json::object();
  for (std::size_t stage = 0; stage < stages.size(); ++stage)
    if (!stages[stage].empty()) object[std::string(stage_names[stage])] = stages[stage];
  return object;
}

// --- JSON to values ---------------------------------------------------------------------------------------------------

[[noreturn]] void refuse(std::string_view field, const Json& value, std::string_view allowed) {
  throw Error("{} = {} is not {}", field, json_text(value), allowed);
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

/// Other names than the two truths' are passed over.
void read(std::string_view field, const Json& value, std::map<Truth, Metrics>& into) {
  std::map<std::string, Metrics> by_name;
  read(field, value, by_name);
  for (const Truth truth : {Truth::shape, Truth::mesh})
    if (const auto found = by_name.find(std::string(name(truth))); found != by_name.end()) into[truth] = found->second;
}
void read(std::string_view field, const Json& value, decltype(Record::stages)& into) {
  std::map<std::string, ProcessTimes> by_name;
  read(field, value, by_name);
  for (std::size_t stage = 0; stage < into.size(); ++stage) into[stage] = by_name[std::string(stage_names[stage])];
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

/// Calls use(key, member) for every field but `schema` in the order that the file has them, for writing and for reading.
template <class AnyRecord, class Use>
void for_each_field(AnyRecord& r, const Use& use) {
  use("job", r.job);
  use("suite", r.suite);
  use("scene", r.scene);
  use("light", r.light);
  use("light_kind", r.light_kind);
  use("view", r.view);
  use("technique", r.technique);
  use("settings", r.settings);
  use("label", r.label);
  use("role", r.role);
  use("parameters", r.parameters);
  use("width", r.width);
  use("height", r.height);
  use("truth", r.truth);
  use("path", r.path);
  use("place", r.place);
  use("status", r.status);
  use("support", r.support);
  use("reason", r.reason);
  use("stages", r.stages);
  use("iterations", r.iterations);
  use("stop", r.stop);
  use("counts", r.counts);
  use("bytes", r.bytes);
  use("peak_bytes", r.peak_bytes);
  use("gl", r.gl);
  use("classes", r.classes);
  use("metrics", r.metrics);
  use("causes", r.causes);
  use("frames", r.frames);
  use("mask", r.mask);
  use("error_picture", r.error_picture);
  use("shaded_picture", r.shaded_picture);
  use("scene_facts", r.scene_facts);
  use("notes", r.notes);
  use("context", r.context);
  use("seconds", r.seconds);
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
  return plain_text(*found);
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
  for_each_field(r, [&](const char* key, const auto& value) { json[key] = written(value); });
  for (const auto& [key, value] : r.unknown.items()) json[key] = value;
}

void from_json(const Json& json, Record& record) {
  Record r;
  Fields fields(json, "");
  int schema = 0;
  fields.require("schema", schema);
  if (schema < 1 || schema > record_schema) throw Error("schema = {} is outside 1 .. {}", schema, record_schema);
  for_each_field(r, [&](std::string_view key, auto& value) {
    if (key == "scene" || key == "technique" || key == "status")
      fields.require(key.data(), value);
    else
      fields.take(key.data(), value);
  });
  r.unknown = fields.rest();
  record = std::move(r);
}

void forget_results(Record& r) {
  const auto empty = [](auto&... fields) { ((fields = std::decay_t<decltype(fields)>()), ...); };
  empty(r.stages, r.iterations, r.stop, r.counts, r.bytes, r.peak_bytes, r.gl, r.classes, r.metrics, r.causes, r.frames, r.mask,
        r.error_picture, r.shaded_picture);
}

void withdraw(Record& record, const std::string& reason) {
  forget_results(record);
  record.status = Status::unsupported;
  record.support = Support::Kind::unsupported;
  record.reason = reason;
}

void withdraw_false_reference(Record& record) {
  constexpr int last_hard_frames = 5;
  const bool has_area = record.light_kind == "rect" || record.light_kind == "disc" || record.light_kind == "sphere";
  if (record.status != Status::ok || !has_area || std::atoi(context_text(record, "frames").c_str()) > last_hard_frames) return;
  withdraw(record, "it was scored against the hard shadow of the light's center, and the light has an area");
}

std::string record_line(const Record& record) {
  // Text from outside (paths, an importer's message) may not be UTF-8: what is not becomes U+FFFD.
  return json_text(Json(record)) + '\n';
}

}  // namespace gnomon
