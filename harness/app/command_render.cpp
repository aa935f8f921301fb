#include <gnomon/registry.h>

#include <fstream>

#include "app/app.h"
#include "app/staged_folder.h"
#include "measure/paths.h"
#include "measure/picture/detail_export.h"
#include "measure/picture/picture.h"
#include "measure/run/context.h"
#include "measure/run/row.h"
#include "measure/scene/load.h"
#include "measure/score/error_picture.h"

namespace gnomon::app {

namespace {

namespace fs = std::filesystem;

struct RenderOptions {
  std::string scene, technique, view, size = "640x360", truth = "shape", debug;
  std::vector<std::string> lights;
  fs::path out, detail;
  int threads = 0;
  double timeout = 120;
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

/// Where a light's surface detail goes: the first light's to the file that is asked for, every further one's beside it.
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

/// The surface detail of the light that the seat stands at, as an OBJ file and its materials.
void write_detail(Seat& seat, const SceneRun& run, const Job& job, const Light& light, double timeout,
                  const fs::path& obj_file) {
  const fs::path raw = run.scratch / "detail.raw";
  seat.worker().ask({{"do", "detail"}, {"out", raw.string()}}, timeout);
  const SurfaceDetail detail = detail_from_bytes(MappedFile::open(raw)->bytes());
  const glm::dvec4 l = homogeneous(light);
  std::string place = fmt::format("{} {:.9g} {:.9g} {:.9g}", l.w == 0 ? "toward" : "at", l.x, l.y, l.z);
  if (const auto* const spot = std::get_if<SpotLight>(&light.kind)) {
    const glm::vec3& d = spot->direction;
    place += fmt::format(", shining along {:.9g} {:.9g} {:.9g} within {:.9g} degrees, at which no polygon is cut", d.x, d.y,
                         d.z, spot->outer_degrees);
  }
  const std::vector<std::string> notes{fmt::format("scene: {}", job.scene),
                                       fmt::format("light: {}, a {} light {}", light.name, kind_name(light), place),
                                       fmt::format("technique: {}", job.contender.name())};
  const fs::path mtl_file = fs::path(obj_file).replace_extension(".mtl");
  write_file(obj_file, detail_obj(run.scene, detail, notes, mtl_file.filename().string()));
  write_file(mtl_file, detail_mtl());
}

int render(const RenderOptions& options, const WorkerOptions& worker) {
  const std::vector<Contender> contenders = parse_contenders(options.technique);
  if (contenders.size() != 1)
    throw Error("--technique {} is a sweep of {}; render takes one", options.technique, contenders.size());
  const std::optional<DebugLayer> layer = find_layer(contenders[0], options.debug);
  if (!options.detail.empty()) check_detail_file(contenders[0], options.detail);
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
  // The first light's files have plain names; every further light's are marked with it.
  const auto tail_of = [&](const Job& job) { return &job == jobs.data() ? "" : "_" + job.light; };
  if (!options.detail.empty())
    for (const Job& job : jobs) check_replaced(detail_file_of(options.detail, tail_of(job)), options.scene);
  for (const std::string& note : entry.scene->notes) fmt::print(stderr, "note: {}\n", note);

  std::unique_ptr<StagedFolder> detail_folder;
  if (!options.detail.empty()) detail_folder.reset(new StagedFolder(StagedFolder::for_file(options.detail)));
  const StagedFolder folder = StagedFolder::beside(options.out);
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
    const ErrorCounts& counts = measured.errors;
    // One warm call each: `gnomon run` is for timing.
    for (const Stage stage : {Stage::build, Stage::relight, Stage::resolve}) record.times(stage) = {{seat.time(stage)}};
    const std::string tail = tail_of(job);
    write_png(folder.path / ("mask" + tail + ".png"), draw_mask(answer.mask, suite.width, suite.height));
    write_png(folder.path / ("shaded" + tail + ".png"), shade(run.scene, answer.gbuffer, measured.light, answer.mask));
    write_png(folder.path / ("error" + tail + ".png"),
              draw_errors(answer.evidence(run.scene, measured.light), job.contender.name()));
    if (layer) {
      const fs::path raw = run.scratch / "layer.raw";
      seat.worker().ask({{"do", "debug"}, {"layer", layer->name}, {"out", raw.string()}}, suite.timeout);
      write_png(folder.path / (layer->name + tail + ".png"), draw_layer(raw, suite.width, suite.height, *layer));
    }
    if (detail_folder) {
      const fs::path file = detail_folder->path / detail_file_of(options.detail, tail).filename();
      write_detail(seat, run, job, measured.light, suite.timeout, file);
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
  if (detail_folder) detail_folder->publish();
  folder.publish();
  fmt::print("{}\n", (options.out / "mask.exr").string());
  return 0;
}

}  // namespace

void add_render(Program& program) {
  Command command = program.line.command("render", "One technique on one scene: mask, shaded and error pictures, record");
  auto options = std::make_shared<RenderOptions>();
  command.option("--scene", &options->scene, "Scene id, ID:param=value, or a scene or mesh file").required();
  command.option("--technique", &options->technique, "Technique id, or ID:param=value,...").required();
  command.option("--light", &options->lights, "Light names; all of the scene by default").delimiter(',');
  command.option("--view", &options->view, "View name; the first by default");
  command.option("--size", &options->size, "Picture size in pixels, WxH").shows_default();
  command.option("--truth", &options->truth, "What counts: exact shapes or the meshes; shape | mesh").shows_default();
  command.option("--debug", &options->debug, "Also draw this debug layer of the technique").check(not_empty());
  command
      .option("--detail", &options->detail,
              "Also write the technique's lit and shadowed polygons to this Wavefront OBJ file; FILE.obj")
      .check(not_empty());
  command.option("--threads", &options->threads, "Cores to use; all by default");
  command.option("--timeout", &options->timeout, "Seconds that one step may take").check(seconds()).shows_default();
  command.option("--out", &options->out, "Folder to write to").required();
  command.action([&program, options] { return render(*options, worker_options(program, options->threads)); });
}

}  // namespace gnomon::app
