#include "measure/worker/worker_server.h"

#include <gnomon/kit/pictures/surface_detail.h>
#include <gnomon/registry.h>
#include <tbb/global_control.h>

#include "measure/cause/causes.h"
#include "measure/picture/detail_export.h"
#include "measure/process_memory.h"
#include "measure/program/elsewhere.h"
#include "measure/worker/machine_context.h"
#include "measure/worker/technique_frame.h"

namespace gnomon {

namespace {

/// Serves requests for one technique, or makes references.
class TechniqueServer {
 public:
  TechniqueServer() {
    answers_.on<ProtocolRequest>([](const ProtocolRequest&) {
      return ProtocolRequest::Reply{.protocol = worker_protocol, .context = program_context()};
    });
    answers_.on<OpenRequest>([this](const auto& request) {
      if (!traces_.is_empty()) throw Error("a worker that traces serves no technique");
      return frame_.open(registry().technique(request.technique), request);
    });
    answers_.on<TraceRequest>([this](const auto& request) {
      if (frame_.is_open()) throw Error("a worker that serves a technique does not trace");
      return traces_.make(request);
    });
    answer_roll(answers_);
    on<SetRequest>([this](const auto& request) { return frame_.set(request.settings); });
    on<GoRequest>([this](const auto& request) { return frame_.go_to(request); });
    on<TimeRequest>([this](const auto& request) { return frame_.time_stage(request); });
    on<FloorRequest>([this](const auto& request) { return frame_.floor(request.times); });
    on<CardRequest>([this](const auto&) { return CardRequest::Reply{frame_.device().card()}; });
    on<BringUpRequest>([this](const auto& request) {
      frame_.bring_up(request.stage);
      return Done();
    });
    on<AnswerRequest>([this](const auto& request) { return answer(request.mask); });
    on<MaskRequest>([this](const auto& request) { return write_mask(request.mask); });
    on<ExplainRequest>([this](const auto& request) { return explain(request); });
    on<ErrorTermsRequest>([this](const auto& request) { return error_terms(request); });
    on<DepthCurveRequest>([this](const auto& request) { return depth_curve(request); });
    on<PartsRequest>([this](const auto& request) { return parts(request); });
    on<DebugRequest>([this](const auto& request) { return debug(request); });
    on<GlobalRequest>([this](const auto& request) { return global(request); });
    on<DetailRequest>([this](const auto& request) { return detail(request); });
  }

  Json handle(const Json& request) const { return answers_(request); }

 private:
  /// Of a request that requires a technique.
  template <class Request, class Answer>
  void on(Answer answer) {
    answers_.on<Request>([this, answer](const Request& request) {
      if (!frame_.is_open()) throw Error("a worker cannot {} before it has a technique", Request::verb);
      return answer(request);
    });
  }

  Done write_mask(const std::string& path) {
    frame_.bring_up(Stage::resolve);
    std::vector<float> all;
    for (VisibilityMask& mask : frame_.masks()) all.insert(all.end(), mask.read().begin(), mask.read().end());
    write_file(path, std::as_bytes(std::span(all)));
    return {};
  }

  AnswerRequest::Reply answer(const std::string& path) {
    write_mask(path);
    const auto peak = static_cast<std::uint64_t>(peak_bytes());  // first: counting may build or draw once more
    AnswerRequest::Reply reply{.counts = frame_.objects().counts(), .peak_bytes = peak};
    reply.gl = frame_.device_inputs();
    for (Count& count : reply.counts)
      if (reply.gl && count.name == "bytes") count.value += static_cast<double>(*reply.gl->geometry_bytes);
    for (const Count& c : reply.counts)
      if (!std::isfinite(c.value)) throw Error("count {} is {}", c.name, c.value);
    if (const WorksElsewhere* const there = elsewhere(frame_.objects()[0])) reply.maker = there->maker();
    return reply;
  }

