#include "measure/run/row.h"

#include <gnomon/registry.h>

#include <algorithm>
#include <fstream>

#include "measure/cause/causes.h"
#include "measure/picture/picture.h"
#include "measure/scene/motion.h"
#include "measure/score/error_picture.h"

namespace gnomon {

namespace fs = std::filesystem;

namespace {

template <class Item>
std::size_t index_of(const std::vector<Item>& items, const std::string& name) {
  const auto found = std::find_if(items.begin(), items.end(), [&](const Item& item) { return item.name == name; });
  if (found == items.end()) throw Error("there is no {}", name);
  return static_cast<std::size_t>(found - items.begin());
}

/// Letters, digits, dots and dashes of the job's title, and its hash: readable and unique.
std::string file_stem(const Record& record) {
  std::string stem;
  for (const char c : fmt::format("{}-{}-{}", fs::path(record.scene).stem().string(), record.light, record.technique))
    stem += std::isalnum(static_cast<unsigned char>(c)) || c == '.' || c == '-' || c == '_' ? c : '-';
  return stem + "-" + record.job.substr(0, 8);
}

Record::SceneFacts facts_of(const Scene& scene) {
  Record::SceneFacts facts;
  facts.meshes = scene.meshes.size();
  facts.triangles = scene.triangle_count();
  facts.closed = true;
  for (const Mesh& mesh : scene.meshes) {
    facts.closed = facts.closed && mesh.facts.closed();
    facts.boundary_edges += mesh.facts.boundary_edge_count;
    facts.nonmanifold_edges += mesh.facts.nonmanifold_edge_count;
    facts.misoriented_edges += mesh.facts.misoriented_edge_count;
    facts.degenerate += mesh.facts.degenerate_count;
  }
  return facts;
}

}  // namespace

std::size_t SceneRun::light_index(const std::string& name) const { return index_of(scene.lights, name); }
std::size_t SceneRun::view_index(const std::string& name) const { return index_of(scene.views, name); }

Standpoint SceneRun::place(const Job& job) const {
  Standpoint place{light_index(job.light), view_index(job.view), job.width, job.height, std::nullopt, 0};
  if (!job.path.empty()) place.path = find_path(scene, job.path, scene.lights[place.light], scene.views[place.view]);
  return place;
}

Light SceneRun::light(const Standpoint& place) const {
  const Light& still = scene.lights[place.light];
  return place.path ? light_at(*place.path, still, place.frame) : still;
}

FrameKey SceneRun::key(const Standpoint& place, Truth truth) const {
  const View& still = scene.views[place.view];
  return {place.path ? view_at(*place.path, still, place.frame) : still, place.width, place.height,
          scene.has_curved_shapes() ? truth : Truth::shape};
}

Seat::Seat(SceneRun& run, const Contender& contender, const WorkerOptions& options)
    : run_(run), contender_(contender), worker_(options) {}

void Seat::open_begin() {
  worker_.send({{"do", "open"},
                {"scene", run_.frames.scene_file().string()},
                {"technique", contender_.technique},
                {"settings", contender_.settings}});
}

void Seat::open_end() {
  // Starting a process, loading the scene and finding a device is the harness's own work: a short timeout is not meant for it.
  gl_ = worker_.receive(std::max(run_.suite.timeout, 60.0))["gl"];
}

Support Seat::go(const Standpoint& place, Truth truth) {
  place_ = place;
  truth_ = truth;
  const FrameKey key = run_.key(place, truth);
  frame_reply_ = worker_.ask({{"do", "frame"},
                              {"gbuffer", run_.frames.gbuffer_file(key).string()},
                              {"view", place.view},
                              {"width", key.width},
                              {"height", key.height},
                              {"truth", name(key.truth)},
                              {"light", place.light},
                              {"path", place.path ? place.path->name : ""},
                              {"frame", place.frame}},
                             run_.suite.timeout);
  const std::string kind = frame_reply_["support"], why = frame_reply_["why"];
  if (kind == "unsupported") return Support::unsupported(why);
  return kind == "approximate" ? Support::approximate(why) : Support::full();
}

double Seat::setup_ms() {
  if (!setup_ms_) setup_ms_ = worker_.ask({{"do", "setup"}}, run_.suite.timeout)["ms"].get<double>();
  return *setup_ms_;
}

double Seat::time(Stage stage) { return worker_.ask({{"do", "time"}, {"stage", name(stage)}}, run_.suite.timeout)["ms"]; }

Answer Seat::answer(Record* record) {
  // One request for each stage, so that a failure names the stage that it happened in.
  for (const Stage stage : {Stage::setup, Stage::build, Stage::relight, Stage::resolve})
    worker_.ask({{"do", "bring_up"}, {"stage", name(stage)}}, run_.suite.timeout);
  const fs::path mask_file = run_.scratch / "mask.raw";
  const Json reply = worker_.ask({{"do", "answer"}, {"mask", mask_file.string()}}, run_.suite.timeout);
  FrameStore& frames = run_.frames;
  const FrameKey key = run_.key(place_, truth_);
  Answer answer{frames.gbuffer(key), frames.reference(key, run_.light(place_)), {}, {}};
  answer.mask = read_mask_file(mask_file, answer.gbuffer.size());
  if (record) {
    record->counts.clear();
    for (const Json& c : reply["counts"]) record->counts.push_back({c["name"], c["value"], c["unit"]});
    for (const Count& c : record->counts)
      if (c.name == "bytes") record->bytes = static_cast<std::uint64_t>(c.value);
    record->peak_bytes = static_cast<std::uint64_t>(reply["peak_bytes"].get<double>());
  }
  return answer;
}

std::vector<std::optional<Explanation>> Seat::explain(std::span<const std::uint32_t> pixels) {
  // In portions: a filter has hundreds of taps a pixel.
  constexpr std::size_t portion = 4096;
  const fs::path asked = run_.scratch / "pixels.raw", answered = run_.scratch / "explanations.raw";
  std::vector<std::optional<Explanation>> result;
  for (std::size_t first = 0; first < pixels.size(); first += portion) {
    const auto some = pixels.subspan(first, std::min(portion, pixels.size() - first));
    write_file(asked, std::as_bytes(some));
    const Json reply =
        worker_.ask({{"do", "explain"}, {"pixels", asked.string()}, {"out", answered.string()}}, run_.suite.timeout);
    if (!reply["explained"].get<bool>()) {
      result.resize(pixels.size());
      return result;
    }
    for (auto& explanation : explanations_from_bytes(MappedFile::open(answered)->bytes()))
      result.push_back(std::move(explanation));
  }
  return result;
}

Record start_record(const Job& job, const Suite& suite, const Scene* scene, const Json& context) {
  Record record;
  record.job = job.hash;
  record.suite = suite.name;
  record.scene = job.scene;
  record.light = job.light;
  record.view = job.view;
  record.technique = job.contender.technique;
  record.settings = job.contender.settings;
  if (!job.contender.label.empty()) record.label = job.contender.label;
  const TechniqueEntry& entry = registry().technique(job.contender.technique);
  record.role = entry.about.role;
  const auto technique = entry.make();
  technique->apply(job.contender.settings);
  for (const Parameter* row : technique->parameters()) {
    const Json number = Json::parse(row->text(), nullptr, false);
    record.parameters[std::string(row->name())] = number.is_number() ? number : Json(row->text());
  }
  record.width = job.width;
  record.height = job.height;
  record.path = job.path;
  record.place = job.place;
  record.truth = suite.truth;
  record.context = context;
  if (scene) {
    for (const Light& light : scene->lights)
      if (light.name == job.light) record.light_kind = kind_name(light);
    record.scene_facts = facts_of(*scene);
    record.notes = scene->notes;
  }
  return record;
}

namespace {

/// Means of metrics over the frames of a path. A mean over some of the frames would be another quantity in every row, so there
/// is none unless all frames have a value.
class FrameMeans {
 public:
  void add(const Metrics& metrics) {
    ++frames_;
    for (const auto& [metric, value] : metrics) {
      auto& [sum, count] = sums_[metric];
      if (value) sum += *value, ++count;
    }
  }
  Metrics means() const {
    Metrics result;
    for (const auto& [metric, total] : sums_) {
      const auto& [sum, count] = total;
      const int due = metric == between_frames && frames_ > 1 ? frames_ - 1 : frames_;
      result[metric] = count == due ? std::optional(sum / count) : std::nullopt;
    }
    return result;
  }

