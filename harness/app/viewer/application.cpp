// The loop of the viewer: events change what is selected, the engine computes that, and what it has computed so far is drawn.
// The loop sleeps while nothing changes.
#include "app/viewer/application.h"

#include <imgui.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <utility>

#include "app/viewer/frame_pace.h"
#include "app/viewer/overlays.h"
#include "app/viewer/picture_view.h"
#include "app/viewer/saving.h"
#include "app/viewer/side_names.h"
#include "app/viewer/speed_trial.h"
#include "measure/notice.h"

namespace gnomon::viewer {

namespace {

constexpr double flicker_seconds = 0.25;  // that a side is shown for: 2 Hz

/// Whether a key works also while text is typed into a field, which has no use for it.
bool works_while_typing(const KeyRow& row) {
  constexpr Action working[] = {Action::save, Action::screenshot, Action::panels, Action::quit};
  return std::ranges::any_of(working, [&](Action action) { return row.effect == KeyEffect(action); });
}

class Application {
 public:
  explicit Application(const ViewOptions& options)
      : options_(options),
        window_("Gnomon: " + options.selection.scene),
        session_(options.selection, options.loaded),
        files_(options.out, options.workers.plugins),
        engine_(options.workers, options.timeout_seconds, Window::wake) {
    engine_.offer(options.loaded);
    if (options.speed_seconds > 0) trial_.emplace(options.speed_seconds);
    const double scale = window_.scale();
    window_.show(options.selection.width + static_cast<int>(std::lround(panel_width * scale)),
                 options.selection.height + static_cast<int>(std::lround(strip_height * scale)));
  }

  int run() {
    while (!window_.is_closing() && !is_over_) {
      window_.wait(pause());
      update();
      // Events that come in quick succession make one picture.
      const double now = Window::now();
      if (pace_.left() == 0 || now < next_frame()) continue;
      pace_.begin(now);
      draw();
      serve_requests();
      pace_.end(Window::now());
      window_.present();
      if (trial_) trial_->presented(state_, Window::now());
      is_over_ = is_over_ || (trial_ && trial_->is_over());
    }
    if (trial_ && trial_->is_over()) fmt::print("{}", trial_->table());
    return has_failed_ ? 1 : 0;
  }

 private:
  /// Seconds until something changes without an event: an animation, a clock that is shown, a held key. Below 0: never.
  double pause() const {
    const double now = Window::now();
    if (pace_.left() > 0 || held_.any() || state_.number != drawn_state_) return std::max(0.0, next_frame() - now);
    double wait = -1;
    const auto until = [&](double seconds) {
      wait = wait < 0 ? std::max(seconds, 0.001) : std::min(wait, std::max(seconds, 0.001));
    };
    if (session_.layout == Layout::flicker) until(flicker_seconds - std::fmod(now, flicker_seconds));
    if (const auto left = session_.motion_left()) until(*left);
    if (const auto left = session_.frame_left()) until(*left);
    if (tooltip_time_) until(*tooltip_time_ - now);
    if (options_.ends_by_itself) until(FramePace::least_seconds);
    if (ImGui::GetIO().WantTextInput) until(0.3);
    if (is_working()) until(0.1);
    return wait;
  }

  /// Whether a side shows how long it has been at work.
  bool is_working() const {
    const auto works = [](const SideState& side) { return side.phase <= Phase::working; };
    return !state_.is_finished && std::ranges::any_of(state_.sides, works);
  }

  double next_frame() const { return pace_.next(session_.selection().is_moving && !canvas_.is_outdated(state_)); }

  void attempt(const std::function<void()>& work) {
    try {
      work();
    } catch (const std::exception& error) {
      session_.say(error.what(), true);
      if (!options_.ends_by_itself) return;
      print_notice("{}\n", error.what());
      has_failed_ = true;
    }
  }

  void act(const KeyRow& row, double count = 1) {
    attempt([&] { session_.act(row.effect, count); });
  }

  void use_keys(const std::vector<WindowEvent>& events) {
    for (const WindowEvent& event : events) {
      if (event.kind == WindowEvent::Kind::focus_lost) held_.release_all();
      if (event.kind != WindowEvent::Kind::key) continue;
      if (!event.is_pressed) {
        held_.release(event.code);
        continue;
      }
      const KeyRow* const row = key_table().find(event.code, event.modifiers, scene_id(session_.selection().scene));
      if (!row || (ImGui::GetIO().WantTextInput && !works_while_typing(*row))) continue;
      if (row->is_held) {
        held_.press(*row, Window::now());
      } else {
        take_held_steps();  // of keys that were pressed before
        act(*row);
      }
    }
    take_held_steps();
  }

  void take_held_steps() {
    for (const auto& [row, count] : held_.take(Window::now())) act(*row, count);
  }

