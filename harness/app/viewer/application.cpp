// The loop of the viewer: what happened becomes a wish, what is known becomes a picture. It sleeps while neither changes.
#include "app/viewer/application.h"

#include <gnomon/error.h>
#include <imgui.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <deque>
#include <utility>

#include "app/viewer/canvas.h"
#include "app/viewer/overlays.h"
#include "app/viewer/panels.h"
#include "app/viewer/picture_view.h"
#include "app/viewer/resolve_times.h"
#include "app/viewer/saving.h"
#include "app/viewer/speed_trial.h"
#include "app/viewer/stop_signals.h"
#include "app/viewer/style.h"
#include "app/viewer/window.h"

namespace gnomon::viewer {

namespace {

constexpr double flicker_seconds = 0.25;     // a side is shown for: 2 Hz
constexpr double least_seconds = 1 / 60.0;   // from one picture to the next
constexpr double moving_seconds = 1 / 25.0;  // while something moves and the picture stays as it is
constexpr int settling_frames = 3;           // that Dear ImGui needs after an event until nothing changes any more

/// Of keys that mean nothing to a field that text is typed into.
bool is_beside_text(Action action) {
  return action == Action::save || action == Action::screenshot || action == Action::panels || action == Action::quit;
}

class Application {
 public:
  explicit Application(const ViewOptions& options);
  int run();

 private:
  double pause() const;
  double next_picture() const;
  void update();
  void use_keys(const std::vector<WindowEvent>& events);
  void press_scripted();
  void act(Action action, double steps = 1);
  void draw();
  void count_frame();
  void draw_panels(const Shown& shown);
  void write_what_is_asked();
  void attempt(const std::function<void()>& work);
  bool is_finished() const { return state_.is_finished && state_.wish == wish_number_; }

