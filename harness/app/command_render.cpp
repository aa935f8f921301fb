#include <gnomon/kit/pictures/surface_detail.h>
#include <gnomon/registry.h>

#include <fstream>

#include "app/app.h"
#include "app/staged_folder.h"
#include "app/time_option.h"
#include "measure/notice.h"
#include "measure/paths.h"
#include "measure/picture/detail_export.h"
#include "measure/picture/picture.h"
#include "measure/record/scene_place.h"
#include "measure/row/measure_row.h"
#include "measure/run/jobs.h"
#include "measure/scene/load.h"
#include "measure/score/error_picture.h"
#include "measure/scratch_folder.h"
#include "measure/worker/machine_context.h"

namespace gnomon::app {

namespace {

namespace fs = std::filesystem;

struct RenderOptions {
  std::string scene, technique, view, size = "640x360", truth = "shape", debug;
  std::vector<std::string> lights;
  TimeOption time;
  fs::path out, detail;
  int threads = 0, global_samples = 0;
  double timeout = 120;
};

/// The debug layer of that name; nothing for an empty name. Refuses one that the technique does not have before anything
/// runs.
std::optional<DebugLayer> find_layer(const Contender& contender, const std::string& layer) {
  if (layer.empty()) return std::nullopt;
  const auto technique = registry().technique(contender.technique).make();
  technique->apply(contender.settings);
  std::vector<std::string> layers;
  for (const DebugLayer& known : technique->debug_layers()) {
    if (known.name == layer) return known;
    layers.push_back(known.name);
  }
  if (layers.empty()) throw Error("{} has no debug layer {}; it has none at all", contender.technique, layer);
  throw Error("{} has no debug layer {}; did you mean {}? It has: {}", contender.technique, layer, nearest_word(layer, layers),
              joined(layers, ", "));
}

/// Where a light's surface detail goes: the first light's to the file that --detail names, every further one's beside it.
fs::path detail_file_of(const fs::path& file, const std::string& tail) {
  return fs::path(file).replace_filename(file.stem().string() + tail + ".obj");
}

/// Refuses to replace what this program did not write as surface detail, a file of the scene above all.
void check_replaced(const fs::path& obj_file, const std::string& scene) {
  std::error_code ignored;
  for (const fs::path& file : {obj_file, fs::path(obj_file).replace_extension(".mtl")}) {
    if (!fs::is_regular_file(file, ignored)) continue;
    std::string line;
    std::getline(std::ifstream(file), line);
    if (fs::equivalent(file, scene, ignored) || !line.starts_with(detail_mark))
      throw Error("--detail {} would replace {}, which is {}: choose another name", obj_file.string(), file.string(),
                  fs::equivalent(file, scene, ignored) ? "the scene" : "no surface detail");
  }
}

/// Refuses a file for surface detail that cannot be, before anything runs.
void check_detail_file(const Contender& contender, const fs::path& file) {
  if (file.extension() != ".obj")
    throw Error("--detail {} is no name that ends in .obj: surface detail is written as Wavefront OBJ", file.string());
  const auto technique = registry().technique(contender.technique).make();
  technique->apply(contender.settings);
  if (!technique->surface_detail())
    throw Error("{} makes no surface detail for --detail {}; gnomon describe ID says which technique does", contender.technique,
                file.string());
}

/// What the first lines of a file with surface detail say of it.
std::vector<std::string> detail_notes(const Job& job, const Light& light) {
  const glm::dvec4 l = homogeneous_of_center(light);
  std::string place = fmt::format("{} {:.9g} {:.9g} {:.9g}", l.w == 0 ? "toward" : "at", l.x, l.y, l.z);
  if (const auto* const spot = std::get_if<SpotLight>(&light.kind)) {
    const glm::vec3& d = spot->direction;
    place += fmt::format(", shining along {:.9g} {:.9g} {:.9g} within {:.9g} degrees, at which no polygon is cut", d.x, d.y,
                         d.z, spot->outer_degrees);
  }
  return {fmt::format("scene: {}", job.scene), fmt::format("light: {}, a {} light {}", light.name, kind_name(light), place),
          fmt::format("technique: {}", job.contender.name())};
}

/// The first row's files have plain names, every further row's are marked with its light. Where first lights are left out, the
/// first that is not has the plain names.
std::string tail_of(const std::vector<Job>& jobs, const Job& job) { return &job == jobs.data() ? "" : "_" + job.light; }

/// A suite of one technique on one scene and view.
Suite render_suite(const RenderOptions& options, const Contender& contender) {
  Suite suite;
  suite.name = "render";
  std::tie(suite.width, suite.height) = parse_size(options.size, "--size");
  suite.truth = parse_truth(options.truth);
  suite.timeout = options.timeout;
  SuiteGroup& group = suite.groups.emplace_back();
  group.scenes = {options.scene};
  group.lights = options.lights;
  group.contenders = {contender};
  group.global_samples = options.global_samples;
  if (!options.view.empty()) group.views = {options.view};
  return suite;
}

/// One line: the error and what it is read against; where the answer is binary how many pixels are wrong, of several lights
/// what is wrong with the light received.
std::string summary(const Record& record, const ErrorCounts& errors) {
  const auto percent = [&](std::string_view metric) {
    const std::optional<double> value = record.metric(metric);
    return value ? fmt::format("{:.4f} %", 100 * *value) : "-";
  };
  std::string text = fmt::format("error {} over {} tested pixels, best constant mask {}", percent("error"), errors.tested,
                                 percent("constant_error"));
  if (record.metric("error_floor")) text += ", floor " + percent("error_floor");
  if (record.answer == AnswerKind::received)
    return fmt::format("{} lights, {}, light received {} (rms), FLIP {:.4f}", light_count(record), text,
                       percent("received_error_rms"), record.metric("flip").value_or(0));
  text += ", wrong " + percent("wrong_rate");
  if (record.answer == AnswerKind::binary || record.answer == AnswerKind::transmitted)
    text += fmt::format(", false dark {}, false lit {}", errors.false_dark, errors.false_lit);
  return record.metric("radiosity_error") ? text + ", error of all light " + percent("radiosity_error") : text;
}

/// Renders the lights of a scene one after the other and writes what came out into the folders, which are published when all
/// of it is there.
class Rendering {
 public:
  Rendering(const RenderOptions& options, const WorkerOptions& options_of_worker, std::optional<DebugLayer> layer,
            const std::vector<Job>& jobs, const Scene& scene, const Suite& suite)
      : options_(options),
        layer_(std::move(layer)),
        jobs_(jobs),
        suite_(suite),
        run_(scene, {.cache = cache_root() / "frames",
                     .scratch = scratch_.path(),
                     .target = suite.target,
                     .timeout = suite.timeout,
                     .watch = shown_on(progress_, options.scene)}),
        context_(machine_context(options_of_worker.threads)),
        worker_(run_, jobs[0].contender.technique, jobs[0].contender.settings, options_of_worker) {
    context_["frames"] = frame_version();
    worker_.begin_load();
    worker_.end_load();
  }

