// gnomon view: the window. Everything that can be wrong with its options is said before it opens.
#include <gnomon/registry.h>

#include "app/app.h"
#include "app/time_option.h"
#include "app/viewer/application.h"
#include "app/viewer/session.h"
#include "measure/notice.h"
#include "measure/run/light_selection.h"
#include "measure/run/suite.h"
#include "measure/scene/channels.h"
#include "measure/scene/load.h"
#include "measure/scene/motion.h"
#include "measure/scene/names.h"

namespace gnomon::app {

namespace {

struct ViewCommand {
  viewer::ViewOptions view;
  std::string technique, against, light, view_name, size = "960x540", truth = "shape", keys;
  TimeOption time;
  int threads = 0;
};

/// The one technique that an option names.
viewer::SideSelection parse_side(const std::string& option, const std::string& text) {
  const std::vector<Contender> contenders = parse_contenders(text);
  if (contenders.size() != 1) throw Error("{} {} is a sweep of {}; a side shows one", option, text, contenders.size());
  return {.technique = contenders[0].technique, .settings = contenders[0].settings, .layer = ""};
}

int view(ViewCommand& options, const Program& program) {
  viewer::ViewOptions& view = options.view;
  viewer::Selection& selection = view.selection;
  // An animation without a time is played.
  const std::string played = options.time.seconds ? "" : options.time.animation;
  put_time(selection.scene, played.empty() ? options.time : TimeOption());
  view.workers = worker_options(program, options.threads);
  view.workers.keeps_shaders = true;  // a side should show soon, and its setup is not measured
  selection.sides[0] = parse_side("--technique", options.technique);
  selection.sides[1] = parse_side("--against", options.against.empty() ? registry().reference().id : options.against);
  std::tie(selection.width, selection.height) = parse_size(options.size, "--size");
  selection.truth = parse_truth(options.truth);
  view.keys = viewer::key_table().parse(options.keys);
  if (!view.screenshot.empty() && view.screenshot.extension() != ".png")
    throw Error("--screenshot {} is no name that ends in .png", view.screenshot.string());
  view.loaded = std::make_shared<viewer::LoadedScene>(viewer::LoadedScene{selection.scene, load_scene(selection.scene)});
  const Scene& scene = view.loaded->scene;
  const bool is_plain = options.light.empty() || is_light_name(options.light);
  require_names(selection.scene, scene, listed(is_plain ? options.light : ""), listed(options.view_name));
  const std::string word = options.light.empty() ? whole_lights(scene.lights)[0].name : options.light;
  const std::vector<RowLights> rows = row_lights({word}, selection.scene, scene);
  if (rows.size() != 1)
    throw Error("--light {} is {} pictures; the window shows one: {}+ is that of all", word, rows.size(), word);
  const std::vector<std::string>& names = rows[0].lights;
  selection.light = named_or_first(scene.lights, names[0]);
  if (names.size() > 1)
    for (const std::string& name : names) selection.together.push_back(named_or_first(scene.lights, name));
  selection.view = named_or_first(scene.views, options.view_name);
  if (!played.empty())
    selection.at = pose_at(find_path(scene, animation_of(scene, played).name, selection.light, selection.view), 0);
  viewer::check_script(view.keys, selection, view.loaded);
  for (const std::string& note : scene.notes) print_notice("note: {}\n", note);
  if (view.out.empty()) view.out = timed_folder("view");
  view.ends_by_itself = !options.keys.empty() || !view.screenshot.empty() || view.speed_seconds > 0;
  return viewer::run_viewer(view);
}

}  // namespace

void add_view(Program& program) {
  auto [command, options] =
      program.line.command<ViewCommand>("view", "A window: any two techniques side by side, or one beside the truth",
                                        [&program](ViewCommand& read) { return view(read, program); });
  if (!registry().scenes().empty()) options.view.selection.scene = registry().default_scene().id;
  if (!registry().techniques().empty()) options.technique = registry().default_technique().id;
  command.option("--scene", &options.view.selection.scene, "Scene id, ID:param=value, or a scene or mesh file");
  add_time_option(command, options.time, "Shows the scene at the first frame of this animation, to be played");
  command.option("--technique", &options.technique, "Technique of the left side: id, or ID:param=value,...");
  command.option("--against", &options.against, "Technique of the right side; the reference by default",
                 {.check = not_empty()});
  command.option("--light", &options.light, "Light name, several together as sun+lamp or all+; the first by default",
                 {.check = not_empty()});
  command.option("--view", &options.view_name, "View name; the first by default", {.check = not_empty()});
  command.option("--size", &options.size, "Size of the picture in pixels, WxH; the window is larger");
  command.option("--truth", &options.truth, "What counts: exact shapes or the meshes; shape | mesh");
  command.option("--threads", &options.threads, "Cores that each technique uses; all by default");
  command.option("--timeout", &options.view.timeout_seconds, "Seconds that one step may take", {.check = seconds()});
  command.option("--out", &options.view.out, "Folder for what is saved; runs/view-TIME by default");
  command.option("--keys", &options.keys,
                 "Keys to press and parameters to set one after the other, \"k left.resolution=512 v Ctrl+S\"; then it ends");
  const auto screenshot = command.option("--screenshot", &options.view.screenshot,
                                         "Write the window to this file when all is computed, and end", {.check = not_empty()});
  command.option("--speed", &options.view.speed_seconds,
                 "Print how many pictures a second are shown at rest, with the light and with the camera moving, each "
                 "measured for so many seconds, and end",
                 {.check = seconds(), .excludes = screenshot});
}

}  // namespace gnomon::app