  /// The next key of the script, when all that went before has had its effect.
  void press_scripted() {
    if (!options_.ends_by_itself || !is_finished() || !has_drawn_finished_ || session_.selection().is_moving) return;
    const Requests& requests = session_.requests;
    if (requests.save || requests.copy_command || requests.screenshot) return;
    if (next_key_ < options_.keys.size()) {
      attempt([&] { session_.follow(options_.keys[next_key_++]); });
      has_drawn_finished_ = false;
      pace_.need(FramePace::settling);
      return;
    }
    if (options_.screenshot.empty() && !trial_) is_over_ = true;
  }

  void update() {
    take_state();
    // What is done before the first scene is there waits for it: camera and light come with it.
    const bool is_opening = !state_.loaded && state_.scene_error.empty() && !session_.selection().scene.empty();
    const std::vector<WindowEvent> events = is_opening ? std::vector<WindowEvent>() : window_.take_events();
    expect_frames(events);
    const bool is_covered = session_.shows_help || ImGui::IsPopupOpen("", ImGuiPopupFlags_AnyPopup);
    attempt([&] { view_.use(events, arrangement_.picture, canvas_.composition(), is_covered, window_.scale(), session_); });
    use_keys(events);
    press_scripted();
    if (trial_ && next_key_ == options_.keys.size()) trial_->steer(session_, state_, is_finished(), Window::now());
    if (session_.repeats && has_drawn_finished_ && is_finished() && !session_.selection().is_moving) session_.do_again();
    session_.play_on();
    session_.settle();
    const bool flicker = session_.layout == Layout::flicker && std::fmod(Window::now(), 2 * flicker_seconds) >= flicker_seconds;
    if (flicker != session_.flicker_is_right) pace_.need(1);
    session_.flicker_is_right = flicker;
    if (session_.requests.quit || stop_.is_asked()) is_over_ = true;
    arrange_window();
    send_selection();
  }

  void take_state() {
    const EngineState fresh = engine_.state();
    if (fresh.number != state_.number) pace_.need(1);
    state_ = fresh;
    session_.adopt(state_);
    times_.note(session_.selection(), state_);
  }

  /// Whatever shows that time goes by, or may change with these events, takes new frames.
  void expect_frames(const std::vector<WindowEvent>& events) {
    if (!events.empty() || window_.has_button_events()) pace_.need(FramePace::settling);
    if (!events.empty()) {
      tooltip_time_ = Window::now() + 1.1 * tooltip_delay;
    } else if (tooltip_time_ && Window::now() >= *tooltip_time_) {
      pace_.need(1);
      tooltip_time_.reset();
    }
    const bool has_overlay = overlay_is_ready_.exchange(false);
    if (held_.any() || has_overlay || is_working() || ImGui::GetIO().WantTextInput) pace_.need(1);
  }

  void arrange_window() {
    const glm::ivec2 size = window_.size();
    if (size.x <= 0 || size.y <= 0) return;  // a minimized window has no size: what was shown stays
    arrangement_ = arrange(size, window_.scale(), session_.shows_panels);
    session_.set_size(arrangement_.picture.width, arrangement_.picture.height);
  }

  void send_selection() {
    if (sent_selection_ && are_same(*sent_selection_, session_.selection())) return;
    sent_selection_ = session_.selection();
    selection_number_ = engine_.select(*sent_selection_);
    has_drawn_finished_ = false;
    pace_.need(1);
  }

  void draw() {
    if (canvas_.compose(session_, state_, arrangement_.picture))
      window_.set_picture(canvas_.pixels(), canvas_.composition().width, canvas_.composition().height);
    const ComposeSide* const sides = canvas_.composition().sides;
    const Frame* const frame = sides[0].frame ? sides[0].frame.get() : sides[1].frame.get();
    rate_.note(frame ? frame->number : 0, Window::now());
    drawn_state_ = state_.number;
    PanelData shown{.state = state_,
                    .composition = canvas_.composition(),
                    .times = times_,
                    .titles = {title_of(session_, 0), title_of(session_, 1)},
                    .legends = {canvas_.legend_of(0), canvas_.legend_of(1)},
                    .texture = window_.picture_texture(),
                    .frames_per_second = static_cast<double>(rate_.count())};
    if (session_.picked())
      shown.pixel = *session_.picked();
    else if (view_.mouse() && !view_.is_dragging())
      shown.pixel = glm::ivec2(glm::floor(*view_.mouse()));
    if (shown.pixel.x >= 0) shown.side = side_at(shown.composition, shown.pixel.x + 0.5);
    places_.clear();
    window_.begin_drawing();
    const PixelRect& place = arrangement_.picture;
    const auto unit = static_cast<float>(pixels_per_unit());
    ImGui::GetBackgroundDrawList()->AddImage(
        reinterpret_cast<ImTextureID>(static_cast<std::intptr_t>(window_.picture_texture())), {place.x / unit, place.y / unit},
        {(place.x + place.width) / unit, (place.y + place.height) / unit});
    overlays_.draw(place, session_, shown);
    has_drawn_finished_ = is_finished() && overlays_.is_complete();
    draw_panels(shown);
    if (view_.handle() == DragKind::divider) ImGui::SetMouseCursor(ImGuiMouseCursor_ResizeEW);
    if (view_.handle() == DragKind::light || view_.handle() == DragKind::size) ImGui::SetMouseCursor(ImGuiMouseCursor_Hand);
    window_.end_drawing();
  }

