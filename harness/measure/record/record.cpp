#include "measure/record/record.h"

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

static constexpr int enumerator_count(Status) { return 3; }
static constexpr int enumerator_count(Role) { return 3; }

// Fields in the order of the file, for writing and for reading; of a record, every field but `schema`.
static void for_each_field(MaybeConst<Record::FloorTimes> auto& r, const auto& use) {
  use("pass", r.pass, "ms", r.ms, "device_ms", r.device_ms);
}
static void for_each_field(MaybeConst<Record::ReferenceFacts::GlobalFacts> auto& r, const auto& use) {
  use("samples", r.samples, "rays", r.rays, "error", r.error);
}
static void for_each_field(MaybeConst<Record::ReferenceFacts> auto& r, const auto& use) {
  use("estimates", r.estimates, "target", r.target, "cap", r.cap, "rays", r.rays);
  use("error_mean", r.error_mean, "error_max", r.error_max, "global", r.global);
}
static void for_each_field(MaybeConst<Record::PixelFacts> auto& r, const auto& use) {
  use("rays", r.rays, "kept", r.kept, "tested", r.tested, "error_mean", r.error_mean, "error_max", r.error_max);
}
static void for_each_field(MaybeConst<Record::LightFacts> auto& r, const auto& use) {
  use("name", r.name, "kind", r.kind, "answer", r.answer, "support", r.support, "reason", r.reason);
  use("reference", r.reference, "pixel_truth", r.pixel_truth, "classes", r.classes, "metrics", r.metrics);
  use("causes", r.causes, "cause_errors", r.cause_errors);
}
static void for_each_field(MaybeConst<Record::OwnCauseFacts> auto& r, const auto& use) {
  use("name", r.name, "sentence", r.sentence, "color", r.color);
}
static void for_each_field(MaybeConst<Record::KeptFrames> auto& r, const auto& use) {
  use("numbers", r.numbers, "mask", r.mask, "reference", r.reference);
}
static void for_each_field(MaybeConst<Record::SceneFacts> auto& r, const auto& use) {
  use("meshes", r.meshes, "triangles", r.triangles, "closed", r.closed);
  use("boundary_edges", r.boundary_edges, "nonmanifold_edges", r.nonmanifold_edges);
  use("misoriented_edges", r.misoriented_edges, "degenerate", r.degenerate);
}
static void for_each_field(MaybeConst<Record> auto& r, const auto& use) {
  use("job", r.job, "suite", r.suite, "scene", r.scene, "light", r.light, "light_kind", r.light_kind, "view", r.view);
  use("technique", r.technique, "settings", r.settings, "label", r.label, "role", r.role, "parameters", r.parameters);
  use("width", r.width, "height", r.height, "truth", r.truth, "truth_over", r.truth_over, "path", r.path);
  use("start", r.start, "frame_rate", r.frame_rate, "frame_count", r.frame_count, "place", r.place);
  use("status", r.status, "support", r.support, "reason", r.reason);
  use("stages", r.stages, "moving_stages", r.moving_stages);
  use("device_stages", r.device_stages, "harness_stages", r.harness_stages);
  use("iterations", r.iterations, "stop", r.stop, "counts", r.counts, "bytes", r.bytes, "peak_bytes", r.peak_bytes);
  use("floor", r.floor, "gl", r.gl, "lights", r.lights, "answer", r.answer, "shares_build", r.shares_build);
  use("classes", r.classes, "metrics", r.metrics, "causes", r.causes, "own_causes", r.own_causes);
  use("cause_errors", r.cause_errors, "frames", r.frames, "exposure", r.exposure);
  use("mask", r.mask, "error_picture", r.error_picture, "shaded_picture", r.shaded_picture);
  use("kept_frames", r.kept_frames, "scene_facts", r.scene_facts, "notes", r.notes, "context", r.context, "seconds", r.seconds);
}