  const ViewOptions& options_;
  Window window_;
  StopSignals stop_{Window::wake};
  Session session_;
  Album album_;
  std::vector<SceneListing> scenes_ = list_scenes();
  PictureView view_;
  std::atomic<bool> has_found_ = false;  // overlays found what they looked for
  Overlays overlays_{[this] {
    has_found_ = true;
    Window::wake();
  }};
  HeldKeys held_;
  Canvas canvas_;
  ResolveTimes times_;
  ControlPlaces places_;
  Arrangement arrangement_;
  EngineState state_;
  std::optional<Wish> told_;  // what the engine was told last
  std::uint64_t wish_number_ = 0;
  std::uint64_t drawn_state_ = 0;
  int frames_left_ = settling_frames;
  std::optional<double> tooltip_time_;  // when a tooltip may appear though nothing happens
  double last_frame_ = 0, frame_cost_ = 0;
  std::deque<double> frame_times_;  // of the last second: when the left side, or without it the right, showed a new frame
  std::uint64_t counted_frame_ = 0;
  std::size_t next_key_ = 0;
  bool is_over_ = false, has_drawn_finished_ = false;
  bool was_saved_early_ = false;
  bool has_failed_ = false;  // something that a script asked for
  std::optional<SpeedTrial> trial_;
  Engine engine_;  // the last one: it ends first, and its threads wake the window
};

Application::Application(const ViewOptions& options)
    : options_(options),
      window_("Gnomon: " + options.wish.scene),
      session_(options.wish, options.scene),
      album_(options.out, options.workers.plugins),
      engine_(options.workers, options.timeout_seconds, Window::wake) {
  engine_.offer(options.wish.scene, options.scene);
  if (options.speed_seconds > 0) trial_.emplace(options.speed_seconds);
  const double scale = window_.scale();
  window_.show(options.wish.width + static_cast<int>(std::lround(panel_width * scale)),
               options.wish.height + static_cast<int>(std::lround(strip_height * scale)));
}

/// Seconds that nothing will change by itself; below 0: for ever.
double Application::pause() const {
  const double now = Window::now();
  const double next_frame = next_picture();
  if (frames_left_ > 0 || held_.any() || state_.number != drawn_state_) return std::max(0.0, next_frame - now);
  double wait = -1;
  const auto until = [&](double seconds) {
    wait = wait < 0 ? std::max(seconds, 0.001) : std::min(wait, std::max(seconds, 0.001));
  };
  if (session_.layout == Layout::flicker) until(flicker_seconds - std::fmod(now, flicker_seconds));
  if (const auto left = session_.motion_left()) until(*left);
  if (tooltip_time_) until(*tooltip_time_ - now);
  if (options_.ends_by_itself) until(least_seconds);
  if (ImGui::GetIO().WantTextInput) until(0.3);
  const bool is_working = std::ranges::any_of(state_.sides, [](const SideState& side) { return side.phase <= Phase::working; });
  if (is_working && !state_.is_finished) until(0.1);
  return wait;
}

/// When the next picture may be drawn. The window leaves the processor to the workers at least half of the time, and more of it
/// while they are what is waited for.
double Application::next_picture() const {
  const bool is_waiting = session_.wish().is_moving && !canvas_.is_outdated(state_);
  return last_frame_ + std::max(is_waiting ? moving_seconds : least_seconds, 2 * frame_cost_);
}

int Application::run() {
  while (!window_.is_closing() && !is_over_) {
    const double wait = pause();
    window_.wait(wait);
    update();
    // Events that come in quick succession make one picture.
    const double now = Window::now();
    if (frames_left_ == 0 || now < next_picture()) continue;
    last_frame_ = now;
    --frames_left_;
    draw();
    write_what_is_asked();
    frame_cost_ = Window::now() - now;
    window_.present();
    if (trial_) trial_->presented(state_, Window::now());
    is_over_ = is_over_ || (trial_ && trial_->is_over());
  }
  if (trial_ && trial_->is_over()) fmt::print("{}", trial_->table());
  return has_failed_ ? 1 : 0;
}

void Application::attempt(const std::function<void()>& work) {
  try {
    work();
  } catch (const std::exception& error) {
    session_.say(error.what(), true);
    if (!options_.ends_by_itself) return;
    fmt::print(stderr, "{}\n", error.what());
    has_failed_ = true;
  }
}

void Application::act(Action action, double steps) {
  attempt([&] { session_.act(action, steps); });
}

void Application::use_keys(const std::vector<WindowEvent>& events) {
  for (const WindowEvent& event : events) {
    if (event.kind == WindowEvent::Kind::focus_lost) held_.release_all();
    if (event.kind != WindowEvent::Kind::key) continue;
    if (!event.is_pressed) {
      held_.release(event.code);
      continue;
    }
    const KeyRow* const row = find_key(event.code, event.modifiers);
    if (!row || (ImGui::GetIO().WantTextInput && !is_beside_text(row->action))) continue;
    if (row->is_held)
      held_.press(*row, Window::now());
    else
      act(row->action);
  }
  for (const auto& [action, steps] : held_.take(Window::now())) act(action, steps);
}

/// The next key of the script, when all that went before has had its effect.
void Application::press_scripted() {
  if (!options_.ends_by_itself || !is_finished() || !has_drawn_finished_ || session_.wish().is_moving) return;
  const Requests& asked = session_.requests;
  if (asked.save || asked.copy_command || asked.screenshot) return;
  if (next_key_ < options_.keys.size()) {
    act(options_.keys[next_key_++]->action);
    has_drawn_finished_ = false;
    frames_left_ = settling_frames;
    return;
  }
  if (options_.screenshot.empty() && !trial_) is_over_ = true;
}

void Application::update() {
  const EngineState fresh = engine_.state();
  if (fresh.number != state_.number) frames_left_ = std::max(frames_left_, 1);
  state_ = fresh;
  session_.adopt(state_);
  times_.note(session_.wish(), state_);
  const std::vector<WindowEvent> events = window_.take_events();
  if (window_.has_untold()) frames_left_ = settling_frames;
  if (!events.empty()) {
    frames_left_ = settling_frames;
    tooltip_time_ = Window::now() + 1.1 * tooltip_delay;
  } else if (tooltip_time_ && Window::now() >= *tooltip_time_) {
    frames_left_ = std::max(frames_left_, 1);
    tooltip_time_.reset();
  }
  if (held_.any() || has_found_.exchange(false)) frames_left_ = std::max(frames_left_, 1);
  if (state_.sides[0].phase <= Phase::working || state_.sides[1].phase <= Phase::working)
    if (!state_.is_finished) frames_left_ = std::max(frames_left_, 1);
  if (ImGui::GetIO().WantTextInput) frames_left_ = std::max(frames_left_, 1);
  const bool is_covered = session_.shows_help || ImGui::IsPopupOpen("", ImGuiPopupFlags_AnyPopup);
  attempt([&] { view_.use(events, arrangement_.picture, canvas_.composition(), is_covered, window_.scale(), session_); });
  use_keys(events);
  press_scripted();
  if (trial_ && next_key_ == options_.keys.size()) trial_->steer(session_, state_, is_finished(), Window::now());
  if (session_.repeats && has_drawn_finished_ && is_finished() && !session_.wish().is_moving) session_.do_again();
  session_.settle();
  const bool flicker = session_.layout == Layout::flicker && std::fmod(Window::now(), 2 * flicker_seconds) >= flicker_seconds;
  if (flicker != session_.flicker_is_right) frames_left_ = std::max(frames_left_, 1);
  session_.flicker_is_right = flicker;
  if (session_.requests.quit || stop_.is_asked()) is_over_ = true;
  // A window that is put away may have no size at all: what was shown stays.
  if (const glm::ivec2 size = window_.size(); size.x > 0 && size.y > 0) {
    arrangement_ = arrange(size, window_.scale(), session_.shows_panels);
    session_.set_size(arrangement_.picture.width, arrangement_.picture.height);
  }
  if (!told_ || !are_same(*told_, session_.wish())) {
    told_ = session_.wish();
    wish_number_ = engine_.wish(*told_);
    has_drawn_finished_ = false;
    frames_left_ = std::max(frames_left_, 1);
  }
}

void Application::count_frame() {
  const ComposeSide* const sides = canvas_.composition().sides;
  const Frame* const frame = sides[0].frame ? sides[0].frame.get() : sides[1].frame.get();
  const double now = Window::now();
  if (frame && std::exchange(counted_frame_, frame->number) != frame->number) frame_times_.push_back(now);
  while (!frame_times_.empty() && frame_times_.front() < now - 1) frame_times_.pop_front();
}

void Application::draw() {
  if (canvas_.compose(session_, state_, arrangement_.picture))
    window_.set_picture(canvas_.pixels(), canvas_.composition().width, canvas_.composition().height);
  count_frame();
  drawn_state_ = state_.number;
  Shown shown{.state = state_,
              .composition = canvas_.composition(),
              .times = times_,
              .legends = {canvas_.legend_of(0), canvas_.legend_of(1)},
              .texture = window_.picture_texture(),
              .frames_per_second = static_cast<double>(frame_times_.size())};
  if (session_.picked())
    shown.pixel = *session_.picked();
  else if (view_.mouse() && !view_.is_dragging())
    shown.pixel = glm::ivec2(glm::floor(*view_.mouse()));
  if (shown.pixel.x >= 0) shown.side = side_at(shown.composition, shown.pixel.x + 0.5);
  places_.clear();
  window_.begin_drawing();
  const PixelRect& place = arrangement_.picture;
  const auto unit = static_cast<float>(pixels_per_unit());
  ImGui::GetBackgroundDrawList()->AddImage(reinterpret_cast<ImTextureID>(static_cast<std::intptr_t>(window_.picture_texture())),
                                           {place.x / unit, place.y / unit},
                                           {(place.x + place.width) / unit, (place.y + place.height) / unit});
  overlays_.draw(place, session_, shown);
  has_drawn_finished_ = is_finished() && overlays_.is_complete();
  draw_panels(shown);
  if (view_.handle() == Doing::divider) ImGui::SetMouseCursor(ImGuiMouseCursor_ResizeEW);
  if (view_.handle() == Doing::light) ImGui::SetMouseCursor(ImGuiMouseCursor_Hand);
  window_.end_drawing();
}

void Application::draw_panels(const Shown& shown) {
  if (session_.shows_panels) {
    Widgets widgets(places_, [&](const std::string& why) { session_.say(why, true); });
    draw_controls(arrangement_.controls, session_, shown, scenes_, widgets);
    draw_strip(arrangement_.strip, session_, shown);
    if (widgets.is_dragging()) session_.mark_moving();
  }
  if (session_.shows_help) draw_help(window_.size(), session_);
}

void Application::write_what_is_asked() {
  Requests& asked = session_.requests;
  if (asked.copy_command) {
    asked.copy_command = false;
    attempt([&] {
      const std::string command = album_.save_command(session_);
      window_.set_clipboard(command);
      session_.say("copied: " + command);
    });
    frames_left_ = std::max(frames_left_, 1);
  }
  if (asked.screenshot) {
    asked.screenshot = false;
    attempt([&] { session_.say("written: " + album_.save_window(window_.read_picture()).string()); });
    frames_left_ = std::max(frames_left_, 1);
  }
  // A control may have changed the wish while this very picture was drawn.
  const bool is_as_wished = has_drawn_finished_ && !window_.has_untold() && are_same(*told_, session_.wish()) &&
                            !session_.wish().is_moving && canvas_.composition().layout == session_.layout &&
                            canvas_.composition().paint == session_.paint;
  if (asked.save && !is_as_wished) {
    if (!was_saved_early_) session_.say("saves as soon as all is computed");
    was_saved_early_ = true;
  } else if (asked.save) {
    asked.save = was_saved_early_ = false;
    attempt([&] {
      const auto places = window_json(window_.size(), window_.scale(), arrangement_.picture, places_, session_, state_);
      const std::filesystem::path folder = album_.save(session_, state_, canvas_.pixels(), window_.read_picture(), places);
      session_.say("saved: " + folder.string());
    });
    frames_left_ = std::max(frames_left_, 1);
  }
  const bool is_last = options_.ends_by_itself && has_drawn_finished_ && next_key_ == options_.keys.size();
  if (is_last && frames_left_ == 0 && !options_.screenshot.empty() && !asked.save && !session_.wish().is_moving) {
    write_window(options_.screenshot, window_.read_picture());
    is_over_ = true;
  }
}

}  // namespace

int run_viewer(const ViewOptions& options) {
  Application application(options);
  return application.run();
}

}  // namespace gnomon::viewer