  /// Writes the technique's explanations of the listed pixels (uint32 indices).
  ExplainRequest::Reply explain(const ExplainRequest& request) {
    Technique* const technique = frame_.object_of(request.light);
    frame_.bring_up(Stage::resolve);
    const auto file = MappedFile::open(request.pixels);
    const std::span pixels(reinterpret_cast<const std::uint32_t*>(file->bytes().data()),
                           file->bytes().size() / sizeof(std::uint32_t));
    for (const std::uint32_t pixel : pixels) frame_.require_pixel(pixel);
    const Explanation not_covered{.covered = false, .taps = {}, .shifted = {}, .element = {}};
    const auto explanations =
        technique ? explain_all(*technique, pixels) : std::vector<std::optional<Explanation>>(pixels.size(), not_covered);
    if (explanations.size() != pixels.size())
      throw Error("{} explanations came for {} pixels", explanations.size(), pixels.size());
    write_file(request.out, explanation_bytes(explanations));
    return {std::ranges::any_of(explanations, [](const auto& why) { return why.has_value(); })};
  }

  ErrorTermsRequest::Reply error_terms(const ErrorTermsRequest& request) {
    Technique* const technique = frame_.object_of(request.light);
    frame_.bring_up(Stage::resolve);
    if (!technique) return {};
    const auto file = MappedFile::open(request.exact);
    const std::size_t pixels = frame_.gbuffer().size();
    if (file->bytes().size() != pixels * sizeof(float))
      throw Error("exact shares have {} bytes; {} are required", file->bytes().size(), pixels * sizeof(float));
    const std::span exact(reinterpret_cast<const float*>(file->bytes().data()), pixels);
    ErrorTermsRequest::Reply reply;
    std::vector<float> all;
    for (const ErrorTerm& term : technique->error_terms(exact)) {
      if (term.values.size() != pixels)
        throw Error("error term {} has {} values; {} are required", term.cause, term.values.size(), pixels);
      reply.causes.emplace_back(term.cause);
      all.insert(all.end(), term.values.begin(), term.values.end());
    }
    write_file(request.out, std::as_bytes(std::span(all)));
    return reply;
  }

  DepthCurveRequest::Reply depth_curve(const DepthCurveRequest& request) {
    frame_.bring_up(Stage::resolve);
    frame_.require_pixel(request.pixel);
    const Technique* const technique = frame_.object_of(request.light);
    return {technique ? technique->depth_curve(request.pixel) : std::nullopt};
  }

  PartsRequest::Reply parts(const PartsRequest& request) {
    frame_.bring_up(Stage::resolve);
    const Technique* const technique = frame_.object_of(request.light);
    const std::vector<std::uint32_t> parts = technique ? technique->image_parts() : std::vector<std::uint32_t>();
    if (parts.empty()) return {};
    write_file(request.out, std::as_bytes(std::span(parts)));
    return {true};
  }

  Done debug(const DebugRequest& request) {
    frame_.bring_up(Stage::resolve);
    const std::vector<float> rgb = must_have(frame_.object_of(request.light)).draw_debug(request.layer);
    write_file(request.out, std::as_bytes(std::span(rgb)));
    return {};
  }

  GlobalRequest::Reply global(const GlobalRequest& request) {
    frame_.bring_up(Stage::resolve);
    const std::optional<std::vector<float>> rgb = must_have(frame_.object_of(request.light)).global_picture();
    if (rgb) write_file(request.out, std::as_bytes(std::span(*rgb)));
    return {rgb.has_value()};
  }

  Done detail(const DetailRequest& request) {
    frame_.bring_up(Stage::relight);
    const std::optional<SurfaceDetail> detail = must_have(frame_.object_of(request.light)).surface_detail();
    if (!detail) throw Error("{} gave no surface detail, though a fresh one does", frame_.entry().id);
    check_detail(frame_.scene(), *detail);
    write_file(request.out, detail_bytes(*detail));
    return {};
  }

  static Technique& must_have(Technique* object) {
    if (!object) throw Error("the technique does not support this light");
    return *object;
  }

  Answers answers_;
  TechniqueFrame frame_;
  RequestedTraces traces_;
};

}  // namespace

int worker_main(int socket, int threads) {
  std::optional<tbb::global_control> limit;
  if (threads > 0) limit.emplace(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
  // Leaked on purpose: the process ends by being killed, and a technique's destructor is no part of a measurement.
  TechniqueServer& server = *new TechniqueServer;
  answer_lines(socket, [&](const Json& request) { return server.handle(request); });
}

}  // namespace gnomon
