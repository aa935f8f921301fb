#include <gnomon/kit/gl.h>
#include <gnomon/kit/surface_detail.h>
#include <gnomon/registry.h>
#include <tbb/global_control.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>

#include "device/context.h"
#include "measure/cause/causes.h"
#include "measure/picture/detail_export.h"
#include "measure/run/shared_count.h"
#include "measure/run/worker.h"
#include "measure/scene/motion.h"

namespace gnomon {

namespace {

using Clock = std::chrono::steady_clock;

/// Largest resident memory of this process in bytes. Not from getrusage: that figure survives exec, and would be the parent's.
double peak_bytes() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.starts_with("VmHWM:")) return 1024.0 * std::stod(line.substr(6));
  return 0;
}

/// Serves requests for one technique: it has the scene and the frame, and knows which stages are up to date.
class TechniqueServer {
 public:
  Json handle(const Json& request) {
    const std::string what = request.at("do");
    if (what == "protocol") return json_object({{"protocol", worker_protocol}, {"context", machine_context(0)}});
    if (what == "open") return open(request);
    if (what == "trace") return trace(request);
    if (!technique_) throw Error("a worker cannot {} before it has a technique", what);
    if (what == "set") return set(request.at("settings"));
    if (what == "frame") return frame(request);
    if (what == "setup") return time_stage(static_cast<int>(Stage::setup));
    if (what == "time") return time_stage(stage_named(request.at("stage")));
    if (what == "bring_up") return bring_up(stage_named(request.at("stage")));
    if (what == "answer") return answer(request.at("mask"));
    if (what == "mask") return write_mask(request.at("mask"));
    if (what == "explain") return explain(request.at("pixels"), request.at("out"));
    if (what == "debug") return debug(request.at("layer"), request.at("out"));
    if (what == "detail") return detail(request.at("out"));
    throw Error("a worker cannot {}", what);
  }

 private:
  Json open(const Json& request) {
    if (tracer_) throw Error("a worker that traces serves no technique");
    scene_ = scene_in(request.at("scene"));
    entry_ = &registry().technique(request.at("technique").get<std::string>());
    settings_ = request.at("settings").get<std::string>();
    technique_ = fresh_technique();
    fresh_ = -1;
    mask_.reset();
    light_.reset();
    uses_gl_ = entry_->about.needs_gl;
    if (!uses_gl_) return json_object({{"gl", nullptr}});
    const GlInfo& info = process_context().info();
    return json_object({{"gl", json_object({{"renderer", info.renderer}, {"version", info.version}})}});
  }

  /// What a parameter spoils is out of date from then on; the rest stays.
  Json set(const std::string& settings) {
    settings_ = settings;
    const auto wanted = fresh_technique();
    for (const Parameter* row : wanted->parameters()) {
      Parameter& live = technique_->parameter(row->name());
      if (live.text() == row->text()) continue;
      live.set(row->text());
      fresh_ = std::min(fresh_, static_cast<int>(row->spoils()) - 1);
    }
    return json_object({{"fresh", fresh_ + 1}});
  }

  Json frame(const Json& request) {
    const Frame asked = asked_frame(request);
    fresh_ = std::min(fresh_, static_cast<int>(asked.lit_by == lit_by_ ? Stage::relight : Stage::build));
    if (!light_ || asked.lit_by != lit_by_) light_ = std::make_unique<Light>(asked.light);
    lit_by_ = asked.lit_by;
    // The same G-buffer under another light stays mapped, and uploaded.
    const std::string file = request.at("gbuffer");
    GBuffer& known = gbuffers_[file];
    if (known.width != asked.key.width || known.height != asked.key.height) known = map_gbuffer(file, asked.key);
    gbuffer_ = known;
    mask_.emplace(asked.key.width, asked.key.height);
    const Support support = fresh_technique()->supports(scene_, *light_, asked.key.view);
    Json result = json_object({{"support", name(support.kind())}, {"why", support.why()}, {"fresh", fresh_ + 1}});
    if (uses_gl_ && support) {
      const SceneBuffers& buffers = scene_buffers(scene_);
      const GBufferTextures& textures = gbuffer_textures(gbuffer_, scene_);
      const DepthStencil& depth = depth_stencil(scene_, gbuffer_, entry_->about.sees);
      result["input_bytes"] = buffers.bytes + textures.bytes + depth.bytes;
      result["upload_ms"] = buffers.upload_ms + textures.upload_ms + depth.upload_ms;
    }
    return result;
  }

