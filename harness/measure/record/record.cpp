#include "measure/record/record.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace gnomon {

Record::Record() = default;
Record::Record(const Record&) = default;
Record::Record(Record&&) noexcept = default;
Record& Record::operator=(const Record&) = default;
Record& Record::operator=(Record&&) noexcept = default;
Record::~Record() = default;

std::string_view name(Status status) {
  static constexpr std::string_view names[] = {"ok", "unsupported", "failed"};
  return names[static_cast<int>(status)];
}

std::string_view name(Role role) {
  static constexpr std::string_view names[] = {"contender", "baseline", "reference"};
  return names[static_cast<int>(role)];
}

namespace {

template <class T, class Of>
concept MaybeConst = std::is_same_v<std::remove_const_t<T>, Of>;

// Each calls use(key, member) for every field in the order that the file has them, for writing and for reading; of a record,
// for every field but `schema`.
void for_each_field(MaybeConst<Count> auto& count, const auto& use) {
  use("name", count.name);
  use("value", count.value);
  use("unit", count.unit);
}
void for_each_field(MaybeConst<Record::FloorTimes> auto& floor, const auto& use) {
  use("pass", floor.pass);
  use("ms", floor.ms);
  use("device_ms", floor.device_ms);
}
void for_each_field(MaybeConst<Record::GlInputs> auto& gl, const auto& use) {
  use("input_bytes", gl.input_bytes);
  use("upload_ms", gl.upload_ms);
}
void for_each_field(MaybeConst<Record::ReferenceFacts::GlobalFacts> auto& facts, const auto& use) {
  use("samples", facts.samples);
  use("rays", facts.rays);
  use("error", facts.error);
}
void for_each_field(MaybeConst<Record::ReferenceFacts> auto& facts, const auto& use) {
  use("estimates", facts.estimates);
  use("target", facts.target);
  use("cap", facts.cap);
  use("rays", facts.rays);
  use("error_mean", facts.error_mean);
  use("error_max", facts.error_max);
  use("global", facts.global);
}
void for_each_field(MaybeConst<Record::LightFacts> auto& light, const auto& use) {
  use("name", light.name);
  use("kind", light.kind);
  use("support", light.support);
  use("reason", light.reason);
  use("reference", light.reference);
  use("classes", light.classes);
  use("metrics", light.metrics);
  use("causes", light.causes);
  use("cause_errors", light.cause_errors);
}
void for_each_field(MaybeConst<Record::OwnCauseFacts> auto& cause, const auto& use) {
  use("name", cause.name);
  use("sentence", cause.sentence);
  use("color", cause.color);
}
void for_each_field(MaybeConst<Record::SceneFacts> auto& facts, const auto& use) {
  use("meshes", facts.meshes);
  use("triangles", facts.triangles);
  use("closed", facts.closed);
  use("boundary_edges", facts.boundary_edges);
  use("nonmanifold_edges", facts.nonmanifold_edges);
  use("misoriented_edges", facts.misoriented_edges);
  use("degenerate", facts.degenerate);
}
void for_each_field(MaybeConst<Record> auto& r, const auto& use) {
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
  use("device_stages", r.device_stages);
  use("harness_stages", r.harness_stages);
  use("iterations", r.iterations);
  use("stop", r.stop);
  use("counts", r.counts);
  use("bytes", r.bytes);
  use("peak_bytes", r.peak_bytes);
  use("floor", r.floor);
  use("gl", r.gl);
  use("reference", r.reference);
  use("lights", r.lights);
  use("shares_build", r.shares_build);
  use("classes", r.classes);
  use("metrics", r.metrics);
  use("causes", r.causes);
  use("own_causes", r.own_causes);
  use("cause_errors", r.cause_errors);
  use("frames", r.frames);
  use("mask", r.mask);
  use("error_picture", r.error_picture);
  use("shaded_picture", r.shaded_picture);
  use("scene_facts", r.scene_facts);
  use("notes", r.notes);
  use("context", r.context);
  use("seconds", r.seconds);
}

template <class T>
constexpr bool is_vector = false;
template <class T>
constexpr bool is_vector<std::vector<T>> = true;

using Stages = decltype(Record::stages);
using Color = decltype(Record::OwnCauseFacts::color);
/// More would not fit into a picture of causes as numbers of one byte.
constexpr std::size_t most_own_causes = 200;

template <class T>
Json written(const T& value) {
  if constexpr (std::is_enum_v<T>) {
    return name(value);
  } else if constexpr (std::is_same_v<T, double>) {
    return std::isfinite(value) ? Json(value) : Json();  // JSON has no NaN and no infinity: null
  } else if constexpr (requires { value.has_value(); }) {
    return value ? written(*value) : Json();
  } else if constexpr (is_vector<T>) {
    Json array = Json::array();
    for (const auto& item : value) array.push_back(written(item));
    return array;
  } else if constexpr (requires { typename T::mapped_type; }) {
    Json object = Json::object();
    for (const auto& [key, item] : value) object[plain_text(written(key))] = written(item);
    return object;
  } else if constexpr (std::is_same_v<T, Stages>) {
    Json object = Json::object();  // stages that were timed, by name
    for (std::size_t stage = 0; stage < value.size(); ++stage)
      if (!value[stage].empty()) object[std::string(stage_names[stage])] = value[stage];
    return object;
  } else if constexpr (requires { for_each_field(value, 0); }) {
    Json object = Json::object();
    for_each_field(value, [&](const char* key, const auto& member) { object[key] = written(member); });
    return object;
  } else {
    return value;
  }
}

/// Throws Error that names the field and says what it may be.
template <class T>
void read(const std::string& field, const Json& value, T& into) {
  const auto need = [&](bool is_good, std::string_view allowed) {
    if (!is_good) throw Error("{} = {} is not {}", field, json_text(value), allowed);
  };
  if constexpr (std::is_same_v<T, std::string>) {
    need(value.is_string(), "text");
    into = value.get<std::string>();
  } else if constexpr (std::is_same_v<T, double>) {
    need(value.is_number(), "a number");
    into = value.get<double>();
  } else if constexpr (std::is_same_v<T, bool>) {
    need(value.is_boolean(), "true or false");
    into = value.get<bool>();
  } else if constexpr (std::is_integral_v<T>) {
    const bool is_whole = value.is_number_unsigned() || (value.is_number_integer() && value.get<std::int64_t>() >= 0);
    need(is_whole, "a whole number, 0 or more");
    need(std::in_range<T>(value.get<std::uint64_t>()), "below 2147483648");
    into = value.get<T>();
  } else if constexpr (std::is_enum_v<T>) {
    std::vector<std::string> words;
    for (int k = 0; k < (std::is_same_v<T, Truth> || std::is_same_v<T, LightShareKind> ? 2 : 3); ++k) {
      words.emplace_back(name(static_cast<T>(k)));
      if (value == words.back()) return void(into = static_cast<T>(k));
    }
    need(false, "one of " + joined(words));
  } else if constexpr (std::is_same_v<T, Json>) {
    need(value.is_object(), "an object");
    into = value;
  } else if constexpr (requires { into.has_value(); }) {
    into.reset();
    if (!value.is_null()) read(field, value, into.emplace(typename T::value_type{}));
  } else if constexpr (std::is_same_v<T, Color>) {
    const bool is_color = value.is_array() && value.size() == 3 && std::ranges::all_of(value, [](const Json& level) {
                            return level.is_number_unsigned() && level.get<std::uint64_t>() <= 255;
                          });
    need(is_color, "three whole numbers, 0 .. 255");
    into = value.get<Color>();
  } else if constexpr (is_vector<T>) {
    need(value.is_array(), "an array");
    if constexpr (std::is_same_v<typename T::value_type, Record::OwnCauseFacts>)
      need(value.size() <= most_own_causes, fmt::format("an array of at most {}", most_own_causes));
    into.clear();
    // A null is a value that is not defined at its place, where there is such a place; else a time that was not taken.
    for (const Json& item : value)
      if (!item.is_null() || requires(typename T::value_type v) { v.reset(); }) read(field, item, into.emplace_back());
  } else if constexpr (std::is_same_v<T, std::map<Truth, Metrics>>) {
    std::map<std::string, Metrics> by_name;  // other names than the two truths' are passed over
    read(field, value, by_name);
    for (const Truth truth : {Truth::shape, Truth::mesh})
      if (const auto found = by_name.find(std::string(name(truth))); found != by_name.end()) into[truth] = found->second;
  } else if constexpr (std::is_same_v<T, Stages>) {
    std::map<std::string, ProcessTimes> by_name;
    read(field, value, by_name);
    for (std::size_t stage = 0; stage < into.size(); ++stage) into[stage] = by_name[std::string(stage_names[stage])];
  } else {
    need(value.is_object(), "an object");
    if constexpr (requires { typename T::mapped_type; }) {
      for (const auto& [key, item] : value.items()) read(field + "." + key, item, into[key]);
    } else {
      if constexpr (std::is_same_v<T, Count>) into.value = std::numeric_limits<double>::quiet_NaN();
      for_each_field(into, [&](const char* key, auto& member) {
        if (const auto found = value.find(key); found != value.end() && !found->is_null())
          read(fmt::format("{}.{}", field, key), *found, member);
      });
    }
  }
}

}  // namespace

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
  json.update(written(r));
  json.update(r.unknown);
}