 private:
  static constexpr std::string_view between_frames = "instability";  ///< has no value at the first frame
  int frames_ = 0;
  std::map<std::string, std::pair<double, int>> sums_;
};

/// Adds what the technique says of a frame to the record's support; answers whether it takes the frame.
bool take_support(Record& record, const Support& support, const Standpoint& place) {
  if (support.kind() == Support::Kind::full) return true;
  if (support && record.support == Support::Kind::approximate) return true;  // by an earlier frame, which said why
  record.support = support.kind();
  record.reason = place.path ? fmt::format("at frame {}: {}", place.frame, support.why()) : support.why();
  return static_cast<bool>(support);
}

/// Pixels where the answer is not wrong.
std::vector<std::uint8_t> right_pixels(const Evidence& evidence) {
  std::vector<std::uint8_t> right(evidence.mask.size());
  for (std::size_t i = 0; i < right.size(); ++i) right[i] = !evidence.is_wrong(i);
  return right;
}

}  // namespace

std::optional<MeasuredRow> measure(Record& record, SceneRun& run, Seat& seat, const Standpoint& first) {
  if (!seat.gl().is_null()) {
    record.context["gl_renderer"] = seat.gl()["renderer"];
    record.context["gl_version"] = seat.gl()["version"];
    const Json& reply = seat.frame_reply();
    if (reply.contains("input_bytes")) record.gl = {reply["input_bytes"], reply["upload_ms"]};
  }
  const Truth truth = record.truth, other = truth == Truth::shape ? Truth::mesh : Truth::shape;
  const bool has_two_truths = run.scene.has_curved_shapes();
  const bool sees_mesh = registry().technique(record.technique).about.sees == Truth::mesh;
  std::map<Truth, FrameMeans> means;
  record.classes.clear();
  record.causes.emplace();
  record.frames.clear();
  MeasuredRow now, before;
  for (Standpoint place = first; place.frame < first.frame_count(); ++place.frame) {
    before = std::move(now);
    now = MeasuredRow{.light = run.light(place), .answer = {}, .errors = {}, .other_mask = {}};
    std::vector<std::uint8_t> right_on_mesh;
    if (has_two_truths) {
      if (!take_support(record, seat.go(place, other), place)) return std::nullopt;
      Answer answer = seat.answer(nullptr);
      const Evidence evidence = answer.evidence(run.scene, now.light);
      means[other].add(measure_metrics(Scoring(evidence)));
      if (other == Truth::mesh && sees_mesh) right_on_mesh = right_pixels(evidence);
      now.other_mask = std::move(answer.mask);
    }
    if (!take_support(record, seat.go(place, truth), place)) return std::nullopt;
    now.answer = seat.answer(&record);
    now.answer.causes =
        find_causes({run.scene, run.frames.casters(truth), now.answer.gbuffer, now.light, now.answer.reference, now.answer.mask,
                     right_on_mesh, [&](std::span<const std::uint32_t> pixels) { return seat.explain(pixels); }});
    Evidence evidence = now.answer.evidence(run.scene, now.light), previous;
    if (place.frame > 0) {
      previous = before.answer.evidence(run.scene, before.light);
      evidence.previous = &previous;
    }
    const Scoring scoring(evidence);
    now.errors = scoring.error_counts();
    const Metrics metrics = measure_metrics(scoring);
    means[truth].add(metrics);
    for (const auto& [name, count] : class_counts(now.answer.reference.classes)) record.classes[name] += count;
    for (const auto& [name, count] : count_causes(now.answer.causes)) (*record.causes)[name] += count;
    if (first.path)
      for (const auto& [metric, value] : metrics) record.frames[metric].push_back(value);
  }
  if (first.path) seat.go(first, truth);
  record.metrics[truth] = means[truth].means();
  record.metrics[other] = has_two_truths ? means[other].means() : record.metrics[truth];
  record.status = Status::ok;
  return now;
}

void forget_results(Record& record) {
  record.stages = {};
  record.iterations.clear();
  record.stop.clear();
  record.counts.clear();
  record.bytes.reset();
  record.peak_bytes.reset();
  record.gl.reset();
  record.classes.clear();
  record.metrics.clear();
  record.causes.reset();
  record.frames.clear();
  record.mask.reset();
  record.error_picture.reset();
  record.shaded_picture.reset();
}

void remove_pictures(const Record& record, const fs::path& out) {
  std::error_code ignored;
  for (const auto& picture : {record.mask, record.error_picture, record.shaded_picture})
    if (picture) fs::remove(out / *picture, ignored);
}

void write_pictures(Record& record, const SceneRun& run, const MeasuredRow& measured, const fs::path& out) {
  const Answer& answer = measured.answer;
  const std::string stem = file_stem(record);
  // What `--rescore` and the report need: the mask, the cause of each pixel, and the mask under the other truth.
  std::vector<std::string> names = {record.light + ".V", record.light + ".cause"};
  std::vector<float> causes;
  for (const Cause cause : answer.causes) causes.push_back(static_cast<float>(cause));
  std::vector<std::span<const float>> channels = {answer.mask, causes};
  if (measured.other_mask) {
    names.push_back(fmt::format("{}.{}", record.light, name(record.truth == Truth::shape ? Truth::mesh : Truth::shape)));
    channels.push_back(*measured.other_mask);
  }
  record.mask = "masks/" + stem + ".exr";
  record.error_picture = "errors/" + stem + ".png";
  record.shaded_picture = "shaded/" + stem + ".png";
  write_exr(out / *record.mask, record.width, record.height, names, channels);
  const std::string title =
      record.label.value_or(record.settings.empty() ? record.technique : record.technique + ":" + record.settings);
  write_png(out / *record.error_picture, draw_errors(answer.evidence(run.scene, measured.light), title));
  write_png(out / *record.shaded_picture, shade(run.scene, answer.gbuffer, measured.light, answer.mask));
}

}  // namespace gnomon
