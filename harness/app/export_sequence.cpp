// gnomon export --sequence: the frames of a row on a path as picture files, for programs that judge videos.
#include <gnomon/registry.h>

#include <algorithm>
#include <cctype>
#include <utility>

#include "app/command_export.h"
#include "app/staged_folder.h"
#include "app/suite_options.h"
#include "measure/exchange/scene_files.h"
#include "measure/notice.h"
#include "measure/paths.h"
#include "measure/picture/picture.h"
#include "measure/picture/shading.h"
#include "measure/program/plugin_facts.h"
#include "measure/progress.h"
#include "measure/row/row.h"
#include "measure/run/jobs.h"
#include "measure/scene/blob.h"
#include "measure/scene/motion.h"
#include "measure/scene/scene_json.h"
#include "measure/scratch_folder.h"
#include "measure/worker/build.h"
#include "measure/worker/worker_frame_maker.h"

namespace gnomon::app {

namespace {

namespace fs = std::filesystem;

/// The files of a frame: NAME_NUMBER.ENDING.
struct FrameFile {
  std::string_view name, ending, sentence;
  std::string of(int frame) const { return fmt::format("{}_{:04}.{}", name, frame, ending); }
  /// For programs that put the number in themselves.
  std::string pattern() const { return fmt::format("{}_%04d.{}", name, ending); }
};
constexpr FrameFile gbuffer_file{"gbuffer", "exr", "what the eye sees: position, normal, mesh, triangle"};
constexpr FrameFile mask_file{"mask", "exr", "the technique's visibility, a channel LIGHT.V each"};
constexpr FrameFile reference_file{"reference", "exr", "what is true, LIGHT.V, and the class of each pixel, LIGHT.class"};
constexpr FrameFile error_file{"error", "exr", "mask - reference at pixels of class T, 0 elsewhere, LIGHT.V"};
constexpr FrameFile shaded_file{"shaded", "png", "the scene in the light of the mask, sRGB"};
constexpr FrameFile true_file{"shaded_reference", "png", "the scene in the light of the reference, sRGB"};
constexpr FrameFile frame_files[] = {gbuffer_file, mask_file, reference_file, error_file, shaded_file, true_file};

/// Named channels of one EXR; others own their values.
struct Channels {
  std::vector<std::string> names;
  std::vector<std::span<const float>> values;
  void add(const std::string& name, std::span<const float> value) {
    names.push_back(name);
    values.push_back(value);
  }
};

/// A word as a shell reads it.
std::string quoted(const std::string& word) {
  const auto is_plain = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) || std::string_view("_-./%").find(c) < 5;
  };
  if (std::ranges::all_of(word, is_plain)) return word;
  std::string text = "'";
  for (const char c : word) text += c == '\'' ? "'\\''" : std::string(1, c);
  return text + "'";
}

/// A suite of the one row that the options name.
Suite sequence_suite(const ExportOptions& options) {
  const bool is_still = options.time.seconds.has_value();
  if (options.technique.empty()) throw Error("--sequence needs --technique, whose masks the frames have");
  if (options.path.empty() && (is_still || options.time.animation.empty()))
    throw Error(
        "--sequence needs a motion: --path names one of camera or light, such as {}, --animation one of a scene that moves",
        built_in_paths[0]);
  if (!options.path.empty() && !is_still && !options.time.animation.empty())
    throw Error("--path {} and --animation {} are two motions; a sequence follows one", options.path, options.time.animation);
  SuiteOptions row;
  row.scenes = {options.scene};
  row.techniques = {options.technique};
  row.lights = options.lights;
  row.views = listed(options.view);
  row.paths = listed(options.path);
  row.animations = listed(options.time.animation);
  if (is_still) row.times = {*options.time.seconds};
  row.frames = options.frames;
  row.frame_rate = options.frame_rate;
  row.start = options.start;
  row.size = options.size;
  row.truth = options.truth;
  row.timeout = options.timeout;
  Suite suite = make_suite(row, "export --sequence");
  suite.name = "sequence";
  if (const std::size_t count = suite.groups.front().contenders.size(); count != 1)
    throw Error("--technique {} is a sweep of {}; a sequence is of one", options.technique, count);
  return suite;
}

/// The job of that row. Without --light it is that of the scene's first light.
Job sequence_job(const ExportOptions& options, const Suite& suite, SceneLibrary& library, const WorkerOptions& worker) {
  const SceneLibrary::Entry& entry = library.get(suite.groups.front().scenes.front());
  if (!entry.scene) throw Error("{}", entry.missing);
  std::vector<Job> jobs = expand_jobs(suite, library, worker).jobs;
  if (options.lights.empty()) {
    const std::string first = jobs.front().light;
    std::erase_if(jobs, [&](const Job& job) { return job.light != first; });
  }
  if (jobs.size() != 1) {
    std::vector<std::string> titles;
    for (const Job& job : jobs) titles.push_back(job.title());
    throw Error("--sequence is of one row, and the options name {}: {}", jobs.size(), joined(titles, "; "));
  }
  return jobs.front();
}