  /// A frame as a request describes it.
  struct Frame {
    FrameKey key;
    Light light;
    std::string lit_by;  ///< differs between any two lights: relight is out of date when it changes
  };

  Frame asked_frame(const Json& request) {
    Frame asked;
    FrameKey& key = asked.key;
    set_size_and_truth(key, request);
    if (request.contains("stand")) {
      Scene holder = scene_in(request.at("stand"));
      asked.light = holder.lights.at(0);
      key.view = holder.views.at(0);
      holder.views.clear();
      asked.lit_by = content_hash(scene_bytes(holder));
      // A viewer makes a new G-buffer with every move of the camera and does not come back to an old one.
      std::erase_if(gbuffers_, [&](const auto& known) { return known.first != request.at("gbuffer"); });
      return asked;
    }
    key.view = scene_.views.at(request.at("view").get<std::size_t>());
    asked.light = scene_.lights.at(request.at("light").get<std::size_t>());
    asked.lit_by = asked.light.name;
    if (const std::string name = request.value("path", ""); !name.empty()) {
      const Path path = find_path(scene_, name, asked.light, key.view);
      const int frame = request.at("frame");
      asked.light = light_at(path, asked.light, frame);
      key.view = view_at(path, key.view, frame);
      if (path.moves == Path::Moves::light) asked.lit_by += fmt::format(" {} {}", name, frame);
    }
    return asked;
  }

  static void set_size_and_truth(FrameKey& key, const Json& request) {
    const auto side_of = [&](const char* name) {
      const auto side = request.at(name).get<std::int64_t>();
      if (side < 1 || side > 16384) throw Error("a frame's {} = {} is outside 1 .. 16384 pixels", name, side);
      return static_cast<int>(side);
    };
    key.width = side_of("width");
    key.height = side_of("height");
    key.truth = request.at("truth") == "mesh" ? Truth::mesh : Truth::shape;
  }

  static Scene scene_in(const std::string& file) { return scene_from_bytes(MappedFile::open(file)->bytes()); }

  /// Serves the reference instead of a technique; all requests are of one scene.
  Json trace(const Json& request) {
    if (technique_) throw Error("a worker that serves a technique does not trace");
    if (!tracer_) {
      scene_ = scene_in(request.at("scene"));
      tracer_.emplace(scene_);
    }
    const Scene holder = scene_in(request.at("stand"));
    MissingFrame missing{.scene_file = {}, .key = {.view = holder.views.at(0)}, .light = {}, .gbuffer_file = {}};
    set_size_and_truth(missing.key, request);
    if (!holder.lights.empty()) missing.light = holder.lights[0];
    missing.gbuffer_file = request.at("gbuffer").get<std::string>();
    missing.target = {.error = request.at("error"), .cap = request.at("cap")};
    if (!(missing.target.error >= 1e-6)) throw Error("a reference's error = {} is below 1e-6", missing.target.error);
    SharedCount done(request.value("done", ""));
    missing.done = &done.value();
    write_file(request.at("out").get<std::string>(), tracer_->make(missing));
    return Json::object();
  }

  static int stage_named(const std::string& name) {
    for (int s = 0; s < 4; ++s)
      if (stage_names[s] == name) return s;
    throw Error("there is no stage {}", name);
  }

  Json time_stage(int stage) {
    bring_up(stage - 1);
    return json_object({{"ms", time(static_cast<Stage>(stage))}});
  }

  Json bring_up(int stage) {
    for (int s = fresh_ + 1; s <= stage; ++s) time(static_cast<Stage>(s));
    return Json::object();
  }

  /// Does one stage and returns its milliseconds; what follows it is out of date then.
  double time(Stage stage) {
    if (stage >= Stage::relight && !mask_) throw Error("a worker cannot {} before it has a frame", name(stage));
    if (uses_gl_) glFinish();
    const auto start = Clock::now();
    switch (stage) {
      case Stage::setup:
        technique_->setup();
        break;
      case Stage::build:
        technique_->build(scene_);
        break;
      case Stage::relight:
        technique_->relight(*light_);
        break;
      case Stage::resolve:
        technique_->resolve(gbuffer_, *mask_);
        break;
    }
    if (uses_gl_) glFinish();
    const double ms = std::chrono::duration<double, std::milli>(Clock::now() - start).count();
    if (uses_gl_)
      if (const GLenum code = glGetError(); code != GL_NO_ERROR) throw Error("OpenGL error {:#x}", code);
    fresh_ = static_cast<int>(stage);
    return ms;
  }