  /// A row that is unsupported is left out.
  void render(const Job& job) {
    const RowFrame frame = first_frame(job, run_.scene);
    const Support support = worker_.go(frame, suite_.truth);
    if (!support) return leave_out(job, support.why());
    if (support.kind() == Support::Kind::approximate) print_notice("note: {}: {}\n", job.light, support.why());
    Record record = start_record(job, suite_, &run_.scene, context_);
    record.context["scene_hash"] = run_.frames.scene_hash(job.lights);
    if (const auto path = path_to_scene(options_.out, job.scene)) record.context["scene_file"] = *path;
    record.support = support.kind();
    record.reason = support.why();
    const ContenderWorker::SetupTime setup = worker_.setup_time();
    const auto note = [&](Stage stage, double ms, const OtherClocks& others) {
      record.times(stage) = {{ms}};
      if (others.device) record.device_times(stage) = {{*others.device}};
      if (others.harness) record.harness_times(stage) = {{*others.harness}};
    };
    note(Stage::setup, setup.ms, setup.other_clocks);
    const auto measured = measure(record, run_, worker_, frame);
    if (!measured) return leave_out(job, record.reason);
    // One warm call each: `gnomon run` is for timing.
    for (const Stage stage : timed_stages) {
      const double ms = worker_.client().time(stage);
      note(stage, ms, worker_.client().other_clocks());
    }
    write_pictures_of(job, *measured);
    record.mask = "mask.exr";
    record.error_picture = "error" + tail_of(job) + ".png";
    record.shaded_picture = "shaded" + tail_of(job) + ".png";
    for (const MeasuredLight& light : measured->lights) {
      const std::string channel = light.light.name + ".V";
      if (std::ranges::find(names_, channel) != names_.end()) continue;  // in another row, too
      names_.push_back(channel);
      masks_.push_back(light.answer.mask);
    }
    records_.push_back(record);
    const Evidence evidence = measured->evidence(run_.scene);
    fmt::print("{:<12} {}\n", job.light, summary(record, Scoring(evidence).error_counts()));
  }

