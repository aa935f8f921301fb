#include <gnomon/registry.h>
#include <unistd.h>

#include <fstream>

#include "app/app.h"
#include "measure/paths.h"
#include "measure/picture/picture.h"
#include "measure/run/context.h"
#include "measure/run/row.h"
#include "measure/scene/load.h"

namespace gnomon::app {

namespace {

namespace fs = std::filesystem;

struct RenderOptions {
  std::string scene, technique, view, size = "640x360", truth = "shape", debug;
  std::vector<std::string> lights;
  fs::path out;
  int threads = 0;
  double timeout = 120;
};

/// A new folder's files appear in it at once: all is written beside it first, and renamed when it is whole.
class StagedFolder {
 public:
  explicit StagedFolder(fs::path out) : out_(std::move(out)) {
    std::error_code code;
    const fs::path parent = fs::absolute(out_).parent_path();
    fs::create_directories(parent, code);
    if (!code && fs::exists(out_) && !fs::is_directory(out_)) code = std::make_error_code(std::errc::not_a_directory);
    path = parent / fmt::format(".{}.{}.part", out_.filename().string(), getpid());
    if (!code) fs::create_directories(path, code);
    if (code) throw Error("output folder {} cannot be made: {}", out_.string(), code.message());
  }
  ~StagedFolder() {
    std::error_code ignored;
    fs::remove_all(path, ignored);
  }
  void publish() {
    std::error_code code;
    fs::create_directories(out_, code);
    for (const auto& entry : fs::directory_iterator(path))
      if (!code && entry.is_regular_file()) fs::rename(entry.path(), out_ / entry.path().filename(), code);
    if (code) throw Error("output folder {} cannot be written: {}", out_.string(), code.message());
  }
  fs::path path;

 private:
  fs::path out_;
};

/// The debug layer of that name; nothing when none is asked for. Refuses one that the technique does not have before anything
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
              fmt::join(layers, ", "));
}

int render(const RenderOptions& options, const WorkerOptions& worker) {
  const std::vector<Contender> contenders = parse_contenders(options.technique);
  if (contenders.size() != 1)
    throw Error("--technique {} is a sweep of {}; render takes one", options.technique, contenders.size());
  const std::optional<DebugLayer> layer = find_layer(contenders[0], options.debug);
  Suite suite;
  suite.name = "render";
  std::tie(suite.width, suite.height) = parse_size(options.size, "--size");
  suite.truth = parse_truth(options.truth);
  suite.timeout = options.timeout;
  suite.groups = {{{options.scene}, options.lights, {}, contenders}};
  if (!options.view.empty()) suite.groups[0].views = {options.view};
  SceneLibrary library;
  const std::vector<Job> jobs = expand_jobs(suite, library);
  const SceneLibrary::Entry& entry = library.get(options.scene);
  if (!entry.scene) throw Error("{}", entry.missing);
  for (const std::string& note : entry.scene->notes) fmt::print(stderr, "note: {}\n", note);

  StagedFolder folder(options.out);
  SceneRun run(options.scene, *entry.scene, suite, cache_root() / "frames", folder.path / "scratch");
  fs::create_directories(run.scratch);
  const Json context = machine_context(worker.threads);
  Seat seat(run, contenders[0], worker);
  seat.open_begin();
  seat.open_end();

  std::vector<std::string> names;
  std::vector<std::vector<float>> masks;
  Json records = Json::array();
  for (const Job& job : jobs) {
    const Standpoint place = run.place(job);
    const Support support = seat.go(place, suite.truth);
    if (!support) throw Error("{} does not support {} {}: {}", job.contender.name(), job.scene, job.light, support.why());
    if (support.kind() == Support::Kind::approximate) fmt::print(stderr, "note: {}: {}\n", job.light, support.why());
    Record record = start_record(job, suite, &*entry.scene, context);
    record.support = support.kind();
    record.reason = support.why();
    record.context["scene_hash"] = run.frames.scene_hash();
    record.context["frames"] = frame_version();
    record.times(Stage::setup) = {{seat.setup_ms()}};
    const auto result = measure(record, run, seat, place);
    if (!result) throw Error("{} does not support {} {}: {}", job.contender.name(), job.scene, job.light, record.reason);
    const MeasuredRow& measured = *result;
    const Answer& answer = measured.answer;
    const Tally& counts = measured.tally;
    // One warm call each: `gnomon run` is for timing.
    for (const Stage stage : {Stage::build, Stage::relight, Stage::resolve}) record.times(stage) = {{seat.time(stage)}};
    // The first light's pictures have plain names; every further light's are marked with it.
    const std::string tail = masks.empty() ? "" : "_" + job.light;
    write_png(folder.path / ("mask" + tail + ".png"), draw_mask(answer.mask, suite.width, suite.height));
    write_png(folder.path / ("shaded" + tail + ".png"), shade(run.scene, answer.gbuffer, measured.light, answer.mask));
    write_png(folder.path / ("error" + tail + ".png"),
              draw_errors(answer.evidence(run.scene, measured.light), job.contender.name()));
    if (layer) {
      const fs::path raw = run.scratch / "layer.raw";
      seat.worker().ask({{"do", "debug"}, {"layer", layer->name}, {"out", raw.string()}}, suite.timeout);
      write_png(folder.path / (layer->name + tail + ".png"), draw_layer(raw, suite.width, suite.height, *layer));
    }
    record.mask = "mask.exr";
    record.error_picture = "error" + tail + ".png";
    record.shaded_picture = "shaded" + tail + ".png";
    names.push_back(job.light + ".V");
    masks.push_back(answer.mask);
    records.push_back(record);
    fmt::print("{:<12} wrong {:.4f} % of {} tested pixels, false dark {}, false lit {}\n", job.light,
               counts.tested ? 100.0 * counts.wrong / counts.tested : 0.0, counts.tested, counts.false_dark, counts.false_lit);
  }
  const std::vector<std::span<const float>> channels(masks.begin(), masks.end());
  write_exr(folder.path / "mask.exr", suite.width, suite.height, names, channels);
  write_file(folder.path / "record.json", records.dump(2) + "\n");
  folder.publish();
  fmt::print("{}\n", (options.out / "mask.exr").string());
  return 0;
}

}  // namespace

void add_render(Program& program) {
  CLI::App* command =
      program.cli.add_subcommand("render", "One technique on one scene: mask, shaded and error pictures, record");
  auto options = std::make_shared<RenderOptions>();
  command->add_option("--scene", options->scene, "Scene id, ID:param=value, or a scene or mesh file")->required();
  command->add_option("--technique", options->technique, "Technique id, or ID:param=value,...")->required();
  command->add_option("--light", options->lights, "Light names; all of the scene by default")->delimiter(',');
  command->add_option("--view", options->view, "View name; the first by default");
  command->add_option("--size", options->size, "Picture size in pixels, WxH")->capture_default_str();
  command->add_option("--truth", options->truth, "What counts: exact shapes or the meshes; shape | mesh")
      ->capture_default_str();
  command->add_option("--debug", options->debug, "Also draw this debug layer of the technique");
  command->add_option("--threads", options->threads, "Cores to use; all by default");
  command->add_option("--timeout", options->timeout, "Seconds that one step may take")->check(seconds())->capture_default_str();
  command->add_option("--out", options->out, "Folder to write to")->required();
  command->callback([&program, options] {
    program.chosen = [&program, options] { return render(*options, worker_options(program, options->threads)); };
  });
}

}  // namespace gnomon::app
