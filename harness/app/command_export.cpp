// gnomon export: what a program of one's own needs to make a mask that `gnomon score` takes.
#include "app/app.h"
#include "app/staged_folder.h"
#include "measure/exchange/gltf.h"
#include "measure/exchange/scene_files.h"
#include "measure/paths.h"
#include "measure/picture/picture.h"
#include "measure/progress.h"
#include "measure/run/suite.h"
#include "measure/scene/load.h"
#include "measure/scene/names.h"
#include "measure/scene/scene_json.h"
#include "measure/worker/worker_frame_maker.h"

namespace gnomon::app {

namespace {

namespace fs = std::filesystem;

struct ExportOptions {
  std::string scene, view, size = "640x360", truth = "shape";
  std::vector<std::string> lights;
  fs::path out;
};

/// Names of files alone: the folder may be moved.
Json with_names(Json arrays) {
  for (auto& array : arrays) array["file"] = fs::path(array["file"].get<std::string>()).filename().string();
  return arrays;
}

/// What is true under a light: `visibility`, `class`; with area also the standard error and what half of the rays
/// say, and all three of the irradiance.
Arrays reference_arrays(const Reference& reference, std::span<const std::uint32_t> classes, int width, int height) {
  const std::vector<std::size_t> shape = {static_cast<std::size_t>(height), static_cast<std::size_t>(width)};
  Arrays arrays = {{"visibility", array_of<float>(shape, {reference.mask})},
                   {"class", array_of<std::uint32_t>(shape, {classes})}};
  if (reference.error.empty()) return arrays;
  arrays.emplace("error", array_of<float>(shape, {reference.error}));
  arrays.emplace("irradiance", array_of<float>(shape, {reference.irradiance}));
  arrays.emplace("irradiance_error", array_of<float>(shape, {reference.irradiance_error}));
  arrays.emplace("half", array_of<float>(shape, {reference.half}));
  arrays.emplace("irradiance_half", array_of<float>(shape, {reference.irradiance_half}));
  return arrays;
}

void export_frame(const ExportOptions& options) {
  const auto [width, height] = parse_size(options.size, "--size");
  const Scene scene = load_scene(options.scene);
  require_names(options.scene, scene, options.lights, listed(options.view));
  const FrameKey key{named_or_first(scene.views, options.view), width, height, parse_truth(options.truth)};
  const std::vector<const Light*> lights = chosen(scene.lights, options.lights);
  for (const Light* light : lights) require_reference(scene, *light, key.view);

  StagedFolder folder(options.out);
  Json facts = scene_facts_json(scene);
  facts["arrays"] = with_names(write_arrays(folder.path, "scene", SceneArrays(scene).arrays()));
  write_file(folder.path / "scene.json", json_text(facts, 1) + "\n");
  write_gltf(folder.path / "scene.gltf", scene);

  Progress progress;
  FrameStore frames(scene, cache_root() / "frames",
                    std::make_unique<WorkerFrameMaker>(fs::path(), "", shown_on(progress, options.scene)));
  const GBuffer gbuffer = frames.gbuffer(key);
  Json frame = json_object({{"scene", options.scene},
                            {"view", scene_json(key.view)},
                            {"width", width},
                            {"height", height},
                            {"truth", options.truth},
                            {"gbuffer", with_names(write_arrays(folder.path, "gbuffer", gbuffer_arrays(gbuffer)))},
                            {"classes", json_object()},
                            {"lights", Json::array()}});
  for (std::size_t c = 0; c < class_infos().size(); ++c) frame["classes"][std::string(class_infos()[c].letter)] = c;
  write_gbuffer_exr(folder.path / "gbuffer.exr", gbuffer);

  std::vector<Reference> references;  // which own what the channels look at
  std::vector<std::string> names;
  std::vector<std::span<const float>> channels;
  for (const Light* light : lights) {
    const Reference& reference = references.emplace_back(frames.reference(key, *light));
    names.push_back(light->name + ".V");
    channels.push_back(reference.mask);
    std::vector<std::uint32_t> classes;
    for (const PixelClass c : reference.classes) classes.push_back(static_cast<std::uint32_t>(c));
    Json one = scene_json(*light);
    one["reference"] =
        with_names(write_arrays(folder.path, "reference_" + light->name, reference_arrays(reference, classes, width, height)));
    frame["lights"].push_back(one);
  }
  write_exr(folder.path / "reference.exr", width, height, names, channels);
  write_file(folder.path / "frame.json", json_text(frame, 1) + "\n");
  folder.publish();

  const std::string out = options.out.string();
  fmt::print(
      "{0}/scene.gltf             scene with cameras and lights\n"
      "{0}/scene.json             the same in the words of a scene file; its arrays are {0}/scene_*.npy\n"
      "{0}/frame.json             the view, its lights, and the arrays of this frame\n"
      "{0}/gbuffer.exr            what the eye sees, and {0}/gbuffer_*.npy\n"
      "{0}/reference.exr          what is true, a channel LIGHT.V each, and {0}/reference_LIGHT_*.npy with the classes\n\n"
      "gnomon score --scene {1}{2} --mask FILE.exr    scores a mask of {3} x {4} pixels\n",
      out, options.scene, options.view.empty() ? "" : " --view " + options.view, width, height);
}

}  // namespace

void add_export(Program& program) {
  auto [command, options] = program.line.command<ExportOptions>(
      "export", "Scene, G-buffer and reference as files, for programs that make masks", export_frame);
  command.option("--scene", &options.scene, "Scene id, ID:param=value, or a scene or mesh file", {.is_required = true});
  command.option("--view", &options.view, "View name; the first by default", {.check = not_empty()});
  command.option("--light", &options.lights, "Light names; all by default", {.delimiter = ','});
  command.option("--size", &options.size, "Picture size in pixels, WxH");
  command.option("--truth", &options.truth, "What counts: exact shapes or the meshes; shape | mesh");
  command.option("--out", &options.out, "Folder for the files", {.is_required = true, .check = not_empty()});
}

}  // namespace gnomon::app