  /// Throws Error when no row is there to be published.
  void publish() {
    if (records_.empty()) {
      std::vector<std::string> reasons;
      for (const auto& [job, why] : left_out_) reasons.push_back(fmt::format("{}: {}", job->light, why));
      throw Error("{} does not support {} {}", jobs_[0].contender.name(), jobs_[0].scene, joined(reasons, "; "));
    }
    for (const auto& [job, why] : left_out_) print_notice("note: {} is left out: {}\n", job->light, why);
    const std::vector<std::span<const float>> channels(masks_.begin(), masks_.end());
    write_exr(folder_.path / "mask.exr", suite_.width, suite_.height, names_, channels);
    write_file(folder_.path / "record.json", json_text(records_, 2) + "\n");
    if (detail_folder_) detail_folder_->publish();
    folder_.publish();
  }

 private:
  void leave_out(const Job& job, const std::string& why) { left_out_.emplace_back(&job, why); }
  std::string tail_of(const Job& job) const { return records_.empty() ? "" : "_" + job.light; }

  void write_pictures_of(const Job& job, const MeasuredRow& measured) {
    const int width = suite_.width, height = suite_.height;
    const auto picture_file = [&](const std::string& name, const std::string& tail) {
      return folder_.path / (name + tail + ".png");
    };
    const std::string tail = tail_of(job);
    const auto drawn = [&](std::span<const float> mask, AnswerKind kind) {
      return (kind == AnswerKind::binary ? draw_mask : draw_soft_mask)(mask, width, height);
    };
    if (layer_) tell_exact(measured);
    const Evidence evidence = measured.evidence(run_.scene);
    if (measured.together && !measured.together->channels.empty()) {
      std::array<std::span<const float>, std::size(all_channels)> channels;
      for (const Together& one : measured.together->channels) channels[static_cast<std::size_t>(*one.channel)] = one.shown;
      write_png(picture_file("mask", tail), draw_color_mask(channels, width, height));
    } else {
      write_png(picture_file("mask", tail), drawn(measured.mask(), evidence.kind));
    }
    write_png(picture_file("shaded", tail), shade(run_.scene, measured));
    write_png(picture_file("error", tail), draw_errors(evidence, job.contender.name()));
    for (std::size_t k = 0; k < measured.lights.size(); ++k) {
      const Light& light = measured.lights[k].light;
      const Answer& answer = measured.lights[k].answer;
      const std::string own_tail = measured.together ? tail + "_" + light.name : tail;
      if (measured.together) {
        if (!worker_.supports_light(k)) continue;
        write_png(picture_file("mask", own_tail), drawn(answer.mask, answer.reference.kind));
      }
      if (layer_)
        write_png(picture_file(layer_->name, own_tail),
                  draw_layer(worker_.client().debug_layer(layer_->name, k), width, height, *layer_));
      if (detail_folder_) write_detail(job, light, own_tail, k);
    }
  }

  /// Layers may show parts of the error. The technique has answered anew since they were asked for: the same, as the first
  /// picture of a sequence.
  void tell_exact(const MeasuredRow& measured) {
    std::vector<Answer> answers;
    for (const MeasuredLight& light : measured.lights) answers.push_back(light.answer);
    worker_.check_error_terms(answers);
  }

