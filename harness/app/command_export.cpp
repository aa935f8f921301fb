// gnomon export: what a program of one's own needs to make a mask that `gnomon score` takes.
#include "app/command_export.h"

#include "app/staged_folder.h"
#include "measure/exchange/gltf.h"
#include "measure/exchange/scene_files.h"
#include "measure/notice.h"
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

/// Names of files alone: the folder may be moved.
Json with_names(Json arrays) {
  for (auto& array : arrays) array["file"] = fs::path(array["file"].get<std::string>()).filename().string();
  return arrays;
}

/// What is true under a light: `visibility`, `class`; with area also the standard error and what half of the rays
/// say, and all three of the irradiance. Of a light's three channels each array is 3 x height x width.
Arrays reference_arrays(std::span<const Reference> channels, int width, int height) {
  std::vector<std::size_t> shape = {static_cast<std::size_t>(height), static_cast<std::size_t>(width)};
  if (channels.size() > 1) shape.insert(shape.begin(), channels.size());
  Arrays arrays;
  const auto add = [&](const char* name, std::span<const float> Reference::*numbers) {
    ArrayParts& array = arrays.emplace(name, array_of<float>(shape, {})).first->second;
    for (const Reference& reference : channels) array.parts.push_back(std::as_bytes(reference.*numbers));
  };
  add("visibility", &Reference::mask);
  if (channels.front().error.empty()) return arrays;
  add("error", &Reference::error);
  add("irradiance", &Reference::irradiance);
  add("irradiance_error", &Reference::irradiance_error);
  add("half", &Reference::half);
  add("irradiance_half", &Reference::irradiance_half);
  return arrays;
}

/// One light of the frame, of one channel or all three, with its reference in files of the folder.
Json write_light(const fs::path& folder, const Light& light, std::span<const Reference> channels, int width, int height) {
  Arrays arrays = reference_arrays(channels, width, height);
  std::vector<std::uint32_t> classes;
  for (const Reference& reference : channels)
    for (const PixelClass c : reference.classes) classes.push_back(static_cast<std::uint32_t>(c));
  arrays.emplace("class", array_of<std::uint32_t>(arrays.at("visibility").shape, {classes}));
  Json json = scene_json(light);
  json["reference"] = with_names(write_arrays(folder, "reference_" + light.name, arrays));
  return json;
}

void export_frame(const ExportOptions& options) {
  const auto [width, height] = parse_size(options.size, "--size");
  const Scene scene = load_scene(options.scene);
  require_names(options.scene, scene, options.lights, listed(options.view));
  const FrameKey key{named_or_first(scene.views, options.view), width, height, parse_truth(options.truth)};
  const std::vector<const Light*> lights = chosen(scene.lights, options.lights);
  Progress progress;
  FrameStore frames(scene, cache_root() / "frames",
                    std::make_unique<WorkerFrameMaker>(fs::path(), "", shown_on(progress, options.scene)));
  for (const Light* light : lights) require_reference(frames.scene(*light), *light, key.view);

  StagedFolder folder(options.out);
  Json facts = scene_facts_json(scene);
  facts["arrays"] = with_names(write_arrays(folder.path, "scene", SceneArrays(scene).arrays()));
  write_file(folder.path / "scene.json", json_text(facts, 1) + "\n");
  write_gltf(folder.path / "scene.gltf", scene);

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

  std::vector<std::vector<Reference>> references;  // by light and channel; they own what `channels` looks at
  std::vector<std::string> names;
  std::vector<std::span<const float>> channels;
  for (const auto& group : by_whole_light(lights, [](const Light* light) { return std::string_view(light->name); })) {
    std::vector<Reference>& found = references.emplace_back();
    for (const Light* light : group) {
      found.push_back(frames.reference(key, *light));
      names.push_back(light->name + ".V");
      channels.push_back(found.back().mask);
    }
    Light light = *group.front();
    if (group.size() > 1) light.name = whole_name(light.name);
    frame["lights"].push_back(write_light(folder.path, light, found, width, height));
  }
  write_exr(folder.path / "reference.exr", width, height, names, channels);
  write_file(folder.path / "frame.json", json_text(frame, 1) + "\n");
  folder.publish();

  if (scene.motion) print_notice("note: {} moves: the files have it at rest, without its animations\n", options.scene);
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

/// What makes the command write frames, and what it takes then.
void add_sequence_options(Command& command, ExportOptions& options) {
  CLI::Option* const sequence =
      command.flag("--sequence", &options.is_sequence, "Write the frames of a row on a path, with the masks of a technique");
  const auto add = [&](const char* name, OptionTarget target, const std::string& sentence, Check check) {
    command.option(name, target, "With --sequence: " + sentence, {.check = std::move(check), .needs = sequence});
  };
  add("--technique", &options.technique, "technique id, or ID:param=value,...", not_empty());
  add("--path", &options.path, "path of camera or light that the frames follow: of the scene, or camera_slide, light_slide",
      not_empty());
  add("--frames", &options.frames, "frames of an animation; up to its last key by default",
      whole_in(least_frames, most_frames));
  add("--frame-rate", &options.frame_rate, "its frames per second; 60 by default", above_zero());
  add("--start", &options.start, "seconds of the animation at the first frame; 0 by default", not_negative());
  add("--threads", &options.threads, "cores that the technique uses; all by default", {});
  add("--timeout", &options.timeout, "seconds that one step may take", seconds());
}

}  // namespace

void add_export(Program& program) {
  auto [command, options] = program.line.command<ExportOptions>(
      "export", "Scene, G-buffer and reference as files, for programs that make masks; frames, for those that judge videos",
      [&program](ExportOptions& read) {
        if (read.is_sequence) return export_sequence(read, worker_options(program, read.threads));
        if (!read.time.animation.empty() && !read.time.seconds)
          throw Error("--animation {} needs --time, the seconds at which it is shown, or --sequence", read.time.animation);
        put_time(read.scene, read.time);
        export_frame(read);
      });
  command.option("--scene", &options.scene, "Scene id, ID:param=value, or a scene or mesh file", {.is_required = true});
  add_time_option(command, options.time, "With --sequence: the frames follow this animation");
  command.option("--view", &options.view, "View name; the first by default", {.check = not_empty()});
  command.option("--light", &options.lights, "Light names; all by default, with --sequence the first", {.delimiter = ','});
  command.option("--size", &options.size, "Picture size in pixels, WxH");
  command.option("--truth", &options.truth, "What counts: exact shapes or the meshes; shape | mesh");
  command.option("--out", &options.out, "Folder for the files", {.is_required = true, .check = not_empty()});
  add_sequence_options(command, options);
}

}  // namespace gnomon::app
