#include "measure/run/row.h"

#include <gnomon/error.h>
#include <gnomon/kit/path_light.h>
#include <gnomon/registry.h>

#include <cmath>
#include <deque>

#include "measure/cause/causes.h"
#include "measure/run/plugin_facts.h"
#include "measure/scene/motion.h"
#include "measure/score/error_picture.h"

namespace gnomon {

namespace fs = std::filesystem;

namespace {

template <class Item>
std::size_t index_of(const std::vector<Item>& items, const std::string& name) {
  const Item* found = find_named(items, name);
  if (!found) throw Error("there is no {}", name);
  return static_cast<std::size_t>(found - items.data());
}

}  // namespace

RowFrame SceneRun::first_frame(const Job& job) const {
  RowFrame frame{.lights = {}, .view = index_of(scene.views, job.view), .width = job.width, .height = job.height, .path = {}};
  for (const std::string& light : job.lights) frame.lights.push_back(index_of(scene.lights, light));
  frame.global_samples = job.global_samples;
  if (!job.path.empty()) frame.path = find_path(scene, job.path, scene.lights[frame.lights.front()], scene.views[frame.view]);
  return frame;
}

std::vector<Light> SceneRun::lights(const RowFrame& frame) const {
  std::vector<Light> lights;
  for (const std::size_t index : frame.lights)
    lights.push_back(frame.path ? light_at(*frame.path, scene.lights[index], frame.number) : scene.lights[index]);
  return lights;
}

FrameKey SceneRun::key(const RowFrame& frame, Truth truth) const {
  const View& still = scene.views[frame.view];
  return {frame.path ? view_at(*frame.path, still, frame.number) : still, frame.width, frame.height,
          scene.has_curved_shapes() ? truth : Truth::shape};
}

FrameRequest SceneRun::request(const RowFrame& frame, Truth truth) {
  const FrameKey of = key(frame, truth);
  return {
      .gbuffer_file = frames.gbuffer_file(of),
      .width = of.width,
      .height = of.height,
      .truth = of.truth,
      .seen = SceneLightAndView{
          .lights = frame.lights, .view = frame.view, .path = frame.path ? frame.path->name : "", .path_frame = frame.number}};
}

ContenderWorker::ContenderWorker(SceneRun& run, const Contender& contender, const WorkerOptions& options)
    : run_(run), contender_(contender), client_(options, run.scratch / "worker", run.suite.timeout) {}

void ContenderWorker::begin_load() {
  client_.begin_load(
      {.scene_file = run_.frames.scene_file(), .technique = contender_.technique, .settings = contender_.settings});
}

Support ContenderWorker::go(const RowFrame& frame, Truth truth) {
  frame_ = frame;
  truth_ = truth;
  reply_ = client_.frame(run_.request(frame, truth));
  if (!reply_.support) return reply_.support;
  const View view = run_.key(frame, truth).view;
  for (const Light& light : run_.lights(frame))
    if (const Support reference = reference_support(run_.scene, light, view); !reference) return reference;
  return reply_.support;
}

std::size_t ContenderWorker::object_count() const {
  if (reply_.shares.value_or(true)) return 1;
  return static_cast<std::size_t>(std::ranges::count_if(reply_.lights, [](const Support& light) { return bool(light); }));
}

ContenderWorker::SetupTime ContenderWorker::setup_time() {
  const auto [found, is_new] = setup_times_.try_emplace(object_count());
  if (is_new) {
    found->second.ms = client_.time(Stage::setup);
    found->second.other_clocks = client_.other_clocks();
  }
  return found->second;
}

std::vector<Answer> ContenderWorker::answers(Record* record) {
  const MaskReply reply = client_.answer();
  const FrameKey key = run_.key(frame_, truth_);
  const int bits = client_.gl() ? client_.gl()->subpixel_bits : usual_subpixel_bits;
  const GBuffer gbuffer = run_.frames.gbuffer(key);
  std::vector<Answer> answers;
  auto next = reply.mask.begin();
  for (const Light& light : run_.lights(frame_)) {
    const auto end = next + static_cast<std::ptrdiff_t>(gbuffer.size());
    answers.push_back({gbuffer, run_.frames.reference(key, light, run_.suite.target, bits), {next, end}, {}});
    next = end;
  }
  if (!record) return answers;
  record->counts = reply.counts;
  for (const Count& c : record->counts)
    if (c.name == "bytes") record->bytes = static_cast<std::uint64_t>(c.value);
  record->peak_bytes = reply.peak_bytes;
  if (!reply.maker.empty()) record->context["plugin"]["maker"] = reply.maker;
  return answers;
}

namespace {

/// Adds the picture under one light to what is there; variances add up.
void add(GlobalAnswer& sum, std::span<const float> picture, const GlobalReference& reference) {
  sum.picture.resize(picture.size());
  sum.reference.resize(picture.size());
  sum.error.resize(picture.size());
  for (std::size_t k = 0; k < picture.size(); ++k) {
    sum.picture[k] += picture[k];
    sum.reference[k] += reference.radiance[k];
    sum.error[k] = std::hypot(sum.error[k], reference.error[k]);
  }
}

Record::ReferenceFacts::GlobalFacts facts_of(const GlobalReference& reference, int samples) {
  double errors = 0, whole = 0;
  for (std::size_t k = 0; k < reference.radiance.size(); ++k) {
    errors += static_cast<double>(reference.error[k]) * reference.error[k];
    whole += static_cast<double>(reference.radiance[k]) * reference.radiance[k];
  }
  return {.samples = samples, .rays = reference.rays, .error = whole > 0 ? std::sqrt(errors / whole) : 0};
}

}  // namespace

std::optional<GlobalAnswer> ContenderWorker::global_answer() {
  if (frame_.global_samples == 0 || endless_bounces(run_.scene)) return std::nullopt;
  GlobalAnswer sum;
  const std::vector<Light> lights = run_.lights(frame_);
  for (std::size_t k = 0; k < lights.size(); ++k) {
    sum.facts.emplace_back();
    if (!has_area(lights[k])) continue;
    if (!supports_light(k)) return std::nullopt;
    const auto picture = client_.global_picture(k);
    if (!picture) return std::nullopt;
    const GlobalReference reference = run_.frames.global_reference(run_.key(frame_, truth_), lights[k], frame_.global_samples);
    add(sum, *picture, reference);
    sum.facts.back() = facts_of(reference, frame_.global_samples);
  }
  if (sum.picture.empty()) return std::nullopt;
  return sum;
}

void ContenderWorker::note_lights(Record& record) const {
  record.shares_build = reply_.shares;
  for (std::size_t k = 0; k < reply_.lights.size() && k < record.lights.size(); ++k) {
    record.lights[k].support = reply_.lights[k].kind();
    record.lights[k].reason = reply_.lights[k].why();
  }
}

void ContenderWorker::note_gl(Record& record) const {
  if (!client_.gl()) return;
  record.context["gl_renderer"] = client_.gl()->renderer;
  record.context["gl_version"] = client_.gl()->version;
  record.context["gl_subpixel_bits"] = client_.gl()->subpixel_bits;
  if (reply_.upload) record.gl = {reply_.upload->bytes, reply_.upload->ms};
}

void ContenderWorker::note_card(Record& record) {
  const Json now = client_.card();
  if (now.is_null()) return;
  record.context["card"] = json_object({{"before", client_.gl()->card}, {"after", now}});
}

namespace {

/// Letters, digits, dots and dashes of the job's title, and its hash: readable, unique, and no longer than a file's name may
/// be.
std::string file_stem(const Record& record) {
  std::string stem;
  for (const char c : fmt::format("{}-{}-{}", fs::path(record.scene).stem().string(), record.light, record.technique))
    stem += std::isalnum(static_cast<unsigned char>(c)) || c == '.' || c == '-' || c == '_' ? c : '-';
  constexpr std::size_t most = 180;
  return stem.substr(0, most) + "-" + record.job.substr(0, 8);
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

void describe_scene(Record& record, const Scene& scene) {
  record.scene_facts = facts_of(scene);
  record.notes = scene.notes;
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
  for (const OwnCause& cause : entry.about.causes)
    record.own_causes.push_back({std::string(cause.id), std::string(cause.sentence), cause.color});
  const auto technique = entry.make();
  technique->apply(job.contender.settings);
  for (const Parameter* row : technique->parameters()) {
    const Json number = parse_if_json(row->text());
    record.parameters[std::string(row->name())] = number.is_number() ? number : Json(row->text());
  }
  record.width = job.width;
  record.height = job.height;
  record.path = job.path;
  record.place = job.place;
  record.truth = suite.truth;
  record.context = context;
  const Json plugin = plugin_facts(job.contender.technique, job.contender.settings);
  if (!plugin.is_null()) record.context["plugin"] = plugin;
  if (scene) {
    std::vector<std::string> kinds;
    for (const std::string& name : job.lights) {
      const Light* const light = find_named(scene->lights, name);
      if (!light) continue;
      if (std::ranges::find(kinds, kind_name(*light)) == kinds.end()) kinds.emplace_back(kind_name(*light));
      if (job.lights.size() > 1) {
        Record::LightFacts& facts = record.lights.emplace_back();
        facts.name = name;
        facts.kind = kind_name(*light);
      }
    }
    record.light_kind = joined(kinds, "+");
    describe_scene(record, *scene);
  }
  if (plugin.is_object() && !plugin.value("optimized", true))
    record.notes.push_back(fmt::format("{} comes from a plugin that was compiled without optimization", record.technique));
  return record;
}

void remove_pictures(const Record& record, const fs::path& out) {
  std::error_code ignored;
  for (const std::string& picture : pictures(record)) fs::remove(out / picture, ignored);
}

Evidence MeasuredRow::evidence(const Scene& scene) const {
  Evidence evidence = together ? together->evidence() : lights.front().answer.evidence(scene, lights.front().light);
  if (global) {
    evidence.global_picture = global->picture;
    evidence.global_reference = global->reference;
    evidence.global_error = global->error;
  }
  return evidence;
}

Picture shade(const Scene& scene, const MeasuredRow& row) {
  if (row.together) return shade(scene, row.gbuffer(), row.together->received, row.together->shown);
  return shade(scene, row.gbuffer(), row.lights.front().light, row.mask());
}

namespace {

/// What a row's mask file holds.
struct MaskChannels {
  std::vector<std::string> names;
  std::vector<std::span<const float>> values;
  std::deque<std::vector<float>> made;  ///< that `values` look at
};

/// Three values a pixel as channels "WHAT.R", "WHAT.G", "WHAT.B".
void add_colors(MaskChannels& file, std::string_view what, std::span<const float> rgb) {
  for (std::size_t channel = 0; channel < 3; ++channel) {
    std::vector<float>& values = file.made.emplace_back();
    for (std::size_t i = channel; i < rgb.size(); i += 3) values.push_back(rgb[i]);
    file.names.push_back(fmt::format("{}.{}", what, "RGB"[channel]));
    file.values.push_back(values);
  }
}

MaskChannels mask_channels(const Record& record, const MeasuredRow& measured) {
  MaskChannels file;
  for (const MeasuredLight& light : measured.lights) {
    const auto add = [&](std::string_view what, std::span<const float> values) {
      file.names.push_back(fmt::format("{}.{}", light.light.name, what));
      file.values.push_back(values);
    };
    add("V", light.answer.mask);
    if (!light.answer.causes.empty()) {
      std::vector<float>& causes = file.made.emplace_back();
      for (const Cause cause : light.answer.causes) causes.push_back(static_cast<float>(cause));
      add("cause", causes);
    }
    if (light.other_mask) add(name(record.truth == Truth::shape ? Truth::mesh : Truth::shape), *light.other_mask);
  }
  if (measured.global) {
    add_colors(file, global_channel, measured.global->picture);
    add_colors(file, global_reference_channel, measured.global->reference);
  }
  return file;
}

}  // namespace

void write_mask(Record& record, const MeasuredRow& measured, const fs::path& out) {
  record.mask = "masks/" + file_stem(record) + ".exr";
  // What `--rescore` and the report need: the mask, the cause of each pixel, the mask under the other truth, and
  // pictures of all light.
  const MaskChannels file = mask_channels(record, measured);
  write_exr(out / *record.mask, record.width, record.height, file.names, file.values);
}

void write_pictures(Record& record, const Scene& scene, const MeasuredRow& measured, const fs::path& out) {
  const std::string stem = file_stem(record);
  record.error_picture = "errors/" + stem + ".png";
  record.shaded_picture = "shaded/" + stem + ".png";
  const std::string title =
      record.label.value_or(record.settings.empty() ? record.technique : record.technique + ":" + record.settings);
  write_png(out / *record.error_picture, draw_errors(measured.evidence(scene), title));
  write_png(out / *record.shaded_picture, shade(scene, measured));
}

}  // namespace gnomon