  /// The surface detail of a light that was measured last, as an OBJ file and its materials.
  void write_detail(const Job& job, const Light& light, const std::string& tail, std::size_t number) {
    const fs::path obj_file = detail_folder_->path / detail_file_of(options_.detail, tail).filename();
    const fs::path mtl_file = fs::path(obj_file).replace_extension(".mtl");
    const SurfaceDetail detail = worker_.client().surface_detail(number);
    check_detail(run_.scene, detail);
    write_file(obj_file, detail_obj(run_.scene, detail, detail_notes(job, light), mtl_file.filename().string()));
    write_file(mtl_file, detail_mtl());
  }

  const RenderOptions& options_;
  const std::optional<DebugLayer> layer_;
  const std::vector<Job>& jobs_;
  const std::unique_ptr<StagedFolder> detail_folder_{
      options_.detail.empty() ? nullptr : new StagedFolder(options_.detail, StagedFolder::Target::file)};
  const StagedFolder folder_{options_.out};
  const ScratchFolder scratch_ = ScratchFolder::at(folder_.path / "scratch");
  Progress progress_;  ///< of the frames that are traced
  const Suite& suite_;
  SceneRun run_;
  Json context_;
  ContenderWorker worker_;
  std::vector<std::string> names_;  ///< channels of mask.exr
  std::vector<std::vector<float>> masks_;
  Json records_ = Json::array();
  std::vector<std::pair<const Job*, std::string>> left_out_;  ///< with the reason
};

int render(const RenderOptions& options, const WorkerOptions& worker) {
  const std::vector<Contender> contenders = parse_contenders(options.technique);
  if (contenders.size() != 1)
    throw Error("--technique {} is a sweep of {}; render takes one", options.technique, contenders.size());
  const std::optional<DebugLayer> layer = find_layer(contenders[0], options.debug);
  if (!options.detail.empty()) check_detail_file(contenders[0], options.detail);
  const Suite suite = render_suite(options, contenders[0]);
  SceneLibrary library;
  const std::vector<Job> jobs = expand_jobs(suite, library, worker).jobs;
  const SceneLibrary::Entry& entry = library.get(options.scene);
  if (!entry.scene) throw Error("{}", entry.missing);
  if (!options.detail.empty())
    for (const Job& job : jobs)
      for (const std::string& light : job.lights)
        check_replaced(detail_file_of(options.detail, tail_of(jobs, job) + (job.lights.size() > 1 ? "_" + light : "")),
                       options.scene);
  for (const std::string& note : entry.scene->notes) print_notice("note: {}\n", note);

  Rendering rendering(options, worker, layer, jobs, *entry.scene, suite);
  for (const Job& job : jobs) rendering.render(job);
  rendering.publish();
  fmt::print("{}\n", (options.out / "mask.exr").string());
  return 0;
}

}  // namespace

void add_render(Program& program) {
  auto [command, options] = program.line.command<RenderOptions>(
      "render", "One technique on one scene: mask, shaded and error pictures, record", [&program](RenderOptions& read) {
        put_time(read.scene, read.time);
        return render(read, worker_options(program, read.threads));
      });
  command.option("--scene", &options.scene, "Scene id, ID:param=value, or a scene or mesh file", {.is_required = true});
  command.option("--technique", &options.technique, "Technique id, or ID:param=value,...", {.is_required = true});
  add_time_option(command, options.time);
  command.option("--light", &options.lights, "Light names; all of the scene by default", {.delimiter = ','});
  command.option("--view", &options.view, "View name; the first by default", {.check = not_empty()});
  command.option("--size", &options.size, "Picture size in pixels, WxH");
  command.option("--truth", &options.truth, "What counts: exact shapes or the meshes; shape | mesh");
  command.option("--debug", &options.debug, "Also draw this debug layer of the technique", {.check = not_empty()});
  command.option("--global-samples", &options.global_samples,
                 "Light paths of a pixel of the reference that the global picture is compared with; not compared by default",
                 {.check = whole_in(least_global_samples, most_global_samples)});
  command.option("--detail", &options.detail,
                 "Also write the technique's lit and shadowed polygons to this Wavefront OBJ file; FILE.obj",
                 {.check = not_empty()});
  command.option("--threads", &options.threads, "Cores to use; all by default");
  command.option("--timeout", &options.timeout, "Seconds that one step may take", {.check = seconds()});
  command.option("--out", &options.out, "Folder to write to", {.is_required = true, .check = not_empty()});
}

}  // namespace gnomon::app