void refuse_files(const fs::path& out) {
  std::error_code ignored;
  if (fs::is_directory(out, ignored) && !fs::is_empty(out, ignored))
    throw Error("output folder {} has files already: frames of two sequences would lie side by side", out.string());
}

std::string_view moved_thing(Path::Moves moves) {
  return moves == Path::Moves::camera ? "camera" : moves == Path::Moves::light ? "light" : "geometry";
}

/// What pictures of the row show: its masks, or the references; at pixels that are not tested the references in both, for no
/// mask is judged there.
enum class PictureOf { masks, references };
MeasuredRow shown_row(const MeasuredRow& row, const Scene& scene, PictureOf what) {
  MeasuredRow shown;
  for (const MeasuredLight& light : row.lights) {
    shown.lights.push_back({light.light, light.answer});
    const Evidence evidence = light.answer.evidence();
    std::vector<float>& mask = shown.lights.back().answer.mask;
    for (std::size_t i = 0; i < mask.size(); ++i)
      if (what == PictureOf::references || evidence.classes[i] != PixelClass::T) mask[i] = evidence.reference[i];
  }
  put_together(shown, scene);
  return shown;
}

/// Of a row's first frame, for all of it: an exposure of each frame's own would be one more thing that flickers.
double exposure_of_row(const Scene& scene, const MeasuredRow& row) {
  if (row.together) return exposure_of(scene, row.gbuffer(), row.together->received);
  return exposure_of(scene, row.gbuffer(), received_light(row.gbuffer(), row.lights.front().light));
}

/// Makes the frames of a row, one after the other by one worker, in a folder that appears when all are there.
class Sequence {
 public:
  Sequence(const ExportOptions& options, const Suite& suite, const Job& job, const Scene& scene, const WorkerOptions& worker)
      : options_(options),
        truth_(suite.truth),
        job_(job),
        about_(registry().technique(job.contender.technique).about),
        folder_(options.out),
        run_(scene, {.cache = cache_root() / "frames",
                     .scratch = scratch_.path(),
                     .target = suite.target,
                     .timeout = suite.timeout,
                     .watch = shown_on(progress_, job.scene)}),
        worker_(run_, job.contender.technique, job.contender.settings, worker),
        first_(first_frame(job, run_.scene)) {
    worker_.begin_load();
    worker_.end_load();
  }

  /// A fresh worker remembers nothing, and each frame follows the one before: so a technique that remembers sees the sequence.
  void make() {
    for (RowFrame frame = first_; frame.number < frame.count(); ++frame.number) {
      at_frame(frame.number, [&] { add(frame); });
      if (frame.number == 0) progress_.expect(frame.count());  // a row that is refused has no progress
      progress_.step(fmt::format("{} of {} frames", frame.number + 1, frame.count()));
      progress_.advance(1);
    }
    write_file(folder_.path / "sequence.json", json_text(facts(), 1) + "\n");
    folder_.publish();
  }

  /// For the terminal.
  std::string summary() const {
    return fmt::format(
        "{} frames, {} a second. ColorVideoVDP, which is not part of this program, compares the PNG files:\n{}\n"
        "Its score means nothing without its version and the display, which it prints: give both beside each number.\n",
        first_.count(), first_.path->frame_rate, comparison());
  }

 private:
  /// The command by which ColorVideoVDP compares the pictures.
  std::string comparison() const {
    const auto series = [&](const FrameFile& of) { return quoted((options_.out / of.pattern()).string()); };
    return fmt::format("cvvdp --test {} --ref {} --fps {} --display standard_4k", series(shaded_file), series(true_file),
                       first_.path->frame_rate);
  }

  void add(const RowFrame& frame) {
    const Support support = worker_.go(frame, truth_);
    if (!support)
      throw Error("{} does not support {} {} at frame {}: {}", job_.contender.name(), job_.scene, job_.light, frame.number,
                  support.why());
    if (support.kind() == Support::Kind::approximate && !std::exchange(is_noted_, true))
      print_notice("note: {} at frame {}: {}\n", job_.light, frame.number, support.why());
    MeasuredRow row;
    std::vector<Answer> answers = worker_.answers(nullptr);
    std::size_t k = 0;
    for (Light& light : run_.lights(frame)) {
      answers[k].estimates = about_.estimates;
      row.lights.push_back({std::move(light), std::move(answers[k++])});
    }
    put_together(row, run_.scene);
    if (frame.number == 0) exposure_ = static_cast<float>(exposure_of_row(run_.scene, row));
    for (MeasuredLight& light : row.lights) light.answer.gbuffer.view.exposure = exposure_;
    write_masks(frame.number, row);
    const auto write = [&](const FrameFile& of, PictureOf what) {
      write_png(file(of, frame.number), shade(run_.scene, shown_row(row, run_.scene, what)));
    };
    write(shaded_file, PictureOf::masks);
    write(true_file, PictureOf::references);
    frames_.push_back(frame_facts(frame, row));
  }