std::string context_text(const Record& record, std::string_view key) {
  const auto found = record.context.find(key);
  return found == record.context.end() || found->is_null() ? "" : plain_text(*found);
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
  // The line of a row whose geometry stands still does not have these, nor that of a still the last one; the first is of rows
  // that asked for more than the truth at pixel centers.
  for (const char* key : {"truth_over", "start", "frame_rate", "frame_count", "moving_stages", "kept_frames"})
    if (json[key].empty()) json.erase(key);
  for (Json& light : json["lights"])
    if (light["pixel_truth"].empty()) light.erase("pixel_truth");
  if (std::size(r.lights) == 1)
    for (const char* key : {"classes", "metrics", "causes", "cause_errors"}) json["lights"].front().erase(key);
  json.update(r.unknown);
}

Record record_of(Json json) {
  if (!json.is_object()) throw Error("the record = {} is not an object", json_text(json));
  Record r;
  r.unknown = std::move(json);
  const auto take = [&](std::string_view key, auto& value) {
    const auto found = r.unknown.find(key);
    if (found == r.unknown.end() || found->is_null()) {
      for (const std::string_view needed : {"schema", "scene", "lights", "answer", "technique", "status"})
        if (key == needed) throw Error("{} is missing", key);
    } else {
      read(std::string(key), *found, value);
    }
    r.unknown.erase(key);
  };
  int schema = 0;
  take("schema", schema);
  if (schema < record_schema)
    throw Error(
        "schema = {} is that of an older program, this one reads {}: run the rows again, or, of schema 2 to 6, convert "
        "the folder with scripts/convert_records",
        schema, record_schema);
  if (schema > record_schema) throw Error("schema = {} is that of a newer program, this one reads {}", schema, record_schema);
  for_each_field(r, UseFields{take});
  // More would not fit into a picture of causes as numbers of one byte.
  constexpr std::size_t most_own_causes = 200;
  if (r.own_causes.size() > most_own_causes) throw Error("own_causes is not an array of at most {}", most_own_causes);
  if (std::empty(r.lights)) throw Error("lights = [] is not an array of one light or more");
  for (const Record::LightFacts& light : r.lights)
    if (light.answer == AnswerKind::received)
      throw Error("lights.answer = received is not one of binary, fraction, transmitted");
  const AnswerKind wanted = row_answer(r);
  if (r.answer != wanted) throw Error("answer = {} is not {}, that of its lights", name(r.answer), name(wanted));
  if (Record::LightFacts& first = r.lights.front(); std::size(r.lights) == 1) {
    first.classes = r.classes;
    if (const auto headline = r.metrics.find(r.truth); headline != r.metrics.end()) first.metrics = headline->second;
    first.causes = r.causes;
    first.cause_errors = r.cause_errors;
  }
  return r;
}

void from_json(const Json& json, Record& record) { record = record_of(json); }

void forget_results(Record& r) {
  const auto empty = [](auto&... fields) { ((fields = std::decay_t<decltype(fields)>()), ...); };
  empty(r.stages, r.moving_stages, r.device_stages, r.harness_stages, r.iterations, r.stop, r.counts, r.bytes, r.peak_bytes,
        r.floor, r.gl, r.classes, r.metrics, r.causes, r.cause_errors, r.frames, r.exposure, r.mask, r.error_picture,
        r.shaded_picture, r.kept_frames, r.shares_build);
  for (Record::LightFacts& light : r.lights)
    empty(light.reference, light.pixel_truth, light.classes, light.metrics, light.causes, light.cause_errors);
}

std::vector<std::string> pictures(const Record& record) {
  std::vector<std::string> names;
  for (const auto& name : {record.mask, record.error_picture, record.shaded_picture})
    if (name) names.push_back(*name);
  if (record.kept_frames)
    for (const int frame : record.kept_frames->numbers) names.push_back(frame_picture(record.kept_frames->mask, frame));
  return names;
}

std::vector<std::string> shared_pictures(const Record& record) {
  std::vector<std::string> names;
  if (record.kept_frames && !record.kept_frames->reference.empty())
    for (const int frame : record.kept_frames->numbers) names.push_back(frame_picture(record.kept_frames->reference, frame));
  return names;
}

std::string frame_picture(const std::string& folder, int frame) { return fmt::format("{}/{:04}.png", folder, frame); }

std::string record_line(const Record& record) {
  // Text from outside (paths, an importer's message) may not be UTF-8: what is not becomes U+FFFD.
  return json_text(Json(record)) + '\n';
}

}  // namespace gnomon
