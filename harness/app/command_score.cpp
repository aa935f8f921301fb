// gnomon score: a mask that another program made, against the reference; on request as a row of a run.
#include <cmath>

#include "analysis/analysis.h"
#include "app/app.h"
#include "app/staged_folder.h"
#include "app/table_options.h"
#include "app/time_option.h"
#include "measure/paths.h"
#include "measure/picture/picture.h"
#include "measure/progress.h"
#include "measure/row/foreign_row.h"
#include "measure/scene/load.h"
#include "measure/scene/names.h"
#include "measure/score/error_picture.h"
#include "measure/score/score.h"
#include "measure/worker/worker_frame_maker.h"
#include "report/table/digits.h"
#include "report/table/text_table.h"

namespace gnomon::app {

namespace {

namespace fs = std::filesystem;

struct ScoreOptions {
  std::string scene, view, truth = "shape", channel, label, technique;
  std::vector<std::string> lights, told;
  TimeOption time;
  fs::path mask, out;
  bool json = false;
  TableWidth width;
};

/// A light of the scene, and the channel of the file with its mask.
struct LightChannel {
  const Light& light;
  std::string name;
};

/// Red, green and blue of a picture that has these three channels, and perhaps alpha; of any other file nothing.
std::vector<std::string> colors_of(std::vector<std::string> present) {
  std::erase_if(present, [](const std::string& name) { return name == "A" || name == "a"; });
  std::ranges::sort(present, std::greater<>());
  const bool are_colors =
      present == std::vector<std::string>{"R", "G", "B"} || present == std::vector<std::string>{"r", "g", "b"};
  return are_colors ? present : std::vector<std::string>();
}

/// Whether these are channels of one light that glass colors.
bool are_of_one_colored(const std::vector<const Light*>& lights) {
  const std::string_view whole = whole_name(lights.front()->name);
  return std::ranges::all_of(lights,
                             [&](const Light* light) { return light->name != whole && whole_name(light->name) == whole; });
}

/// By the names that this program writes, LIGHT.V; by another name only of a single light and channel, or of the three channels
/// of a light those of a color picture.
std::vector<LightChannel> channels_of(const ScoreOptions& options, const Scene& scene) {
  const std::vector<std::string> present = image_files().exr_channels(options.mask);
  const auto has = [&](const std::string& name) { return std::ranges::find(present, name) != present.end(); };
  const std::vector<const Light*> lights = chosen(scene.lights, options.lights);
  const std::string file = options.mask.string(), names = joined(present, ", ");
  const bool is_colored = are_of_one_colored(lights);
  if (!options.channel.empty()) {
    if (lights.size() != 1)
      throw Error("--channel {} is of one light, and {} are asked for: name one with --light{}", options.channel, lights.size(),
                  is_colored ? " " + lights[0]->name : "");
    if (!has(options.channel)) throw Error("{} has no channel {}; it has: {}", file, options.channel, names);
    return {{*lights[0], options.channel}};
  }
  std::vector<LightChannel> channels;
  if (const std::vector<std::string> colors = colors_of(present); is_colored && !colors.empty()) {
    for (const Light* light : lights) channels.push_back({*light, colors[static_cast<std::size_t>(*channel_of(light->name))]});
    return channels;
  }
  for (const Light* light : lights) {
    const std::string name = light->name + ".V";
    if (has(name))
      channels.push_back({*light, name});
    else if (lights.size() == 1 && present.size() == 1)
      channels.push_back({*light, present[0]});
    else if (!options.lights.empty())
      throw Error("{} has no channel {}; it has: {}. Name one with {}--channel", file, name, names,
                  lights.size() == 1 ? "" : "--light and ");
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
std::string text_of(const Metrics& metrics, const std::map<std::string, double>& causes, std::size_t width) {
  TextTable table({{"metric", ""}, {"value", "", Align::right}, {"unit", ""}, {"what it is", ""}});
  const auto add = [&](const std::string& name, std::optional<double> value, std::string_view unit, std::string_view sentence) {
    const bool is_share = unit.empty();
    table.add_row({name, value ? measured(is_share ? 100 * *value : *value) : "-", std::string(is_share ? "%" : unit),
                   std::string(sentence)});
  };
  for (const MetricInfo& info : metric_infos())
    if (info.value) add(std::string(info.name), metrics.at(std::string(info.name)), info.unit, info.sentence);
  for (const CauseInfo& info : cause_infos())
    if (const auto found = causes.find(std::string(info.name)); found != causes.end())
      add(fmt::format("cause.{}", info.name), found->second, "", info.sentence);
  return table.text(width);
}

Json json_of(const Metrics& metrics) {
  Json values = Json::object();
  for (const MetricInfo& info : metric_infos()) {
    if (!info.value) continue;
    const std::string name(info.name);
    const std::optional<double> value = metrics.at(name);
    values[name] = value ? Json(*value) : Json(nullptr);
  }
  return values;
}

/// What a change of the whole mask of a light explains, in words and in numbers.
Json change_json(const ScoredMask& mask, std::size_t light) {
  const WholeMask& whole = *mask.whole[light];
  Json json = json_object({{"change", name(whole.change)}, {"explained", whole.explained}, {"words", mask.words(light)}});
  if (whole.change == WholeMask::Change::shift) json["pixels"] = {whole.shift.x, whole.shift.y};
  if (whole.change == WholeMask::Change::gamma) json["power"] = whole.gamma;
  if (whole.change == WholeMask::Change::blur) json["sigma"] = whole.sigma;
  return json;
}

/// Wrong pixels by cause, causes that occur only.
std::map<std::string, std::uint64_t> causes_that_occur(const Score& score) {
  std::map<std::string, std::uint64_t> counts = *score.causes;
  std::erase_if(counts, [](const auto& cause) { return cause.second == 0; });
  return counts;
}

/// Their parts of the wrong rate; of an answer that is a fraction, of the mean error.
std::map<std::string, double> shares_of(const std::map<std::string, std::uint64_t>& causes, const RowScore& score) {
  std::map<std::string, double> shares;
  std::uint64_t tested = 0;  // under each light
  for (const Score& light : score.lights) tested += light.classes.at("T");
  for (const auto& [cause, pixels] : causes)
    shares[cause] = score.whole.cause_errors ? score.whole.cause_errors->at(cause)
                                             : static_cast<double>(pixels) / static_cast<double>(tested);
  return shares;
}

/// Adds what is said of the score of a light or a row.
void put(Json& json, const Score& score) {
  const std::map<std::string, std::uint64_t> causes = causes_that_occur(score);
  json["metrics"] = json_of(score.metrics);
  json["classes"] = score.classes;
  json["causes"] = causes;
  if (!score.cause_errors) return;
  Json& errors = json["cause_errors"] = json_object();
  for (const auto& [cause, pixels] : causes) errors[cause] = score.cause_errors->at(cause);
}

/// The masks of a file, and the frame that they are of.
struct Question {
  const ScoreOptions& options;
  const Scene& scene;
  FrameKey key;
  std::vector<std::vector<ForeignMask>> rows;  ///< of one light, or of a light's three channels
};

/// Says one row's score, or adds it to the list.
void report(const Question& question, std::size_t k, const ScoredMask& mask, Json& list) {
  const RowScore& score = mask.score;
  const ScoreOptions& options = question.options;
  const std::vector<ForeignMask>& masks = question.rows[k];
  const FrameKey& key = question.key;
  if (!options.json) {
    fmt::print("{}{}, light {}, view {}, {} x {}, {} truth: {} of {} pixels facing the light are tested\n\n{}",
               k == 0 ? "" : "\n", scene_in_words(options.scene), light_of(masks), key.view.name, key.width, key.height,
               options.truth, score.errors.tested, score.errors.facing,
               text_of(score.whole.metrics, shares_of(causes_that_occur(score.whole), score), options.width.columns()));
    if (const std::string words = mask.words(); !words.empty()) fmt::print("\n{}\n", words);
    return;
  }
  Json& row = list.emplace_back();
  row["scene"] = options.scene;
  row["light"] = light_of(masks);
  row["view"] = key.view.name;
  row["width"] = key.width;
  row["height"] = key.height;
  row["truth"] = options.truth;
  row["mask"] = options.mask.string();
  if (masks.size() == 1) row["channel"] = masks[0].channel;
  put(row, score.whole);
  if (masks.size() == 1) {
    if (mask.whole[0]) row["whole_mask"] = change_json(mask, 0);
    return;
  }
  for (std::size_t light = 0; light < masks.size(); ++light) {
    Json one = json_object({{"light", masks[light].light.name}, {"channel", masks[light].channel}});
    put(one, score.lights[light]);
    if (mask.whole[light]) one["whole_mask"] = change_json(mask, light);
    row["lights"].push_back(std::move(one));
  }
}

/// "resolve=12.5": milliseconds by stage that the caller claims.
std::map<Stage, double> told_times(const std::vector<std::string>& words) {
  std::map<Stage, double> times;
  for (const std::string& word : words) {
    const std::size_t equal = std::min(word.find('='), word.size());
    const auto* const stage = std::ranges::find(stage_names, std::string_view(word).substr(0, equal));
    const std::optional<double> ms = number_from(std::string_view(word).substr(std::min(equal + 1, word.size())));
    if (stage == std::end(stage_names) || !ms || !std::isfinite(*ms) || *ms < 0)
      throw Error("--ms {} is not STAGE=MILLISECONDS with a stage of {} and a number of 0 or more", word,
                  joined(std::vector<std::string>(std::begin(stage_names), std::end(stage_names)), ", "));
    if (!times.emplace(static_cast<Stage>(stage - std::begin(stage_names)), *ms).second)
      throw Error("--ms tells {} twice", word.substr(0, equal));
  }
  return times;
}

/// What the rows are called. Throws Error on what is wrong with it before anything is read. Nothing where no row is requested.
std::optional<ForeignNames> wanted_row(const ScoreOptions& options) {
  if (options.label.empty() && options.technique.empty()) {
    if (!options.told.empty()) throw Error("--ms is of a row: give it a --label, and --out for the run's folder");
    if (fs::exists(records_file(options.out)))
      throw Error("--out {} is the folder of a run: give the mask a --label to make it a row there", options.out.string());
    return std::nullopt;
  }
  if (options.out.empty()) throw Error("--label makes a row: --out names the run's folder that it goes to");
  ForeignNames row;
  row.technique = options.technique.empty() ? id_of_label(options.label) : options.technique;
  row.label = options.label.empty() ? row.technique : options.label;
  if (row.technique.empty())
    throw Error("--label '{}' has neither letters nor digits to make an id of: give one with --technique", row.label);
  check_foreign_id(row.technique);
  row.told_ms = told_times(options.told);
  row.file = options.mask;
  return row;
}

/// Each light's mask as a row of the run in `--out`.
void score_rows(const Question& question, const ForeignNames& called, FrameStore& frames, Json& list) {
  const ScoreOptions& options = question.options;
  std::vector<ForeignRow> rows;
  for (const std::vector<ForeignMask>& masks : question.rows)
    rows.push_back(foreign_row(question.scene, options.scene, frames, question.key, masks, called));
  add_foreign_rows(options.out, question.scene, rows);
  write_tables(options.out, read_records(options.out));
  for (std::size_t k = 0; k < rows.size(); ++k) report(question, k, rows[k].scored, list);
  for (std::size_t k = 0; k < rows.size(); ++k) {
    if (options.json) {
      list[k]["job"] = rows[k].record.job;
      list[k]["technique"] = called.technique;
      list[k]["label"] = called.label;
    } else {
      fmt::print("{}{}  {}\n", k == 0 ? "\n" : "", records_file(options.out).string(), title(rows[k].record));
    }
  }
}

/// The scores, and pictures of them where a folder is named.
void score_masks(const Question& question, FrameStore& frames, Json& list) {
  const ScoreOptions& options = question.options;
  std::unique_ptr<StagedFolder> folder;
  if (!options.out.empty()) folder = std::make_unique<StagedFolder>(options.out);
  for (std::size_t k = 0; k < question.rows.size(); ++k) {
    const std::vector<ForeignMask>& masks = question.rows[k];
    const ScoredMask scored = scored_mask(question.scene, frames, question.key, masks);
    if (folder) {
      const std::string tail = question.rows.size() == 1 ? "" : "_" + light_of(masks);
      write_png(folder->path / ("error" + tail + ".png"),
                draw_errors(scored.measured.evidence(question.scene), options.mask.filename().string()));
      write_png(folder->path / ("shaded" + tail + ".png"), shade(question.scene, scored.measured));
    }
    report(question, k, scored, list);
  }
  if (folder) folder->publish();
}

void score(const ScoreOptions& options) {
  const std::optional<ForeignNames> called = wanted_row(options);
  const Scene scene = load_scene(options.scene);
  require_names(options.scene, scene, options.lights, listed(options.view));
  const View& view = named_or_first(scene.views, options.view);
  const std::vector<LightChannel> channels = channels_of(options, scene);
  Progress progress;
  FrameStore frames(scene, cache_root() / "frames",
                    std::make_unique<WorkerFrameMaker>(fs::path(), "", shown_on(progress, options.scene)));
  for (const LightChannel& channel : channels) require_reference(frames.scene(channel.light), channel.light, view);
  const auto [width, height] = image_files().exr_size(options.mask);
  std::vector<ForeignMask> masks;
  for (const LightChannel& channel : channels)  // all of them before the reference, which takes its time
    masks.push_back({channel.light, channel.name, read_mask(options.mask, channel.name, width, height)});
  const Question question{options,
                          scene,
                          {view, width, height, parse_truth(options.truth)},
                          by_whole_light(masks, [](const ForeignMask& mask) { return std::string_view(mask.light.name); })};
  Json list = Json::array();
  if (called)
    score_rows(question, *called, frames, list);
  else
    score_masks(question, frames, list);
  if (options.json) fmt::print("{}\n", json_text(list, 2));
}

}  // namespace

void add_score(Program& program) {
  auto [command, options] = program.line.command<ScoreOptions>(
      "score", "A mask that another program made, against the reference", [](ScoreOptions& read) {
        put_time(read.scene, read.time);
        score(read);
      });
  command.option("--scene", &options.scene, "Scene id, ID:param=value, or a scene or mesh file", {.is_required = true});
  add_time_option(command, options.time);
  command.option("--mask", &options.mask, "Image of visibilities, 1 lit and 0 in shadow; its size is the picture's",
                 {.is_required = true, .check = not_empty()});
  command.option("--light", &options.lights, "Light names; by default every light of which the mask has a channel LIGHT.V",
                 {.delimiter = ','});
  command.option("--channel", &options.channel, "Channel of the one light requested", {.check = not_empty()});
  command.option("--view", &options.view, "View name; the first by default", {.check = not_empty()});
  command.option("--truth", &options.truth, "What counts: exact shapes or the meshes; shape | mesh");
  command.option("--label", &options.label, "Makes a row of each light's mask, which tables call so, in the run's folder --out",
                 {.check = not_empty()});
  command.option("--technique", &options.technique, "Id of such a row; made of the label by default", {.check = not_empty()});
  command.option("--ms", &options.told, "Times of such a row that are told, not measured: STAGE=MILLISECONDS,...",
                 {.delimiter = ','});
  command.option("--out", &options.out, "Folder for error and shaded pictures; with --label that of a run, new or there",
                 {.check = not_empty()});
  command.flag("--json", &options.json, "As JSON");
  add_width_options(command, options.width);
}

}  // namespace gnomon::app
