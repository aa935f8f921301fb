#pragma once
#include <gnomon/registry.h>

#include <map>
#include <memory>
#include <optional>
#include <string>

#include "app/viewer/compose.h"
#include "app/viewer/engine.h"
#include "app/viewer/keys.h"

namespace gnomon::viewer {

/// What keys and buttons ask of the window itself.
struct Requests {
  bool save = false, copy_command = false, screenshot = false, quit = false;
};

/// All that the person has chosen. Panels, keys and mouse edit it through these calls; the engine follows its wish.
class Session {
 public:
  /// The scene that the wish names, loaded already.
  Session(Wish wish, const Scene& scene);

  const Wish& wish() const { return wish_; }
  Layout layout = Layout::split;
  Paint paint = Paint::shaded;
  double divider = 0.5;
  float layer_opacity = 0.8f;
  bool flicker_is_right = false;
  bool shows_silhouettes = false, shows_magnifier = true, shows_panels = true, shows_help = false;
  Requests requests;

  // The scene. Its light and view are there when the engine has loaded it; `adopt` takes them over then.
  void choose_scene(const std::string& reference);
  /// Its rows may be set; then `generator_changed`. Null for scenes that are files.
  SceneGenerator* generator() { return generator_.get(); }
  void generator_changed();
  void set_truth(Truth truth) { wish_.truth = truth; }
  /// Looks for a scene that was wished and has been loaded.
  void adopt(const EngineState& state);
  /// The scene that light and view belong to; null before the first.
  const Scene* scene() const { return loaded_ ? &loaded_->scene : nullptr; }

  // Light and view: one of the scene's by name, or moved. Those that are none (Error) leave everything as it is.
  void choose_light(const std::string& name);
  void choose_view(const std::string& name);
  void set_light(const Light& light);
  void set_view(const View& view);
  void reset_light() { choose_light(wish_.light.name); }
  void reset_view() { choose_view(wish_.view.name); }
  bool is_light_moved() const { return light_moved_; }
  bool is_view_moved() const { return view_moved_; }
  void set_size(int width, int height);
  /// Something is under way for as long as this is called once a frame, and a quarter of a second longer.
  void mark_moving();
  /// Seconds until a motion is over; nothing while there is none.
  std::optional<double> motion_left() const;
  void settle();
  /// Frames of full size while something moves.
  void set_full_while_moving(bool is_full) { wish_.full_while_moving = is_full; }
  /// Both sides do resolve once more, for its time.
  void do_again() { ++wish_.repeat; }
  /// They do so whenever all is computed.
  bool repeats = false;

  // The sides. A technique's rows may be set; then `technique_changed`.
  Technique& technique(int side) { return *technique_[side]; }
  void choose_technique(int side, const std::string& id);
  void technique_changed(int side);
  void choose_layer(int side, const std::string& layer) { wish_.sides[side].layer = layer; }
  /// Starts a technique that failed anew.
  void start_again(int side) { ++wish_.sides[side].attempt; }
  void swap_sides();

  /// The pixel that is explained, of the full picture.
  std::optional<glm::ivec2> picked() const { return picked_; }
  void pick(std::optional<glm::ivec2> pixel);

  /// What the key of an action does, `steps` times where it goes on while held.
  void act(Action action, double steps = 1);

  /// A line for the person; an empty one takes the last away.
  void say(const std::string& text, bool is_warning = false);
  const std::string& message() const { return message_; }
  bool is_warning() const { return is_warning_; }
  /// Seconds since the message.
  double message_age() const;

 private:
  void object_of_composite(const char* object);
  void step_technique(int step);
  void next_layer();

  Wish wish_;
  std::shared_ptr<const LoadedScene> loaded_;
  std::unique_ptr<SceneGenerator> generator_;
  bool light_moved_ = false, view_moved_ = false, keeps_moved_ = false;
  std::optional<glm::ivec2> picked_;
  double moving_until_ = 0;
  std::string message_;
  bool is_warning_ = false;
  double message_time_ = -1e9;
  /// Techniques that were on a side keep their settings.
  std::map<std::string, std::shared_ptr<Technique>> known_[2];
  std::shared_ptr<Technique> technique_[2];
};

/// Whether engine and workers would do the same for both.
bool are_same(const Light& a, const Light& b);
bool are_same(const View& a, const View& b);
bool are_same(const Wish& a, const Wish& b);

}  // namespace gnomon::viewer
