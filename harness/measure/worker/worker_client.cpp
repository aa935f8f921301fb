#include "measure/worker/worker_client.h"

#include <gnomon/kit/progress.h>
#include <gnomon/registry.h>
#include <unistd.h>

#include <cstring>

#include "measure/picture/detail_export.h"
#include "measure/score/score.h"

namespace gnomon {

namespace fs = std::filesystem;

namespace {

/// Starting a process, loading the scene and finding a device is the harness's own work: a short timeout does not apply to it.
constexpr double least_load_seconds = 60;

WorkerOptions with_program_folder(WorkerOptions options, const fs::path& folder) {
  options.program_folder = folder.string();
  return options;
}

/// So many numbers from a file that the worker wrote. `what` they are, for the Error where there are more or fewer.
template <class Number>
std::vector<Number> read_numbers(const fs::path& file, std::size_t count, const std::string& what) {
  const auto written = MappedFile::copy(file);
  std::vector<Number> numbers(count);
  if (written->bytes().size() != count * sizeof(Number))
    throw Error("{} has {} bytes; {} are required", what, written->bytes().size(), count * sizeof(Number));
  std::memcpy(numbers.data(), written->bytes().data(), written->bytes().size());
  return numbers;
}

}  // namespace

std::vector<std::byte> light_and_view_bytes(const std::vector<Light>& lights, const View& view) {
  Scene scene;
  scene.lights = lights;
  scene.views = {view};
  return scene_bytes(scene);
}

WorkerClient::WorkerClient(const WorkerOptions& options, fs::path files, double timeout_seconds)
    : files_(std::move(files)),
      program_files_(ScratchFolder::in(fs::absolute(files_).parent_path(),
                                       files_.filename().string() + ".program")),  // other workers live on
      process_(with_program_folder(options, program_files_.path())),
      timeout_seconds_(timeout_seconds) {}

fs::path WorkerClient::file(const char* ending) const { return fs::path(files_) += fmt::format(".{}", ending); }

/// The result of `read`, which reads files that came with a reply; its Error is the worker's failure.
template <class Read>
auto WorkerClient::checked(const Read& read) {
  try {
    return read();
  } catch (const Error& problem) {
    process_.fail(problem.what());
  }
}

void WorkerClient::begin_load(const TechniqueOnScene& what) {
  // It would fail again, and might take long.
  if (const TechniqueEntry* const entry = registry().find_technique(what.technique); entry && !entry->broken.empty())
    process_.fail(entry->broken);
  process_.send(request_json(OpenRequest{.scene = what.scene_file.string(),
                                         .technique = what.technique,
                                         .settings = what.settings,
                                         .progress = progress_.place()}));
}

double WorkerClient::progress() const { return static_cast<double>(progress_.value()) / static_cast<double>(progress_steps); }

void WorkerClient::end_load() {
  fresh_count_ = 0;
  gl_ = process_.receive_reply<OpenRequest>(std::max(timeout_seconds_, least_load_seconds)).gl;
}

void WorkerClient::set(const std::string& settings) {
  fresh_count_ = process_.ask(SetRequest{.settings = settings}, timeout_seconds_).fresh;
}

FrameReply WorkerClient::frame(const FrameRequest& request) {
  GoRequest question{
      .gbuffer = request.gbuffer_file.string(), .width = request.width, .height = request.height, .truth = request.truth};
  if (const auto* const seen = std::get_if<SceneLightAndView>(&request.seen)) {
    question.lights = seen->lights;
    question.view = seen->view;
    question.path = seen->path;
    question.frame = seen->path_frame;
    light_count_ = seen->lights.size();
  } else {
    const auto& [lights, view] = std::get<FreeLightAndView>(request.seen);
    light_count_ = lights.size();
    write_file(file("light_and_view"), light_and_view_bytes(lights, view));
    question.light_and_view = file("light_and_view").string();
  }
  question.pose = request.pose;
  question.begins_sequence = request.begins_sequence;
  pixel_count_ = static_cast<std::size_t>(request.width) * request.height;
  // The first pose of a row finds how far its meshes reach in all its frames.
  const double patience = timeout_seconds_ * (request.pose ? 1 + request.pose->at.frames / 100.0 : 1);
  const GoRequest::Reply reply = process_.ask(question, patience);
  fresh_count_ = reply.fresh;
  FrameReply result{.support = support_of(reply.support), .lights = {}, .floor = reply.floor, .shares = reply.shares};
  for (const SupportReply& light : reply.lights) result.lights.push_back(support_of(light));
  if (result.lights.size() != light_count_)
    process_.fail(fmt::format("support of {} lights came for {}", result.lights.size(), light_count_));
  return result;
}

double WorkerClient::time(Stage stage, int iterations) {
  double sum = 0;
  other_clocks_ = {.device = 0, .harness = 0};
  progress_.value() = 0;
  const auto add = [](std::optional<double>& sum, const std::optional<double>& more) {
    sum = sum && more ? std::optional(*sum + *more) : std::nullopt;
  };
  for (int done = 0; done < iterations;) {
    const int wanted = iterations - done;
    const double patience = timeout_seconds_ + (wanted > 1 ? longest_portion_seconds : 0);
    const TimeRequest::Reply reply = process_.ask(TimeRequest{.stage = stage, .iterations = wanted}, patience);
    fresh_count_ = static_cast<int>(fresh_after(stage)) + 1;
    sum += reply.ms;
    add(other_clocks_.device, reply.device_ms);
    add(other_clocks_.harness, reply.harness_ms);
    if (reply.iterations < 1 || reply.iterations > wanted)
      process_.fail(fmt::format("{} iterations of {} came for {}", reply.iterations, name(stage), wanted));
    done += reply.iterations;
  }
  return sum;
}

double WorkerClient::time_floor(int times) {
  const FloorRequest::Reply reply = process_.ask(FloorRequest{.times = times}, timeout_seconds_);
  other_clocks_ = {.device = reply.device_ms, .harness = {}};
  return reply.ms;
}

std::optional<Json> WorkerClient::card() {
  if (!gl_ || !gl_->card) return std::nullopt;
  return process_.ask(CardRequest{}, timeout_seconds_).card;
}

void WorkerClient::bring_up(Stage last) {
  // One request for each stage, so that a failure names the stage that it happened in.
  for (const Stage stage : all_stages) {
    if (stage > last) return;
    if (fresh_count_ > static_cast<int>(stage)) continue;
    process_.ask(BringUpRequest{.stage = stage}, timeout_seconds_);
    fresh_count_ = static_cast<int>(fresh_after(stage)) + 1;
  }
}

std::vector<float> WorkerClient::read_mask() {
  return checked([&] { return read_mask_file(file("mask"), pixel_count_, light_count_); });
}

std::vector<float> WorkerClient::mask() {
  bring_up(Stage::resolve);
  process_.ask(MaskRequest{.mask = file("mask").string()}, timeout_seconds_);
  return read_mask();
}

MaskReply WorkerClient::answer() {
  bring_up(Stage::resolve);
  AnswerRequest::Reply reply = process_.ask(AnswerRequest{.mask = file("mask").string()}, timeout_seconds_);
  return {read_mask(), std::move(reply.counts), reply.peak_bytes, std::move(reply.maker), reply.gl};
}

std::vector<std::optional<Explanation>> WorkerClient::explain(std::span<const std::uint32_t> pixels, std::size_t light) {
  constexpr std::size_t portion = 4096;  // pixels of one request: a filter has hundreds of taps a pixel
  bring_up(Stage::resolve);
  const fs::path asked = file("pixels"), answered = file("explanations");
  std::vector<std::optional<Explanation>> result;
  while (result.size() < pixels.size()) {
    const auto some = pixels.subspan(result.size(), std::min(portion, pixels.size() - result.size()));
    write_file(asked, std::as_bytes(some));
    const ExplainRequest request{asked.string(), answered.string(), light};
    const bool is_explained = process_.ask(request, timeout_seconds_).explained;
    const auto explanations = checked([&] {
      if (!is_explained) return std::vector<std::optional<Explanation>>();
      auto known = explanations_from_bytes(MappedFile::copy(answered)->bytes());
      if (known.size() != some.size()) throw Error("{} explanations came for {} pixels", known.size(), some.size());
      return known;
    });
    if (explanations.empty()) break;  // a technique without samples to show has none for any pixel
    result.insert(result.end(), explanations.begin(), explanations.end());
  }
  result.resize(pixels.size());
  return result;
}

ErrorParts WorkerClient::error_terms(std::span<const float> exact, std::size_t light) {
  bring_up(Stage::resolve);
  write_file(file("exact"), std::as_bytes(exact));
  ErrorParts parts{
      .causes = process_.ask(ErrorTermsRequest{file("exact").string(), file("terms").string(), light}, timeout_seconds_).causes,
      .values = {}};
  if (parts.causes.empty()) return parts;
  checked([&] {
    const auto written = MappedFile::copy(file("terms"));
    const std::size_t bytes = exact.size_bytes();
    if (written->bytes().size() != bytes * parts.causes.size())
      throw Error("{} error terms have {} bytes; {} are required", parts.causes.size(), written->bytes().size(),
                  bytes * parts.causes.size());
    for (std::size_t k = 0; k < parts.causes.size(); ++k) {
      std::vector<float>& values = parts.values.emplace_back(exact.size());
      std::memcpy(values.data(), written->bytes().data() + k * bytes, bytes);
    }
  });
  return parts;
}

std::optional<DepthCurve> WorkerClient::depth_curve(std::uint32_t pixel, std::size_t light) {
  bring_up(Stage::resolve);
  std::optional<DepthCurve> curve = process_.ask(DepthCurveRequest{pixel, light}, timeout_seconds_).curve;
  if (curve)
    for (const SharesAlong* const one : {&curve->held, &curve->exact})
      if (one->depth.empty() || one->depth.size() != one->share.size())
        process_.fail(fmt::format("a curve of {} shares at {} depths came", one->share.size(), one->depth.size()));
  return curve;
}

std::vector<std::uint32_t> WorkerClient::parts(std::size_t light) {
  bring_up(Stage::resolve);
  if (!process_.ask(PartsRequest{file("parts").string(), light}, timeout_seconds_).has_parts) return {};
  return checked([&] { return read_numbers<std::uint32_t>(file("parts"), pixel_count_, "the list of parts"); });
}

std::vector<float> WorkerClient::debug_layer(const std::string& layer, std::size_t light) {
  bring_up(Stage::resolve);
  process_.ask(DebugRequest{layer, file("layer").string(), light}, timeout_seconds_);
  return checked([&] { return read_numbers<float>(file("layer"), 3 * pixel_count_, "debug layer " + layer); });
}

std::optional<std::vector<float>> WorkerClient::global_picture(std::size_t light) {
  bring_up(Stage::resolve);
  if (!process_.ask(GlobalRequest{file("global").string(), light}, timeout_seconds_).has_picture) return std::nullopt;
  return checked([&] {
    std::vector<float> rgb = read_numbers<float>(file("global"), 3 * pixel_count_, "the global picture");
    for (std::size_t k = 0; k < rgb.size(); ++k)
      if (!(rgb[k] >= 0 && std::isfinite(rgb[k])))
        throw Error("the global picture's value {} at pixel {} is no radiance", rgb[k], k / 3);
    return rgb;
  });
}

SurfaceDetail WorkerClient::surface_detail(std::size_t light) {
  bring_up(Stage::relight);
  process_.ask(DetailRequest{file("detail").string(), light}, timeout_seconds_);
  return checked([&] { return detail_from_bytes(MappedFile::copy(file("detail"))->bytes()); });
}

Json context_of_program(const WorkerOptions& options) {
  if (access(options.program.c_str(), X_OK) != 0)
    throw Error("program {} cannot be started: {}", options.program, std::strerror(errno));
  constexpr double patience = 20;  // seconds to start; a program that is no gnomon may wait forever
  Json answer;
  try {
    WorkerProcess process(options);
    process.send(request_json(ProtocolRequest{}));
    answer = process.receive(patience);
  } catch (const WorkerFailure& failure) {
    throw Error("program {} cannot work for this one, it is no gnomon or one of another version: it {}", options.program,
                failure.what());
  }
  const Json protocol = answer.value("protocol", Json());
  if (protocol != worker_protocol)
    throw Error("program {} speaks worker protocol {}, this one {}: build both from versions that agree", options.program,
                json_text(protocol), worker_protocol);
  return answer.value("context", Json::object());
}

}  // namespace gnomon