  Json write_mask(const std::string& path) {
    bring_up(static_cast<int>(Stage::resolve));
    write_file(path, std::as_bytes(mask_->read()));
    return Json::object();
  }

  Json answer(const std::string& path) {
    write_mask(path);
    const double peak = peak_bytes();  // counting may build or draw once more
    Json counts = Json::array();
    for (const Count& c : technique_->counts()) {
      if (!std::isfinite(c.value)) throw Error("count {} is {}", c.name, c.value);
      counts.push_back(json_object({{"name", c.name}, {"value", c.value}, {"unit", c.unit}}));
    }
    return json_object({{"counts", counts}, {"peak_bytes", peak}});
  }

  /// Asks the technique about the listed pixels (uint32 indices) and writes its explanations.
  Json explain(const std::string& pixels, const std::string& out) {
    bring_up(static_cast<int>(Stage::resolve));
    const auto file = MappedFile::open(pixels);
    const std::size_t count = file->bytes().size() / sizeof(std::uint32_t);
    const auto* index = reinterpret_cast<const std::uint32_t*>(file->bytes().data());
    std::vector<std::optional<Explanation>> explanations;
    explanations.reserve(count);
    for (std::size_t k = 0; k < count; ++k) {
      if (index[k] >= gbuffer_.size()) throw Error("there is no pixel {}: the picture has {}", index[k], gbuffer_.size());
      explanations.push_back(technique_->explain(index[k]));
    }
    write_file(out, explanation_bytes(explanations));
    const bool explained = std::ranges::any_of(explanations, [](const auto& why) { return why.has_value(); });
    return json_object({{"explained", explained}});
  }

  Json debug(const std::string& layer, const std::string& out) {
    bring_up(static_cast<int>(Stage::resolve));
    const std::vector<float> rgb = technique_->draw_debug(layer);
    write_file(out, std::as_bytes(std::span(rgb)));
    return Json::object();
  }

  Json detail(const std::string& out) {
    bring_up(static_cast<int>(Stage::relight));
    const std::optional<SurfaceDetail> detail = technique_->surface_detail();
    if (!detail) throw Error("{} gave no surface detail, though a fresh one does", entry_->id);
    check_detail(scene_, *detail);
    write_file(out, detail_bytes(*detail));
    return Json::object();
  }

  std::unique_ptr<Technique> fresh_technique() const {
    auto technique = entry_->make();
    technique->apply(settings_);
    return technique;
  }

  Scene scene_;
  const TechniqueEntry* entry_ = nullptr;
  std::string settings_;
  std::unique_ptr<Technique> technique_;
  bool uses_gl_ = false;
  std::string lit_by_;                       ///< of the light that the technique was given last
  std::unique_ptr<Light> light_;             ///< that light
  std::map<std::string, GBuffer> gbuffers_;  ///< by file: one for each view and truth
  GBuffer gbuffer_;
  std::optional<VisibilityMask> mask_;
  std::optional<FrameTracer> tracer_;
  int fresh_ = -1;  ///< last stage that is up to date
};

}  // namespace

int worker_main(int socket, int threads) {
  std::optional<tbb::global_control> limit;
  if (threads > 0) limit.emplace(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
  // Leaked on purpose: the process ends by being killed, and a technique's destructor is no part of a measurement.
  TechniqueServer& server = *new TechniqueServer;
  std::string pending;
  for (;;) {
    const std::size_t end = pending.find('\n');
    if (end == std::string::npos) {
      char chunk[4096];
      const ssize_t n = read(socket, chunk, sizeof chunk);
      if (n < 0 && errno == EINTR) continue;
      if (n <= 0) _exit(0);
      pending.append(chunk, static_cast<std::size_t>(n));
      continue;
    }
    Json answer;
    try {
      answer = server.handle(parse_json(pending.substr(0, end)));
    } catch (const std::bad_alloc&) {
      answer["error"] = "out of memory";
    } catch (const std::exception& error) {
      answer["error"] = error.what();
    } catch (...) {
      answer["error"] = "an exception that is no std::exception";
    }
    pending.erase(0, end + 1);
    if (!write_line(socket, json_text(answer))) _exit(0);
  }
}

}  // namespace gnomon