  fs::path file(const FrameFile& of, int frame) const { return folder_.path / of.of(frame); }

  void write_masks(int frame, const MeasuredRow& row) {
    write_gbuffer_exr(file(gbuffer_file, frame), row.gbuffer());
    Channels masks, references, errors;
    std::vector<std::vector<float>> made;  // that channels look at
    made.reserve(2 * row.lights.size());
    for (const MeasuredLight& light : row.lights) {
      const Evidence evidence = light.answer.evidence();
      std::vector<float>&classes = made.emplace_back(), &error = made.emplace_back();
      for (std::size_t i = 0; i < evidence.mask.size(); ++i) {
        classes.push_back(static_cast<float>(evidence.classes[i]));
        error.push_back(evidence.classes[i] == PixelClass::T ? evidence.mask[i] - evidence.reference[i] : 0);
      }
      const std::string channel = light.light.name + ".V";
      masks.add(channel, evidence.mask);
      references.add(channel, evidence.reference);
      references.add(light.light.name + ".class", classes);
      errors.add(channel, error);
    }
    const auto write = [&](const FrameFile& of, const Channels& channels) {
      write_exr(file(of, frame), first_.width, first_.height, channels.names, channels.values);
    };
    write(mask_file, masks);
    write(reference_file, references);
    write(error_file, errors);
  }

  Json frame_facts(const RowFrame& frame, const MeasuredRow& row) {
    const std::optional<double> error = measure_metric(Scoring(row.evidence(run_.scene)), "error");
    Json json = json_object({{"frame", frame.number},
                             {"seconds", frame.path->start + frame.number / frame.path->frame_rate},
                             {"view", scene_json(run_.key(frame, truth_).view)},
                             {"lights", Json::array()},
                             {"error", error ? Json(*error) : Json()},
                             {"files", json_object()}});
    for (const MeasuredLight& light : row.lights) json["lights"].push_back(scene_json(light.light));
    for (const FrameFile& of : frame_files) json["files"][std::string(of.name)] = of.of(frame.number);
    return json;
  }

  Json facts() const {
    const Path& path = *first_.path;
    Json json = json_object({{"scene", job_.scene},
                             {"light", job_.light},
                             {"view", job_.view},
                             {"path", path.name},
                             {"moves", moved_thing(path.moves)},
                             {"technique", job_.contender.technique},
                             {"settings", job_.contender.settings},
                             {"truth", name(truth_)},
                             {"width", first_.width},
                             {"height", first_.height},
                             {"frame_count", path.frame_count},
                             {"frame_rate", path.frame_rate},
                             {"start", path.start},
                             {"exposure", number_json(exposure_)},
                             {"program", build_text()},
                             {"classes", json_object()},
                             {"files", json_object()},
                             {"color_video_vdp", comparison()},
                             {"frames", frames_}});
    if (Json plugin = plugin_facts(job_.contender.technique, job_.contender.settings); !plugin.is_null())
      json["plugin"] = std::move(plugin);
    for (std::size_t c = 0; c < class_infos().size(); ++c) json["classes"][std::string(class_infos()[c].letter)] = c;
    for (const FrameFile& of : frame_files) json["files"][std::string(of.name)] = of.pattern();
    return json;
  }

  const ExportOptions& options_;
  const Truth truth_;
  const Job& job_;
  const About& about_;
  const StagedFolder folder_;
  const ScratchFolder scratch_ = ScratchFolder::temporary("gnomon-sequence");
  Progress progress_;
  SceneRun run_;
  ContenderWorker worker_;
  const RowFrame first_;
  float exposure_ = 0;
  bool is_noted_ = false;
  Json frames_ = Json::array();
};

}  // namespace

void export_sequence(const ExportOptions& options, const WorkerOptions& worker) {
  const Suite suite = sequence_suite(options);
  refuse_files(options.out);
  SceneLibrary library;
  const Job job = sequence_job(options, suite, library, worker);
  const Scene& scene = *library.get(job.scene).scene;
  for (const std::string& note : scene.notes) print_notice("note: {}\n", note);
  const std::string summary = [&] {
    try {
      Sequence sequence(options, suite, job, scene, worker);
      sequence.make();
      return sequence.summary();
    } catch (const WorkerFailure& failure) {
      throw WorkerFailure(fmt::format("{}: {}", job.contender.name(), failure.what()));
    }
  }();  // its progress is gone from the terminal

  const std::string out = options.out.string();
  fmt::print("{}/{:<30}frame rate, view, lights, error and files of each frame\n", out, "sequence.json");
  for (const FrameFile& of : frame_files) fmt::print("{}/{:<30}{}\n", out, of.pattern(), of.sentence);
  fmt::print("\n{}", summary);
}

}  // namespace gnomon::app