void from_json(const Json& json, Record& record) {
  if (!json.is_object()) throw Error("the record = {} is not an object", json_text(json));
  Record r;
  r.unknown = json;
  const auto take = [&](std::string_view key, auto& value) {
    const auto found = r.unknown.find(key);
    if (found == r.unknown.end() || found->is_null()) {
      for (const std::string_view needed : {"schema", "scene", "technique", "status"})
        if (key == needed) throw Error("{} is missing", key);
    } else {
      read(std::string(key), *found, value);
    }
    r.unknown.erase(key);
  };
  int schema = 0;
  take("schema", schema);
  if (schema < 1 || schema > record_schema) throw Error("schema = {} is outside 1 .. {}", schema, record_schema);
  for_each_field(r, take);
  record = std::move(r);
}

void forget_results(Record& r) {
  const auto empty = [](auto&... fields) { ((fields = std::decay_t<decltype(fields)>()), ...); };
  empty(r.stages, r.device_stages, r.harness_stages, r.iterations, r.stop, r.counts, r.bytes, r.peak_bytes, r.floor, r.gl,
        r.reference, r.classes, r.metrics, r.causes, r.cause_errors, r.frames, r.mask, r.error_picture, r.shaded_picture,
        r.shares_build);
  for (Record::LightFacts& light : r.lights)
    empty(light.reference, light.classes, light.metrics, light.causes, light.cause_errors);
}

void withdraw(Record& record, const std::string& reason) {
  forget_results(record);
  record.status = Status::unsupported;
  record.support = Support::Kind::unsupported;
  record.reason = reason;
}

std::vector<std::string> pictures(const Record& record) {
  std::vector<std::string> names;
  for (const auto& name : {record.mask, record.error_picture, record.shaded_picture})
    if (name) names.push_back(*name);
  return names;
}

std::string record_line(const Record& record) {
  // Text from outside (paths, an importer's message) may not be UTF-8: what is not becomes U+FFFD.
  return json_text(Json(record)) + '\n';
}

}  // namespace gnomon
