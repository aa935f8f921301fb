#pragma once
#include "measure/fields.h"
#include "measure/frame/classify.h"
#include "measure/gl_inputs.h"
#include "measure/scene/posed_scene.h"

// The messages between a program and its workers: one line of JSON a request, {"do": VERB, ...}, and one a reply. Each request
// is a struct with its verb and its reply; an exception is answered by {"error": text}.

namespace gnomon {

/// Version of these, and of the files that pass between both sides. One more with every change that an older worker would
/// misunderstand.
inline constexpr int worker_protocol = 8;

/// A worker with a request for several iterations of a stage answers after the one in which these seconds are over, with as
/// many as it has done: an answer takes no longer than this and one call of the stage.
inline constexpr double longest_portion_seconds = 0.1;

/// Bare passes in a row that a worker draws in one answer, at most.
inline constexpr int most_floor_times = 50;

/// The last stage that is up to date once this one was done: build brings along what update would.
constexpr Stage fresh_after(Stage stage) { return stage == Stage::build ? Stage::update : stage; }

/// Nothing but that it is done.
struct Done {};
void for_each_field(MaybeConst<Done> auto&, const auto&) {}

/// A technique's support of a light.
struct SupportReply {
  Support::Kind support = Support::Kind::full;
  std::string why = {};
};
void for_each_field(MaybeConst<SupportReply> auto& r, const auto& use) { use("support", r.support, "why", r.why); }
inline SupportReply reply_of(const Support& support) { return {support.kind(), support.why()}; }
inline Support support_of(const SupportReply& reply) {
  if (reply.support == Support::Kind::full) return Support::full();
  const std::string why = printable(reply.why);
  return reply.support == Support::Kind::approximate ? Support::approximate(why) : Support::unsupported(why);
}

/// What program this is.
struct ProtocolRequest {
  static constexpr const char* verb = "protocol";
  struct Reply {
    int protocol = 0;
    Json context;  ///< machine_context
  };
};
void for_each_field(MaybeConst<ProtocolRequest> auto&, const auto&) {}
void for_each_field(MaybeConst<ProtocolRequest::Reply> auto& r, const auto& use) {
  use("protocol", r.protocol, "context", r.context);
}

/// What a worker draws with.
struct WorkerGl {
  std::string renderer, version;
  int subpixel_bits = usual_subpixel_bits;
  /// State of the card at the load: name, driver, graphics_mhz, power_w and so on; nothing where it is unknown.
  std::optional<Json> card = {};
};
void for_each_field(MaybeConst<WorkerGl> auto& r, const auto& use) {
  use("renderer", r.renderer, "version", r.version, "subpixel_bits", r.subpixel_bits, "card", r.card);
}

/// From now on the worker serves this technique on this scene.
struct OpenRequest {
  static constexpr const char* verb = "open";
  std::string scene = {};           ///< file with scene_bytes
  std::string technique, settings;  ///< id; "a=1,b=2"
  std::string progress = {};        ///< place of a SharedCount in which the technique counts its progress through a stage
  struct Reply {
    std::optional<WorkerGl> gl = {};  ///< nothing for a technique that does not draw
  };
};
void for_each_field(MaybeConst<OpenRequest> auto& r, const auto& use) {
  use("scene", r.scene, "technique", r.technique, "settings", r.settings, "progress", r.progress);
}
void for_each_field(MaybeConst<OpenRequest::Reply> auto& r, const auto& use) { use("gl", r.gl); }

/// Other settings of the same technique.
struct SetRequest {
  static constexpr const char* verb = "set";
  std::string settings = {};
  struct Reply {
    int fresh = 0;  ///< stages, from setup on, that are up to date
  };
};
void for_each_field(MaybeConst<SetRequest> auto& r, const auto& use) { use("settings", r.settings); }
void for_each_field(MaybeConst<SetRequest::Reply> auto& r, const auto& use) { use("fresh", r.fresh); }

void for_each_field(MaybeConst<WantedPose> auto& r, const auto& use) {
  use("animation", r.at.animation, "seconds", r.at.seconds, "start", r.at.start, "frame_rate", r.at.frame_rate);
  use("frames", r.at.frames, "hash", r.hash);
}

/// Goes to a frame. Lights and view are the scene's, by number, on a path where that has moved one of them to; or they are
/// free: those of `light_and_view`, a file with the scene_bytes of a scene without meshes that holds the lights and one view.
struct GoRequest {
  static constexpr const char* verb = "frame";
  std::string gbuffer = {};  ///< file, as write_gbuffer writes it
  int width = 0, height = 0;
  Truth truth = Truth::shape;
  std::optional<std::string> light_and_view = {};
  std::vector<std::size_t> lights = {};
  std::size_t view = 0;
  std::string path = {};                ///< its name; empty: light and view do not move
  int frame = 0;                        ///< on the path
  std::optional<WantedPose> pose = {};  ///< nothing: meshes are at rest
  bool begins_sequence = false;         ///< Technique::forget first; so does another size or truth
  struct Reply {
    SupportReply support;
    int fresh = 0;
    std::vector<SupportReply> lights = {};  ///< each; one that is unsupported beside others casts no shadows
    std::optional<bool> shares = {};        ///< of several lights: whether they share what setup and build make
    std::string floor = {};                 ///< name of the bare pass of the frame; empty: none
  };
};
void for_each_field(MaybeConst<GoRequest> auto& r, const auto& use) {
  use("gbuffer", r.gbuffer, "width", r.width, "height", r.height, "truth", r.truth);
  use("light_and_view", r.light_and_view, "lights", r.lights, "view", r.view);
  use("path", r.path, "frame", r.frame, "pose", r.pose, "begins_sequence", r.begins_sequence);
}
void for_each_field(MaybeConst<GoRequest::Reply> auto& r, const auto& use) {
  use("support", r.support, "fresh", r.fresh, "lights", r.lights, "shares", r.shares, "floor", r.floor);
}

/// Brings earlier stages up untimed and does this one so many times, or fewer (longest_portion_seconds).
struct TimeRequest {
  static constexpr const char* verb = "time";
  Stage stage = Stage::setup;
  int iterations = 1;
  struct Reply {
    double ms = 0;                          ///< all of them together
    int iterations = 0;                     ///< that were done
    std::optional<double> device_ms = {};   ///< the same by the clock of the device that draws
    std::optional<double> harness_ms = {};  ///< and by the harness's, where `ms` is by the technique's own
  };
};
void for_each_field(MaybeConst<TimeRequest> auto& r, const auto& use) { use("stage", r.stage, "iterations", r.iterations); }
void for_each_field(MaybeConst<TimeRequest::Reply> auto& r, const auto& use) {
  use("ms", r.ms, "iterations", r.iterations, "device_ms", r.device_ms, "harness_ms", r.harness_ms);
}

/// Draws the frame's bare pass so many times in a row.
struct FloorRequest {
  static constexpr const char* verb = "floor";
  int times = 1;
  struct Reply {
    double ms = 0;  ///< all of them together
    std::optional<double> device_ms = {};
  };
};
void for_each_field(MaybeConst<FloorRequest> auto& r, const auto& use) { use("times", r.times); }
void for_each_field(MaybeConst<FloorRequest::Reply> auto& r, const auto& use) { use("ms", r.ms, "device_ms", r.device_ms); }

/// Present state of the card.
struct CardRequest {
  static constexpr const char* verb = "card";
  struct Reply {
    std::optional<Json> card = {};  ///< as in WorkerGl
  };
};
void for_each_field(MaybeConst<CardRequest> auto&, const auto&) {}
void for_each_field(MaybeConst<CardRequest::Reply> auto& r, const auto& use) { use("card", r.card); }

/// Does all stages up to this one, once, that are out of date.
struct BringUpRequest {
  static constexpr const char* verb = "bring_up";
  Stage stage = Stage::setup;
  using Reply = Done;
};
void for_each_field(MaybeConst<BringUpRequest> auto& r, const auto& use) { use("stage", r.stage); }

/// The masks of all lights, one after the other, as raw floats in a file.
struct MaskRequest {
  static constexpr const char* verb = "mask";
  std::string mask = {};
  using Reply = Done;
};
void for_each_field(MaybeConst<MaskRequest> auto& r, const auto& use) { use("mask", r.mask); }

/// The same, and what the technique counts.
struct AnswerRequest {
  static constexpr const char* verb = "answer";
  std::string mask = {};
  struct Reply {
    Counts counts;
    std::uint64_t peak_bytes = 0;  ///< largest resident memory so far
    std::string maker = {};        ///< WorksElsewhere::maker
    std::optional<GlInputs> gl = {};
  };
};
void for_each_field(MaybeConst<AnswerRequest> auto& r, const auto& use) { use("mask", r.mask); }
void for_each_field(MaybeConst<AnswerRequest::Reply> auto& r, const auto& use) {
  use("counts", r.counts, "peak_bytes", r.peak_bytes, "maker", r.maker, "gl", r.gl);
}

// These are about one of the frame's lights, and about the masks answered last.

/// The technique's account of pixels: a file of their uint32 indices, and one for explanation_bytes in the same order.
struct ExplainRequest {
  static constexpr const char* verb = "explain";
  std::string pixels, out;
  std::size_t light = 0;
  struct Reply {
    bool explained = false;  ///< any of them
  };
};
void for_each_field(MaybeConst<ExplainRequest> auto& r, const auto& use) {
  use("pixels", r.pixels, "out", r.out, "light", r.light);
}
void for_each_field(MaybeConst<ExplainRequest::Reply> auto& r, const auto& use) { use("explained", r.explained); }

/// Technique::error_terms: `exact` holds a float for each pixel, `out` gets as many for each term, one term after the other.
struct ErrorTermsRequest {
  static constexpr const char* verb = "error_terms";
  std::string exact, out;
  std::size_t light = 0;
  struct Reply {
    std::vector<std::string> causes;  ///< of each term
  };
};
void for_each_field(MaybeConst<ErrorTermsRequest> auto& r, const auto& use) {
  use("exact", r.exact, "out", r.out, "light", r.light);
}
void for_each_field(MaybeConst<ErrorTermsRequest::Reply> auto& r, const auto& use) { use("causes", r.causes); }

void for_each_field(MaybeConst<SharesAlong> auto& r, const auto& use) { use("depth", r.depth, "share", r.share); }
void for_each_field(MaybeConst<DepthCurve> auto& r, const auto& use) {
  use("held", r.held, "exact", r.exact, "receiver", r.receiver);
}

/// Technique::depth_curve.
struct DepthCurveRequest {
  static constexpr const char* verb = "depth_curve";
  std::uint32_t pixel = 0;
  std::size_t light = 0;
  struct Reply {
    std::optional<DepthCurve> curve = {};
  };
};
void for_each_field(MaybeConst<DepthCurveRequest> auto& r, const auto& use) { use("pixel", r.pixel, "light", r.light); }
void for_each_field(MaybeConst<DepthCurveRequest::Reply> auto& r, const auto& use) { use("curve", r.curve); }

/// Technique::image_parts: `out` gets a uint32 for each pixel.
struct PartsRequest {
  static constexpr const char* verb = "parts";
  std::string out = {};
  std::size_t light = 0;
  struct Reply {
    bool has_parts = false;
  };
};
void for_each_field(MaybeConst<PartsRequest> auto& r, const auto& use) { use("out", r.out, "light", r.light); }
void for_each_field(MaybeConst<PartsRequest::Reply> auto& r, const auto& use) { use("has_parts", r.has_parts); }

struct DebugRequest {
  static constexpr const char* verb = "debug";
  std::string layer, out;  ///< out: three floats a pixel
  std::size_t light = 0;
  using Reply = Done;
};
void for_each_field(MaybeConst<DebugRequest> auto& r, const auto& use) {
  use("layer", r.layer, "out", r.out, "light", r.light);
}

/// Technique::global_picture.
struct GlobalRequest {
  static constexpr const char* verb = "global";
  std::string out = {};  ///< three floats a pixel
  std::size_t light = 0;
  struct Reply {
    bool has_picture = false;
  };
};
void for_each_field(MaybeConst<GlobalRequest> auto& r, const auto& use) { use("out", r.out, "light", r.light); }
void for_each_field(MaybeConst<GlobalRequest::Reply> auto& r, const auto& use) { use("has_picture", r.has_picture); }

/// Surface detail of the last relight.
struct DetailRequest {
  static constexpr const char* verb = "detail";
  std::string out = {};  ///< detail_bytes
  std::size_t light = 0;
  using Reply = Done;
};
void for_each_field(MaybeConst<DetailRequest> auto& r, const auto& use) { use("out", r.out, "light", r.light); }

/// The reference of a light, with `global_samples` that of all light, with `pixel_rays` the truth over the pixel, or where
/// `light_and_view` has no light the G-buffer, as the frame cache stores them. A worker that traces serves no technique.
struct TraceRequest {
  static constexpr const char* verb = "trace";
  std::string scene, light_and_view, gbuffer, out;  ///< files; light_and_view as in GoRequest
  int width = 0, height = 0;
  Truth truth = Truth::shape;
  double error = 0;  ///< AreaTarget
  std::uint32_t cap = 0;
  int subpixel_bits = usual_subpixel_bits, global_samples = 0, pixel_rays = 0;
  std::string done = {};                ///< place of a SharedCount of the pixels that are through; may be empty
  std::optional<WantedPose> pose = {};  ///< nothing: meshes are at rest
  using Reply = Done;
};
void for_each_field(MaybeConst<TraceRequest> auto& r, const auto& use) {
  use("scene", r.scene, "light_and_view", r.light_and_view, "gbuffer", r.gbuffer, "out", r.out);
  use("width", r.width, "height", r.height, "truth", r.truth);
  use("error", r.error, "cap", r.cap, "subpixel_bits", r.subpixel_bits);
  use("global_samples", r.global_samples, "pixel_rays", r.pixel_rays, "done", r.done, "pose", r.pose);
}

/// The line of a request.
template <class Request>
Json request_json(const Request& request) {
  Json json = json_object({{"do", Request::verb}});
  json.update(written(request));
  return json;
}
/// A request or reply out of its JSON. Throws Error on a field that is not what it should be, or is not there.
template <class Message>
Message message_from(const Json& json, const std::string& what) {
  Message message;
  read(what, json, message, MissingField::refused);
  return message;
}

}  // namespace gnomon
