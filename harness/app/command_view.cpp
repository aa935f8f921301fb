// gnomon view: the window. Everything that can be wrong with its options is said before it opens.
#include <fmt/chrono.h>
#include <gnomon/registry.h>

#include "app/app.h"
#include "app/viewer/application.h"
#include "measure/run/jobs.h"
#include "measure/run/suite.h"
#include "measure/scene/load.h"

namespace gnomon::app {

namespace {

namespace fs = std::filesystem;

struct ViewerOptions {
  std::string scene, technique, against, light, view, size = "960x540", truth = "shape", keys;
  fs::path out, screenshot;
  int threads = 0;
  double timeout = 120, speed = 0;
};

/// The one technique that an option names.
viewer::SideSelection parse_side(const std::string& option, const std::string& text) {
  const std::vector<Contender> contenders = parse_contenders(text);
  if (contenders.size() != 1) throw Error("{} {} is a sweep of {}; a side shows one", option, text, contenders.size());
  return {.technique = contenders[0].technique, .settings = contenders[0].settings, .layer = ""};
}

int view(const ViewerOptions& options, const WorkerOptions& workers) {
  viewer::ViewOptions result;
  result.workers = workers;
  result.timeout_seconds = options.timeout;
  viewer::Selection& selection = result.selection;
  selection.scene = options.scene;
  selection.sides[0] = parse_side("--technique", options.technique);
  selection.sides[1] = parse_side("--against", options.against.empty() ? registry().reference().id : options.against);
  std::tie(selection.width, selection.height) = parse_size(options.size, "--size");
  selection.truth = parse_truth(options.truth);
  result.keys = viewer::key_table().parse(options.keys);
  if (!options.screenshot.empty() && options.screenshot.extension() != ".png")
    throw Error("--screenshot {} is no name that ends in .png", options.screenshot.string());
  result.scene = load_scene(options.scene);
  const auto names = [](const std::string& name) { return name.empty() ? std::vector<std::string>{} : std::vector{name}; };
  require_names(options.scene, result.scene, names(options.light), names(options.view));
  selection.light = named_or_first(result.scene.lights, options.light);
  selection.view = named_or_first(result.scene.views, options.view);
  for (const std::string& note : result.scene.notes) fmt::print(stderr, "note: {}\n", note);
  result.out = options.out.empty() ? fs::path("runs") / fmt::format("view-{:%Y%m%d-%H%M%S}", fmt::localtime(std::time(nullptr)))
                                   : options.out;
  result.screenshot = options.screenshot;
  result.speed_seconds = options.speed;
  result.ends_by_itself = !options.keys.empty() || !options.screenshot.empty() || options.speed > 0;
  return viewer::run_viewer(result);
}

}  // namespace

void add_view(Program& program) {
  auto [command, options] = program.line.command<ViewerOptions>(
      "view", "A window: any two techniques side by side, or one beside the truth",
      [&program](const ViewerOptions& read) { return view(read, worker_options(program, read.threads)); });
  if (!registry().scenes().empty()) options.scene = registry().default_scene().id;
  if (!registry().techniques().empty()) options.technique = registry().default_technique().id;
  command.option("--scene", &options.scene, "Scene id, ID:param=value, or a scene or mesh file");
  command.option("--technique", &options.technique, "Technique of the left side: id, or ID:param=value,...");
  command.option("--against", &options.against, "Technique of the right side; the reference by default",
                 {.check = not_empty()});
  command.option("--light", &options.light, "Light name; the first by default", {.check = not_empty()});
  command.option("--view", &options.view, "View name; the first by default", {.check = not_empty()});
  command.option("--size", &options.size, "Size of the picture in pixels, WxH; the window is larger");
  command.option("--truth", &options.truth, "What counts: exact shapes or the meshes; shape | mesh");
  command.option("--threads", &options.threads, "Cores that each technique uses; all by default");
  command.option("--timeout", &options.timeout, "Seconds that one step may take", {.check = seconds()});
  command.option("--out", &options.out, "Folder for what is saved; runs/view-TIME by default");
  command.option("--keys", &options.keys, "Keys to press one after the other, \"k v v Ctrl+S\"; then it ends");
  const auto screenshot = command.option("--screenshot", &options.screenshot,
                                         "Write the window to this file when all is computed, and end", {.check = not_empty()});
  command.option("--speed", &options.speed,
                 "Print how many pictures a second are shown at rest, with the light and with the camera moving, each "
                 "measured for so many seconds, and end",
                 {.check = seconds(), .excludes = screenshot});
}

}  // namespace gnomon::app
