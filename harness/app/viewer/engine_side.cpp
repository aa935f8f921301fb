// One side: its worker process and what it is asked, the most urgent thing first.
#include <gnomon/registry.h>

#include <algorithm>

#include "app/viewer/engine_body.h"
#include "measure/score/score.h"

namespace gnomon::viewer {

namespace fs = std::filesystem;

namespace {

/// Whether the side shows the reference, which the engine has anyway: as it is, and without its debug layers.
bool shows_reference(const SideWish& wish) {
  if (!wish.settings.empty() || !wish.layer.empty()) return false;
  return registry().technique(wish.technique).about.role == gnomon::Role::reference;
}

/// Starting a process, loading the scene and finding a device is the viewer's own work: a short timeout is not meant for it.
constexpr double least_start_seconds = 60;

}  // namespace

fs::path Engine::Body::Side::file(const char* name) const { return body_.scratch.path / fmt::format("{}.{}", index_, name); }

bool Engine::Body::Side::is_through(std::uint64_t frame) const {
  const SideState& s = body_.state.sides[index_];
  if (s.is_reference) return body_.state.reference && body_.state.reference->frame->number >= frame;
  return s.phase == Phase::failed || s.phase == Phase::starting || frame_ > frame || (frame_ == frame && fresh_ == 4) ||
         (frame_ == frame && !is_supported_);
}

void Engine::Body::Side::interrupt() {
  causes_.give_up();
  if (worker_) worker_->interrupt();
}

Engine::Body::Side::Seated Engine::Body::Side::seat_of(const Wish& wish) const {
  return {wish.loaded, wish.sides[index_].technique, wish.sides[index_].attempt};
}

void Engine::Body::Side::outdated_by(const Wish& wish) {
  if (!(body_.wish.sides[index_] == wish.sides[index_])) causes_.give_up();
  if (!seated_ || *seated_ == seat_of(wish)) return;
  is_given_up_ = true;
  if (worker_) worker_->interrupt();
}

Engine::Body::Work Engine::Body::Side::next() {
  const SideWish& wish = body_.wish.sides[index_];
  const std::shared_ptr<const Frame>& frame = body_.state.frame;
  // What is shown is of the scene that is wished, or there is nothing to do yet.
  if (!frame || frame->loaded != body_.wish.loaded || wish.technique.empty()) return {};
  SideState& s = state();
  if (shows_reference(wish)) {
    const auto& reference = body_.state.reference;
    const bool is_done = reference && reference->frame == frame && reference->is_complete;
    const bool has_none = is_done && !reference->why_not.empty();
    s = {};
    s.is_reference = true;
    s.phase = has_none ? Phase::unsupported : is_done ? Phase::done : Phase::working;
    s.words = has_none ? reference->why_not : is_done ? "" : "reference";
    seated_.reset();
    if (!worker_) return {};
    return [this] {
      std::unique_ptr<Worker> gone;
      const std::lock_guard lock(body_.mutex);
      gone = std::move(worker_);
    };
  }
  const Seated seat = seat_of(body_.wish);
  if (seated_ != seat || is_given_up_) return [this, seat, settings = wish.settings] { start(seat, settings); };
  if (settings_ != wish.settings) {
    if (has_failed_) return [this, seat, settings = wish.settings] { start(seat, settings); };
    return guarded([this, settings = wish.settings] { set(settings); });
  }
  if (has_failed_) return {};
  if (frame_ != frame->number) return guarded([this, frame] { go(frame); });
  if (!is_supported_) return {};
  if (fresh_ < 4 || repeat_ != body_.wish.repeat)
    return guarded([this, frame, repeat = body_.wish.repeat] { answer(frame, repeat); });

  const std::shared_ptr<const SideAnswer>& last = s.answer;
  if (wish.layer.empty()) s.layer = nullptr;
  if (!wish.layer.empty() && (!s.layer || s.layer->answer != last || s.layer->layer.name != wish.layer))
    return guarded([this, last, layer = wish.layer] { draw_layer(last, layer); });
  if (!frame->is_full()) return {};
  const std::shared_ptr<const ReferenceState>& reference = body_.state.reference;
  const bool has_classes = reference && reference->frame == frame && !reference->classes.empty();
  if (has_classes && (!s.verdict || s.verdict->answer != last))
    return guarded([this, last, reference] { judge(last, reference); });
  if (body_.wish.is_moving) return {};
  if (s.counted_answer != last) return guarded([this, last] { count(last); });
  const auto& picked = body_.wish.picked;
  if (s.explained != picked || (picked && s.explained_answer != last))
    return guarded([this, last, picked] { explain_picked(last, picked); });
  if (has_classes && !s.verdict->has_causes && reference->is_complete)
    return guarded([this, verdict = s.verdict, reference] { find_reasons(verdict, reference); });
  return {};
}

/// Work whose failure is the side's failure.
Engine::Body::Work Engine::Body::Side::guarded(std::function<void()> work) {
  return [this, work = std::move(work)] {
    try {
      work();
    } catch (const std::exception& error) {
      fail(error.what());
    }
  };
}

void Engine::Body::Side::fail(const std::string& why) {
  std::unique_ptr<Worker> gone;
  body_.change([&](EngineState&) {
    since_.reset();
    causes_.give_up();
    gone = std::move(worker_);
    // Interrupted, because something else was wished: no failure of the technique.
    if (body_.stop || is_given_up_) {
      seated_.reset();
      return;
    }
    has_failed_ = true;
    SideState& s = state();
    s.phase = Phase::failed;
    s.words = why;
    s.answer = nullptr;
    s.verdict = nullptr;
    s.layer = nullptr;
  });
}

/// Asks the worker and waits; the state says what for, without waking anybody.
Json Engine::Body::Side::ask(const std::string& words, const Json& request, double least_timeout) {
  {
    const std::lock_guard lock(body_.mutex);
    state().words = words;
    since_ = Clock::now();
  }
  Json reply = worker_->ask(request, std::max(body_.timeout_seconds, least_timeout));
  const std::lock_guard lock(body_.mutex);
  since_.reset();
  if (reply.contains("fresh")) fresh_ = reply["fresh"];
  return reply;
}

void Engine::Body::Side::start(const Seated& seat, const std::string& settings) {
  std::unique_ptr<Worker> gone;
  bool is_wished = false;
  body_.change([&](EngineState&) {
    gone = std::move(worker_);
    is_wished = seat == seat_of(body_.wish);
    if (!is_wished) return;
    seated_ = seat;
    is_given_up_ = false;
    settings_ = settings;
    has_failed_ = false;
    fresh_ = 0;
    frame_ = 0;
    stage_ms_ = {};
    state() = {};
    state().words = "start";
  });
  gone.reset();
  if (!is_wished) return;
  guarded([&] {
    auto worker = std::make_unique<Worker>(body_.workers);
    {
      const std::lock_guard lock(body_.mutex);
      worker_ = std::move(worker);
      if (body_.stop || is_given_up_) worker_->interrupt();
    }
    const Json opened = ask("start",
                            {{"do", "open"},
                             {"scene", seat.loaded->store->scene_file().string()},
                             {"technique", seat.technique},
                             {"settings", settings}},
                            least_start_seconds);
    body_.change([&](EngineState&) {
      if (!opened["gl"].is_null()) state().renderer = opened["gl"]["renderer"];
    });
  })();
}

void Engine::Body::Side::set(const std::string& settings) {
  settings_ = settings;
  ask("set", {{"do", "set"}, {"settings", settings}});
  // Support may depend on a parameter, and is asked at a frame.
  const std::lock_guard lock(body_.mutex);
  frame_ = 0;
}

/// Has the worker go to a frame.
Json Engine::Body::Side::stand_at(const Frame& frame, const std::string& words) {
  const fs::path stand = file("stand");
  write_file(stand, stand_bytes(frame.light, frame.gbuffer.view));
  return ask(words, {{"do", "frame"},
                     {"gbuffer", frame.file->string()},
                     {"stand", stand.string()},
                     {"width", frame.gbuffer.width},
                     {"height", frame.gbuffer.height},
                     {"truth", name(frame.gbuffer.truth)}});
}

void Engine::Body::Side::go(const std::shared_ptr<const Frame>& frame) {
  const Json reply = stand_at(*frame, "frame");
  const std::string kind = reply["support"], why = reply["why"];
  support_ = kind == "unsupported"   ? Support::unsupported(why)
             : kind == "approximate" ? Support::approximate(why)
                                     : Support::full();
  body_.change([&](EngineState&) {
    frame_ = frame->number;
    is_supported_ = static_cast<bool>(support_);
    SideState& s = state();
    if (is_supported_) {
      s.phase = Phase::working;
    } else {
      s.phase = Phase::unsupported;
      s.words = why;
      s.answer = nullptr;
      s.verdict = nullptr;
      s.layer = nullptr;
    }
  });
}

/// Does the stages that are out of date, and resolve in any case; the mask.
std::vector<float> Engine::Body::Side::resolve_mask(const Frame& frame, bool is_timed) {
  for (int stage = std::min(fresh_, 3); stage < 4; ++stage) {
    const std::string word(stage_names[stage]);
    const Json timed = ask(word, {{"do", "time"}, {"stage", word}});
    if (is_timed) stage_ms_[stage] = timed["ms"].get<double>();
    const std::lock_guard lock(body_.mutex);
    fresh_ = stage + 1;
  }
  const fs::path mask = file("mask");
  ask("mask", {{"do", "mask"}, {"mask", mask.string()}});
  return read_mask_file(mask, frame.gbuffer.size());
}

void Engine::Body::Side::answer(const std::shared_ptr<const Frame>& frame, std::uint64_t repeat) {
  auto answer = std::make_shared<SideAnswer>();
  answer->frame = frame;
  answer->support = support_;
  answer->mask = resolve_mask(*frame, true);
  answer->stage_ms = stage_ms_;
  body_.change([&](EngineState&) {
    SideState& s = state();
    s.phase = Phase::done;
    s.words = support_.why();
    // The same question has the same answer: what was found out about it stays.
    const bool is_repeated = s.answer && s.answer->frame == frame && repeat_ != repeat && s.answer->mask == answer->mask;
    if (is_repeated) {
      s.newest_ms = answer->stage_ms;
    } else {
      s.answer = answer;
      s.newest_ms = answer->stage_ms;
    }
    ++s.answer_count;
    repeat_ = repeat;
  });
}

/// What the technique counts may take it as long as its answer: only asked at rest.
void Engine::Body::Side::count(const std::shared_ptr<const SideAnswer>& answer) {
  const Json reply = ask("counts", {{"do", "answer"}, {"mask", file("mask").string()}});
  auto counts = std::make_shared<Counts>();
  for (const Json& c : reply["counts"]) counts->push_back({c["name"], c["value"], c["unit"]});
  body_.change([&](EngineState&) {
    state().counts = counts;
    state().counted_answer = answer;
    state().words = support_.why();
  });
}

void Engine::Body::Side::draw_layer(const std::shared_ptr<const SideAnswer>& answer, const std::string& name) {
  const auto technique = registry().technique(seated_->technique).make();
  technique->apply(settings_);
  const std::vector<DebugLayer> layers = technique->debug_layers();
  const auto found = std::ranges::find(layers, name, &DebugLayer::name);
  if (found == layers.end()) throw Error("{} has no debug layer {}", seated_->technique, name);
  const fs::path raw = file("layer");
  ask("layer " + name, {{"do", "debug"}, {"layer", name}, {"out", raw.string()}});
  auto picture = std::make_shared<LayerPicture>();
  picture->frame = answer->frame;
  picture->answer = answer;
  picture->layer = *found;
  const auto bytes = MappedFile::open(raw);
  const std::size_t wanted = 3 * answer->frame->gbuffer.size();
  if (bytes->bytes().size() != wanted * sizeof(float))
    throw Error("debug layer {} has {} bytes; {} are wanted", name, bytes->bytes().size(), wanted * sizeof(float));
  const auto* const floats = reinterpret_cast<const float*>(bytes->bytes().data());
  picture->rgb.assign(floats, floats + wanted);
  body_.change([&](EngineState&) {
    state().layer = picture;
    state().words = support_.why();
  });
}

std::vector<std::optional<Explanation>> Engine::Body::Side::explain(std::span<const std::uint32_t> pixels) {
  const fs::path asked = file("pixels"), answered = file("explanations");
  write_file(asked, std::as_bytes(pixels));
  const Json reply = ask("explain", {{"do", "explain"}, {"pixels", asked.string()}, {"out", answered.string()}});
  if (!reply["explained"].get<bool>()) return std::vector<std::optional<Explanation>>(pixels.size());
  return explanations_from_bytes(MappedFile::open(answered)->bytes());
}

void Engine::Body::Side::explain_picked(const std::shared_ptr<const SideAnswer>& answer, std::optional<std::uint32_t> pixel) {
  std::shared_ptr<const Explanation> explanation;
  if (pixel && *pixel < answer->mask.size()) {
    const std::uint32_t index[] = {*pixel};
    if (const auto why = explain(index)[0]) explanation = std::make_shared<Explanation>(*why);
  }
  body_.change([&](EngineState&) {
    state().explanation = explanation;
    state().explained = pixel;
    state().explained_answer = answer;
    state().words = support_.why();
  });
}

/// Counts the wrong pixels; their causes come later.
void Engine::Body::Side::judge(const std::shared_ptr<const SideAnswer>& answer,
                               const std::shared_ptr<const ReferenceState>& reference) {
  auto verdict = std::make_shared<Verdict>();
  verdict->answer = answer;
  verdict->reference = reference;
  const GBuffer& g = answer->frame->gbuffer;
  const Evidence evidence{.width = g.width,
                          .height = g.height,
                          .classes = reference->classes,
                          .reference = reference->mask,
                          .mask = answer->mask,
                          .causes = {}};
  verdict->errors = Scoring(evidence).error_counts();
  body_.change([&](EngineState&) { state().verdict = verdict; });
}

/// Names the cause of every wrong pixel, as `gnomon render` does.
void Engine::Body::Side::find_reasons(const std::shared_ptr<const Verdict>& verdict,
                                      const std::shared_ptr<const ReferenceState>& truth) {
  std::uint64_t ticket = 0;
  {
    const std::lock_guard lock(body_.mutex);
    const auto& frame = body_.state.frame;
    if (frame != verdict->answer->frame || body_.stop) return;
    ticket = causes_.ticket();
  }
  const Frame& frame = *verdict->answer->frame;
  const std::vector<float>& mask = verdict->answer->mask;
  std::vector<std::uint8_t> right_on_mesh;
  if (truth->on_mesh && registry().technique(seated_->technique).about.sees == Truth::mesh) {
    const ReferenceState& other = *truth->on_mesh;
    if (stand_at(*other.frame, "causes")["support"] != "unsupported") {
      const std::vector<float> on_mesh = resolve_mask(*other.frame, false);
      right_on_mesh.resize(mask.size());
      for (std::size_t i = 0; i < mask.size(); ++i) right_on_mesh[i] = !is_wrong(on_mesh[i], other.mask[i]);
    }
    stand_at(frame, "causes");
    resolve_mask(frame, false);
  }
  const Reference reference{truth->mask, truth->classes, truth->nearest_caster, truth};
  auto complete = std::make_shared<Verdict>(*verdict);
  const bool is_done = causes_.run(ticket, [&] {
    complete->causes =
        find_causes({frame.scene(), frame.loaded->store->casters(frame.gbuffer.truth), frame.gbuffer, frame.light, reference,
                     mask, right_on_mesh, [&](std::span<const std::uint32_t> pixels) { return explain(pixels); }});
  });
  if (!is_done) return;
  complete->cause_counts = count_causes(complete->causes);
  complete->has_causes = true;
  complete->reference = truth;
  body_.change([&](EngineState&) {
    SideState& s = state();
    if (s.verdict == verdict) s.verdict = complete;
    s.words = support_.why();
  });
}

}  // namespace gnomon::viewer
