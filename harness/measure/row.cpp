#include "measure/row.h"

#include <gnomon/registry.h>

#include <algorithm>
#include <fstream>

#include "measure/picture.h"

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

Support Seat::go(std::size_t light, std::size_t view, Truth truth) {
  light_ = light;
  view_ = view;
  truth_ = truth;
  const FrameKey key = run_.key(view, truth);
  frame_reply_ = worker_.ask({{"do", "frame"},
                              {"gbuffer", run_.frames.gbuffer_file(key).string()},
                              {"view", view},
                              {"width", key.width},
                              {"height", key.height},
                              {"truth", name(key.truth)},
                              {"light", light}},
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
  const FrameKey key = run_.key(view_, truth_);
  Answer answer{frames.gbuffer(key), frames.reference(key, run_.scene.lights[light_]), {}, {}};
  answer.mask = read_mask_file(mask_file, answer.gbuffer.size());

  // Coverage is asked at wrong pixels only: an explanation may be slow.
  std::vector<std::uint32_t> wrong;
  const Evidence evidence = answer.evidence();
  for (std::size_t i = 0; i < answer.mask.size(); ++i)
    if (evidence.faces_light(i) && evidence.is_wrong(i)) wrong.push_back(static_cast<std::uint32_t>(i));
  if (!wrong.empty()) {
    const fs::path pixels = run_.scratch / "pixels.raw", covered = run_.scratch / "covered.raw";
    write_file(pixels, std::as_bytes(std::span(wrong)));
    const Json explained =
        worker_.ask({{"do", "coverage"}, {"pixels", pixels.string()}, {"out", covered.string()}}, run_.suite.timeout);
    if (explained["explained"].get<bool>()) {
      const auto file = MappedFile::open(covered);
      answer.uncovered.assign(answer.mask.size(), 0);
      for (std::size_t k = 0; k < wrong.size(); ++k) answer.uncovered[wrong[k]] = static_cast<std::uint8_t>(file->bytes()[k]);
    }
  }
  if (record) {
    record->counts.clear();
    for (const Json& c : reply["counts"]) record->counts.push_back({c["name"], c["value"], c["unit"]});
    for (const Count& c : record->counts)
      if (c.name == "bytes") record->bytes = static_cast<std::uint64_t>(c.value);
    record->peak_bytes = static_cast<std::uint64_t>(reply["peak_bytes"].get<double>());
  }
  return answer;
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
  record.width = suite.width;
  record.height = suite.height;
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

Measured measure(Record& record, SceneRun& run, Seat& seat) {
  if (!seat.gl().is_null()) {
    record.context["gl_renderer"] = seat.gl()["renderer"];
    record.context["gl_version"] = seat.gl()["version"];
    const Json& reply = seat.frame_reply();
    if (reply.contains("input_bytes")) record.gl = {reply["input_bytes"], reply["upload_ms"]};
  }
  Measured headline{seat.answer(&record), {}};
  headline.tally = tally(headline.answer.evidence());
  record.metrics[record.truth] = measure_metrics(headline.tally);
  record.classes = class_counts(headline.answer.reference.classes);
  const Truth other = record.truth == Truth::shape ? Truth::mesh : Truth::shape;
  if (run.scene.has_curved_shapes()) {
    const std::size_t light = run.light_index(record.light), view = run.view_index(record.view);
    seat.go(light, view, other);
    record.metrics[other] = measure_metrics(tally(seat.answer(nullptr).evidence()));
    seat.go(light, view, record.truth);
  } else {
    record.metrics[other] = record.metrics[record.truth];
  }
  record.status = Status::ok;
  return headline;
}

void write_pictures(Record& record, const SceneRun& run, const Measured& measured, const fs::path& out) {
  const Answer& answer = measured.answer;
  const std::string stem = file_stem(record);
  const Light& light = run.scene.lights[run.light_index(record.light)];
  const std::string names[] = {record.light + ".V"};
  const std::span<const float> channels[] = {answer.mask};
  record.mask = "masks/" + stem + ".exr";
  record.error_picture = "errors/" + stem + ".png";
  record.shaded_picture = "shaded/" + stem + ".png";
  write_exr(out / *record.mask, record.width, record.height, names, channels);
  const std::string title =
      record.label.value_or(record.settings.empty() ? record.technique : record.technique + ":" + record.settings);
  write_png(out / *record.error_picture,
            draw_errors(run.scene, answer.gbuffer, light, verdicts(answer.evidence()), measured.tally, title));
  write_png(out / *record.shaded_picture, shade(run.scene, answer.gbuffer, light, answer.mask));
}

}  // namespace gnomon
