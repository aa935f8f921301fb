// gnomon score and certify: a mask against the reference, and the reference against exact answers.
#include <embree3/rtcore_config.h>

#include "app/app.h"
#include "app/staged_folder.h"
#include "measure/cause/causes.h"
#include "measure/frame/certify.h"
#include "measure/frame/certify_soft.h"
#include "measure/paths.h"
#include "measure/picture/picture.h"
#include "measure/run/frame_worker.h"
#include "measure/run/jobs.h"
#include "measure/run/progress.h"
#include "measure/scene/load.h"
#include "measure/score/error_picture.h"
#include "measure/score/score.h"
#include "report/table/digits.h"
#include "report/table/text_table.h"

namespace gnomon::app {

namespace {

namespace fs = std::filesystem;

struct ScoreOptions {
  std::string scene, view, truth = "shape", channel;
  std::vector<std::string> lights;
  fs::path mask, out;
  bool json = false;
};

/// A light of the scene, and the channel of the file that answers it.
struct Channel {
  const Light& light;
  std::string name;
};

/// The lights or views of these names; all without names.
template <class Item>
std::vector<const Item*> chosen(const std::vector<Item>& items, const std::vector<std::string>& names) {
  std::vector<const Item*> result;
  for (const Item& item : items)
    if (names.empty() || std::ranges::find(names, item.name) != names.end()) result.push_back(&item);
  return result;
}

/// A scene's frames, traced by a worker that a bar watches.
FrameStore frames_of(const Scene& scene, const std::string& name, Progress& progress) {
  return {scene, cache_root() / "frames", std::make_unique<FrameWorker>(fs::path(), "", shown_on(progress, name))};
}

/// By the names that this program writes, LIGHT.V; another name only where it is clear whose it is.
std::vector<Channel> channels_of(const ScoreOptions& options, const Scene& scene) {
  const std::vector<std::string> present = image_files().exr_channels(options.mask);
  const auto has = [&](const std::string& name) { return std::ranges::find(present, name) != present.end(); };
  const std::vector<const Light*> asked = chosen(scene.lights, options.lights);
  const std::string file = options.mask.string(), names = joined(present, ", ");
  if (!options.channel.empty()) {
    if (asked.size() != 1)
      throw Error("--channel {} is of one light, and {} are asked for: name one with --light", options.channel, asked.size());
    if (!has(options.channel)) throw Error("{} has no channel {}; it has: {}", file, options.channel, names);
    return {{*asked[0], options.channel}};
  }
  std::vector<Channel> channels;
  for (const Light* light : asked) {
    const std::string name = light->name + ".V";
    if (has(name))
      channels.push_back({*light, name});
    else if (asked.size() == 1 && present.size() == 1)
      channels.push_back({*light, present[0]});
    else if (!options.lights.empty())
      throw Error("{} has no channel {}; it has: {}", file, name, names);
  }
  if (channels.empty())
    throw Error("{} has no channel LIGHT.V for a light of {}; it has: {}. Name one with --light and --channel", file,
                options.scene, names);
  return channels;
}

std::vector<float> read_mask(const fs::path& file, const std::string& channel, int width, int height) {
  std::vector<float> mask = read_exr(file, channel, width, height);
  for (std::size_t i = 0; i < mask.size(); ++i)
    if (!(mask[i] >= 0 && mask[i] <= 1))
      throw Error("{}: channel {} is {} at x = {}, y = {}; a visibility is in 0 .. 1", file.string(), channel, mask[i],
                  i % width, i / width);
  return mask;
}

/// `causes`: what each holds of the error.
std::string text_of(const Metrics& metrics, const std::map<std::string, double>& causes) {
  TextTable table({{"metric", ""}, {"value", "", Align::right}, {"unit", ""}, {"what it is", ""}});
  const auto add = [&](const std::string& name, std::optional<double> value, std::string_view unit, std::string_view sentence) {
    const bool is_share = unit.empty();
    table.add_row({name, value ? measured(is_share ? 100 * *value : *value) : "-", std::string(is_share ? "%" : unit),
                   std::string(sentence)});
  };
  for (const MetricInfo& info : metric_infos())
    add(std::string(info.name), metrics.at(std::string(info.name)), info.unit, info.sentence);
  for (const CauseInfo& info : cause_infos())
    if (const auto found = causes.find(std::string(info.name)); found != causes.end())
      add(fmt::format("cause.{}", info.name), found->second, "", info.sentence);
  return table.text(terminal_width());
}

Json json_of(const Metrics& metrics) {
  Json values = Json::object();
  for (const MetricInfo& info : metric_infos()) {
    const std::string name(info.name);
    if (const std::optional<double> value = metrics.at(name))
      values[name] = *value;
    else
      values[name] = nullptr;
  }
  return values;
}

/// Wrong pixels by cause, causes that occur only.
std::map<std::string, std::uint64_t> causes_that_occur(std::span<const Cause> causes) {
  std::map<std::string, std::uint64_t> counts;
  for (const Cause cause : causes)
    if (cause != Cause::none) ++counts[std::string(name(cause))];
  return counts;
}

/// What those hold of the wrong rate, under a light with area of the mean error.
std::map<std::string, double> shares_of(const std::map<std::string, std::uint64_t>& causes, const Evidence& evidence,
                                        std::size_t tested) {
  std::map<std::string, double> shares;
  const std::map<std::string, double> errors = cause_errors(evidence);
  for (const auto& [cause, pixels] : causes)
    shares[cause] = has_area(*evidence.light) ? errors.at(cause) : static_cast<double>(pixels) / static_cast<double>(tested);
  return shares;
}

int score(const ScoreOptions& options) {
  const Scene scene = load_scene(options.scene);
  require_names(options.scene, scene, options.lights,
                options.view.empty() ? std::vector<std::string>() : std::vector{options.view});
  const View& view = named_or_first(scene.views, options.view);
  const std::vector<Channel> channels = channels_of(options, scene);
  for (const Channel& channel : channels) require_reference(scene, channel.light, view);
  const auto [width, height] = image_files().exr_size(options.mask);
  const FrameKey key{view, width, height, parse_truth(options.truth)};
  std::vector<std::vector<float>> masks;  // all of them before the reference, which takes its time
  for (const Channel& channel : channels) masks.push_back(read_mask(options.mask, channel.name, width, height));
  Progress progress;
  FrameStore frames = frames_of(scene, options.scene, progress);
  std::unique_ptr<StagedFolder> folder;
  if (!options.out.empty()) folder = std::make_unique<StagedFolder>(options.out);
  Json list = Json::array();
  for (std::size_t k = 0; k < channels.size(); ++k) {
    const Channel& channel = channels[k];
    const Light& light = channel.light;
    Answer answer;
    answer.gbuffer = frames.gbuffer(key);
    answer.reference = frames.reference(key, light);
    answer.mask = std::move(masks[k]);
    // A file explains no pixel: causes follow from where wrong pixels lie and how many hang together.
    answer.causes =
        find_causes({scene, frames.casters(key.truth), answer.gbuffer, light, answer.reference, answer.mask, {}, nullptr});
    const Evidence evidence = answer.evidence(scene, light);
    const Scoring scoring(evidence);
    const Metrics metrics = measure_metrics(scoring);
    const std::map<std::string, std::uint64_t> causes = causes_that_occur(answer.causes);
    const std::map<std::string, double> shares =
        shares_of(causes, evidence, std::max<std::size_t>(1, scoring.error_counts().tested));
    if (folder) {
      const std::string tail = channels.size() == 1 ? "" : "_" + light.name;
      write_png(folder->path / ("error" + tail + ".png"), draw_errors(evidence, options.mask.filename().string()));
      write_png(folder->path / ("shaded" + tail + ".png"), shade(scene, answer.gbuffer, light, answer.mask));
    }
    if (!options.json) {
      fmt::print("{}scene {}, light {}, view {}, {} x {}, {} truth: {} of {} pixels facing the light are tested\n\n{}",
                 k == 0 ? "" : "\n", options.scene, light.name, view.name, width, height, options.truth,
                 scoring.error_counts().tested, scoring.error_counts().facing, text_of(metrics, shares));
      continue;
    }
    Json& row = list.emplace_back();
    row["scene"] = options.scene;
    row["light"] = light.name;
    row["view"] = view.name;
    row["width"] = width;
    row["height"] = height;
    row["truth"] = options.truth;
    row["mask"] = options.mask.string();
    row["channel"] = channel.name;
    row["metrics"] = json_of(metrics);
    row["classes"] = class_counts(answer.reference.classes);
    row["causes"] = causes;
    if (has_area(light)) row["cause_errors"] = shares;
  }
  if (options.json) fmt::print("{}\n", json_text(list, 2));
  if (folder) folder->publish();
  return 0;
}

struct CertifyCommand {
  std::string scene, size = "640x360";
  std::vector<std::string> lights, views;
  bool json = false;
};

int run_certify(const CertifyCommand& options) {
  const auto [width, height] = parse_size(options.size, "--size");
  const Scene scene = load_scene(options.scene);
  require_names(options.scene, scene, options.lights, options.views);
  const std::vector<const Light*> lights = chosen(scene.lights, options.lights);
  std::vector<const View*> views = chosen(scene.views, options.views);
  if (options.views.empty()) views.resize(1);  // the one that suites use
  for (const Light* light : lights) require_reference(scene, *light, scene.views.front());
  Progress progress;
  FrameStore frames = frames_of(scene, options.scene, progress);
  bool all_hold = true;
  Json list = Json::array();
  for (const View* view : views)
    for (const Light* light : lights) {
      // The oracle knows triangles: the certificate is of mesh truth.
      const FrameKey key{*view, width, height, Truth::mesh};
      const Reference reference = frames.reference(key, *light);
      if (has_area(*light)) {
        const SoftCertificate certificate = certify_soft(scene, *light, frames.gbuffer(key), reference,
                                                         {.reference = frames.casters(Truth::mesh).description()});
        all_hold = all_hold && certificate.holds();
        if (options.json)
          list.push_back(certificate);
        else
          fmt::print("{}\n", text(certificate));
        continue;
      }
      CertifyOptions certify_options;
      certify_options.is_uncertain = [&](std::size_t i) { return reference.classes[i] == PixelClass::U; };
      certify_options.reference = frames.casters(Truth::mesh).description();
      const Certificate certificate = certify(scene, *light, frames.gbuffer(key), reference.mask, certify_options);
      all_hold = all_hold && certificate.holds();
      if (options.json)
        list.push_back(certificate);
      else
        fmt::print("{}\n", text(certificate));
    }
  if (options.json) fmt::print("{}\n", json_text(list, 2));
  return all_hold ? 0 : 1;
}

}  // namespace

void add_score(Program& program) {
  auto [command, options] =
      program.line.command<ScoreOptions>("score", "A mask that another program made, against the reference", score);
  command.option("--scene", &options.scene, "Scene id, ID:param=value, or a scene or mesh file", {.is_required = true});
  command.option("--mask", &options.mask, "Image of visibilities, 1 lit and 0 in shadow; its size is the picture's",
                 {.is_required = true, .check = not_empty()});
  command.option("--light", &options.lights, "Light names; by default every light of which the mask has a channel LIGHT.V",
                 {.delimiter = ','});
  command.option("--channel", &options.channel, "Channel of the one light asked for", {.check = not_empty()});
  command.option("--view", &options.view, "View name; the first by default", {.check = not_empty()});
  command.option("--truth", &options.truth, "What counts: exact shapes or the meshes; shape | mesh");
  command.option("--out", &options.out, "Folder for error and shaded pictures", {.check = not_empty()});
  command.flag("--json", &options.json, "As JSON");
}

void add_certify(Program& program) {
  auto [command, options] = program.line.command<CertifyCommand>(
      "certify", "How far the reference may be trusted: exact answers beside it", run_certify);
  command.option("--scene", &options.scene, "Scene id, ID:param=value, or a scene or mesh file", {.is_required = true});
  command.option("--light", &options.lights, "Light names; all by default", {.delimiter = ','});
  command.option("--view", &options.views, "View names; the first by default", {.delimiter = ','});
  command.option("--size", &options.size, "Picture size in pixels, WxH");
  command.flag("--json", &options.json, "As JSON");
}

}  // namespace gnomon::app