  void draw_panels(const PanelData& shown) {
    if (session_.shows_panels) {
      Widgets widgets(places_, [&](const std::string& why) { session_.say(why, true); });
      widgets.mark(session_.chosen_parameter(),
                   std::exchange(marked_, session_.chosen_parameter()) != session_.chosen_parameter());
      draw_controls(arrangement_.controls, session_, shown, scenes_, widgets);
      draw_strip(arrangement_.strip, session_, shown);
      if (widgets.is_dragging()) session_.mark_moving();
    }
    if (session_.shows_help) draw_help(window_.size(), session_);
  }

  void serve_requests() {
    Requests& requests = session_.requests;
    if (std::exchange(requests.copy_command, false)) {
      attempt([&] {
        const std::string command = files_.save_command(session_);
        window_.set_clipboard(command);
        session_.say("copied: " + command);
      });
      pace_.need(1);
    }
    if (std::exchange(requests.screenshot, false)) {
      attempt([&] { session_.say("written: " + files_.save_window(window_.read_picture()).string()); });
      pace_.need(1);
    }
    if (requests.save) save();
    const bool is_last = options_.ends_by_itself && has_drawn_finished_ && next_key_ == options_.keys.size();
    if (is_last && pace_.left() == 0 && !options_.screenshot.empty() && !requests.save && !session_.selection().is_moving) {
      write_window(options_.screenshot, window_.read_picture());
      is_over_ = true;
    }
  }

  /// Saves when the picture that was just drawn is the selected one, whole and at rest; else leaves the request for a later
  /// picture. A pose of an animation becomes a still first, which is what the saved command renders. A control may have changed
  /// the selection while this picture was drawn.
  void save() {
    if (session_.show_still()) pace_.need(1);
    const bool shows_selection = has_drawn_finished_ && !window_.has_button_events() &&
                                 are_same(*sent_selection_, session_.selection()) && !session_.selection().is_moving &&
                                 canvas_.shows_choices_of(session_);
    if (!shows_selection) {
      if (!save_is_announced_) session_.say("saves as soon as all is computed");
      save_is_announced_ = true;
      return;
    }
    session_.requests.save = save_is_announced_ = false;
    attempt([&] {
      const DrawnWindow window{window_.read_picture(), window_.scale(), arrangement_.picture, places_};
      session_.say("saved: " + files_.save(session_, state_, canvas_.composition(), canvas_.pixels(), window).string());
    });
    pace_.need(1);
  }

  bool is_finished() const { return state_.is_finished && state_.selection_number == selection_number_; }

  const ViewOptions& options_;
  Window window_;
  StopSignals stop_{Window::wake};
  Session session_;
  SavedFiles files_;
  std::vector<SceneListing> scenes_ = list_scenes();
  PictureView view_;
  std::atomic<bool> overlay_is_ready_ = false;  // a search in the background has ended
  Overlays overlays_{[this] {
    overlay_is_ready_ = true;
    Window::wake();
  }};
  HeldKeys held_;
  Canvas canvas_;
  ResolveTimes times_;
  ControlPlaces places_;
  Arrangement arrangement_;
  EngineState state_;
  std::optional<Selection> sent_selection_;  // to the engine, the last one
  std::uint64_t selection_number_ = 0;
  std::uint64_t drawn_state_ = 0;
  FramePace pace_;
  FrameRate rate_;
  std::string marked_;                  // the parameter that stood out in the last picture
  std::optional<double> tooltip_time_;  // when a tooltip may appear though nothing happens
  std::size_t next_key_ = 0;
  bool is_over_ = false;
  bool has_drawn_finished_ = false;  // the last picture showed all that is computed for the selection
  bool save_is_announced_ = false;   // a request to save waits, and the status line says so
  bool has_failed_ = false;          // something that a script requested
  std::optional<SpeedTrial> trial_;
  Engine engine_;  // the last member, so that it is destroyed first: its threads wake the window
};

}  // namespace

int run_viewer(const ViewOptions& options) { return Application(options).run(); }

}  // namespace gnomon::viewer
