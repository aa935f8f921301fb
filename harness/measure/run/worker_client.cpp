#include "measure/run/worker_client.h"

#include <gnomon/error.h>
#include <gnomon/kit/progress.h>
#include <gnomon/registry.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "measure/cause/causes.h"
#include "measure/picture/detail_export.h"
#include "measure/run/worker_words.h"
#include "measure/scene/blob.h"
#include "measure/score/score.h"

namespace gnomon {

namespace fs = std::filesystem;

namespace {

/// Starting a process, loading the scene and finding a device is the harness's own work: a short timeout is not meant for it.
constexpr double least_load_seconds = 60;

constexpr Stage all_stages[] = {Stage::setup, Stage::build, Stage::relight, Stage::resolve};

WorkerOptions with_program_folder(WorkerOptions options, const fs::path& folder) {
  options.program_folder = folder.string();
  return options;
}

}  // namespace

std::vector<std::byte> light_and_view_bytes(const std::vector<Light>& lights, const View& view) {
  Scene scene;
  scene.lights = lights;
  scene.views = {view};
  return scene_bytes(scene);
}

/// A file that holds the number 0.
static fs::path made_count(const fs::path& file) {
  SharedCount::make(file);
  return file;
}

WorkerClient::WorkerClient(const WorkerOptions& options, fs::path files, double timeout_seconds)
    : files_(std::move(files)),
      program_files_(
          ScratchFolder::in(files_.parent_path(), files_.filename().string() + ".program")),  // other workers live on
      progress_(made_count(file("progress"))),
      process_(with_program_folder(options, program_files_.path())),
      timeout_seconds_(timeout_seconds),
      takes_iterations_(options.takes_iterations) {}

fs::path WorkerClient::file(const char* ending) const { return fs::path(files_) += fmt::format(".{}", ending); }

/// What `read` makes of the answer and of the files that came with it; what it cannot make anything of is the worker's failure.
template <class Read>
auto WorkerClient::receive(double timeout_seconds, const Read& read) {
  const Json reply = process_.receive(timeout_seconds);
  try {
    return read(reply);
  } catch (const Json::exception& problem) {
    process_.fail(fmt::format("answered {} with something else than was asked: {}", process_.doing(), complaint(problem)));
  } catch (const Error& problem) {
    process_.fail(problem.what());
  }
}

template <class Read>
auto WorkerClient::ask(const Json& request, const Read& read) {
  process_.send(request);
  return receive(timeout_seconds_, read);
}

void WorkerClient::begin_load(const LoadRequest& request) {
  // It would not be otherwise now, and might take its time.
  if (const TechniqueEntry* const entry = registry().find_technique(request.technique); entry && !entry->broken.empty())
    process_.fail(entry->broken);
  process_.send(json_object({{"do", "open"},
                             {"scene", request.scene_file.string()},
                             {"technique", request.technique},
                             {"settings", request.settings},
                             {"progress", file("progress").string()}}));
}

double WorkerClient::progress() const { return static_cast<double>(progress_.value()) / static_cast<double>(progress_steps); }

void WorkerClient::end_load() {
  fresh_count_ = 0;
  receive(std::max(timeout_seconds_, least_load_seconds), [&](const Json& reply) {
    if (const Json& gl = reply.at("gl"); !gl.is_null())
      gl_ = WorkerGl{gl.at("renderer"), gl.at("version"), gl.value("subpixel_bits", usual_subpixel_bits),
                     gl.value("card", Json())};
  });
}

void WorkerClient::set(const std::string& settings) {
  ask(json_object({{"do", "set"}, {"settings", settings}}), [&](const Json& reply) { fresh_count_ = reply.at("fresh"); });
}

FrameReply WorkerClient::frame(const FrameRequest& request) {
  Json question = json_object({{"do", "frame"},
                               {"gbuffer", request.gbuffer_file.string()},
                               {"width", request.width},
                               {"height", request.height},
                               {"truth", name(request.truth)}});
  if (const auto* const seen = std::get_if<SceneLightAndView>(&request.seen)) {
    question.update(json_object({{"view", seen->view}, {"path", seen->path}, {"frame", seen->path_frame}}));
    light_count_ = seen->lights.size();
    if (light_count_ == 1)
      question["light"] = seen->lights[0];
    else
      question["lights"] = seen->lights;
  } else {
    const fs::path light_and_view = file("light_and_view");
    const auto& [lights, view] = std::get<FreeLightAndView>(request.seen);
    light_count_ = lights.size();
    write_file(light_and_view, light_and_view_bytes(lights, view));
    question["stand"] = light_and_view.string();
  }
  pixel_count_ = static_cast<std::size_t>(request.width) * request.height;
  return ask(question, [&](const Json& reply) {
    fresh_count_ = reply.at("fresh");
    FrameReply result{
        .support = support_from(reply), .upload = {}, .lights = {}, .floor = reply.value("floor", ""), .shares = {}};
    if (light_count_ > 1) {
      for (const Json& light : reply.at("lights")) result.lights.push_back(support_from(light));
      if (result.lights.size() != light_count_)
        throw Error("support of {} lights came for {}", result.lights.size(), light_count_);
      if (reply.contains("shares")) result.shares = reply.at("shares").get<bool>();
    }
    if (reply.contains("input_bytes")) result.upload = {reply.at("input_bytes"), reply.at("upload_ms")};
    return result;
  });
}

double WorkerClient::time(Stage stage, int iterations) {
  double sum = 0;
  other_clocks_ = {.device = 0, .harness = 0};
  progress_.value() = 0;
  const auto add = [](std::optional<double>& sum, const Json& reply, const char* key) {
    sum = sum && reply.contains(key) ? std::optional(*sum + reply.at(key).get<double>()) : std::nullopt;
  };
  for (int done = 0; done < iterations;) {
    const int wanted = takes_iterations_ ? iterations - done : 1;
    Json request = json_object({{"do", "time"}, {"stage", name(stage)}});
    if (wanted > 1) request["iterations"] = wanted;
    process_.send(request);
    const double patience = timeout_seconds_ + (wanted > 1 ? longest_portion_seconds : 0);
    done += receive(patience, [&](const Json& reply) {
      fresh_count_ = static_cast<int>(stage) + 1;
      sum += reply.at("ms").get<double>();
      add(other_clocks_.device, reply, "device_ms");
      add(other_clocks_.harness, reply, "harness_ms");
      const double count = reply.value("iterations", 1.0);
      if (!(count >= 1 && count <= wanted)) throw Error("{} iterations of {} came for {}", count, name(stage), wanted);
      return static_cast<int>(count);
    });
  }
  return sum;
}

double WorkerClient::time_floor(int times) {
  return ask(json_object({{"do", "floor"}, {"times", times}}), [&](const Json& reply) {
    other_clocks_ = {.device = {}, .harness = {}};
    if (reply.contains("device_ms")) other_clocks_.device = reply.at("device_ms").get<double>();
    return reply.at("ms").get<double>();
  });
}

Json WorkerClient::card() {
  if (!gl_ || gl_->card.is_null()) return {};
  return ask(json_object({{"do", "card"}}), [](const Json& reply) { return reply.at("card"); });
}

void WorkerClient::bring_up(Stage last) {
  // One request for each stage, so that a failure names the stage that it happened in.
  for (const Stage stage : all_stages) {
    if (stage > last) return;
    if (fresh_count_ > static_cast<int>(stage)) continue;
    ask(json_object({{"do", "bring_up"}, {"stage", name(stage)}}),
        [&](const Json&) { fresh_count_ = static_cast<int>(stage) + 1; });
  }
}

std::vector<float> WorkerClient::mask() {
  bring_up(Stage::resolve);
  return ask(json_object({{"do", "mask"}, {"mask", file("mask").string()}}),
             [&](const Json&) { return read_mask_file(file("mask"), pixel_count_, light_count_); });
}

MaskReply WorkerClient::answer() {
  bring_up(Stage::resolve);
  return ask(json_object({{"do", "answer"}, {"mask", file("mask").string()}}), [&](const Json& reply) {
    MaskReply result{read_mask_file(file("mask"), pixel_count_, light_count_), {}, 0, reply.value("maker", "")};
    for (const Json& count : reply.at("counts"))
      result.counts.push_back({count.at("name"), count.at("value"), count.at("unit")});
    const double peak_bytes = reply.at("peak_bytes");
    if (!(peak_bytes >= 0 && peak_bytes < 1e18)) throw Error("a peak of {} bytes is none", peak_bytes);
    result.peak_bytes = static_cast<std::uint64_t>(peak_bytes);
    return result;
  });
}

std::vector<std::optional<Explanation>> WorkerClient::explain(std::span<const std::uint32_t> pixels, std::size_t light) {
  constexpr std::size_t portion = 4096;  // pixels of one request: a filter has hundreds of taps a pixel
  bring_up(Stage::resolve);
  const fs::path asked = file("pixels"), answered = file("explanations");
  std::vector<std::optional<Explanation>> result;
  while (result.size() < pixels.size()) {
    const auto some = pixels.subspan(result.size(), std::min(portion, pixels.size() - result.size()));
    write_file(asked, std::as_bytes(some));
    const Json request =
        json_object({{"do", "explain"}, {"pixels", asked.string()}, {"out", answered.string()}, {"light", light}});
    const auto explanations = ask(request, [&](const Json& reply) {
      if (!reply.at("explained").get<bool>()) return std::vector<std::optional<Explanation>>();
      auto known = explanations_from_bytes(MappedFile::open(answered)->bytes());
      if (known.size() != some.size()) throw Error("{} explanations came for {} pixels", known.size(), some.size());
      return known;
    });
    if (explanations.empty()) {  // a technique without samples to show has none for any pixel
      result.resize(pixels.size());
      break;
    }
    result.insert(result.end(), explanations.begin(), explanations.end());
  }
  return result;
}

namespace {

/// Three floats a pixel from a file that the worker wrote. `what` they are, for the Error where their number is another.
std::vector<float> read_rgb(const fs::path& file, std::size_t pixels, const std::string& what) {
  const auto written = MappedFile::open(file);
  std::vector<float> rgb(3 * pixels);
  if (written->bytes().size() != rgb.size() * sizeof(float))
    throw Error("{} has {} bytes; {} are wanted", what, written->bytes().size(), rgb.size() * sizeof(float));
  std::memcpy(rgb.data(), written->bytes().data(), written->bytes().size());
  return rgb;
}

}  // namespace

std::vector<float> WorkerClient::debug_layer(const std::string& layer, std::size_t light) {
  bring_up(Stage::resolve);
  const fs::path answered = file("layer");
  const Json request = json_object({{"do", "debug"}, {"layer", layer}, {"out", answered.string()}, {"light", light}});
  return ask(request, [&](const Json&) { return read_rgb(answered, pixel_count_, "debug layer " + layer); });
}

std::optional<std::vector<float>> WorkerClient::global_picture(std::size_t light) {
  bring_up(Stage::resolve);
  const fs::path answered = file("global");
  const Json request = json_object({{"do", "global"}, {"out", answered.string()}, {"light", light}});
  return ask(request, [&](const Json& reply) -> std::optional<std::vector<float>> {
    if (!reply.at("has_picture").get<bool>()) return std::nullopt;
    std::vector<float> rgb = read_rgb(answered, pixel_count_, "the global picture");
    for (std::size_t k = 0; k < rgb.size(); ++k)
      if (!(rgb[k] >= 0 && std::isfinite(rgb[k])))
        throw Error("the global picture's value {} at pixel {} is no radiance", rgb[k], k / 3);
    return rgb;
  });
}

SurfaceDetail WorkerClient::surface_detail(std::size_t light) {
  bring_up(Stage::relight);
  return ask(json_object({{"do", "detail"}, {"out", file("detail").string()}, {"light", light}}),
             [&](const Json&) { return detail_from_bytes(MappedFile::open(file("detail"))->bytes()); });
}

ProgramFacts ask_program(const WorkerOptions& options) {
  if (access(options.program.c_str(), X_OK) != 0)
    throw Error("program {} cannot be started: {}", options.program, std::strerror(errno));
  constexpr double patience = 20;  // seconds to start; a program that is no gnomon may wait for ever
  Json answer;
  try {
    WorkerProcess process(options);
    process.send(json_object({{"do", "protocol"}}));
    answer = process.receive(patience);
  } catch (const WorkerFailure& failure) {
    throw Error("program {} cannot work for this one, it is no gnomon or one of another version: it {}", options.program,
                failure.what());
  }
  const Json protocol = answer.value("protocol", Json());
  if (protocol != worker_protocol)
    throw Error("program {} speaks worker protocol {}, this one {}: build both from versions that agree", options.program,
                json_text(protocol), worker_protocol);
  return {.context = answer.value("context", Json::object()), .takes_iterations = answer.value("takes_iterations", false)};
}

}  // namespace gnomon
