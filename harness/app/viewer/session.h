#pragma once
#include <gnomon/registry.h>

#include <map>
#include <memory>
#include <optional>
#include <string>

#include "app/viewer/compose.h"
#include "app/viewer/engine.h"
#include "app/viewer/keys.h"
#include "app/viewer/player.h"
#include "app/viewer/profile.h"

namespace gnomon::viewer {

/// What keys and buttons request of the window itself; it resets each when it is done.
struct Requests {
  bool save = false, copy_command = false, screenshot = false, quit = false;
};

/// All that the person has chosen. Panels, keys and mouse edit it through these calls; the engine follows its selection.
class Session {
 public:
  /// `loaded` is the scene that the selection names.
  Session(Selection selection, std::shared_ptr<const LoadedScene> loaded);

  const Selection& selection() const { return selection_; }
  Layout layout = Layout::split;
  Paint paint = Paint::shaded;
  double divider = 0.5;
  float layer_opacity = 0.8f;
  bool flicker_is_right = false;
  DifferenceScale difference;
  bool shows_contours = false, shows_silhouettes = false, shows_magnifier = true, shows_panels = true, shows_help = false;
  std::optional<ProfileLine> profile;  ///< along which masks and reference are plotted
  Requests requests;

  // The scene. The engine loads it; then `adopt` takes over its light and view.
  void choose_scene(const std::string& reference);
  /// Call `generator_changed` after setting its parameters. Null for scenes that are files.
  SceneGenerator* generator() { return generator_.get(); }
  void generator_changed();
  void set_truth(Truth truth) { selection_.truth = truth; }
  /// Takes over the selected scene when the engine has loaded it.
  void adopt(const EngineState& state);
  /// The scene that light and view belong to; null before the first.
  const Scene* scene() const { return loaded_ ? &loaded_->scene : nullptr; }

  // Light and view: one of the scene's by name, or moved. What `check` refuses throws Error and changes nothing.
  /// Alone, or of one of several channels all of these. Of several together the one that can be moved stays where it is.
  void choose_light(const std::string& name);
  /// As `--light` names several, "sun+lamp" or "all+", as one picture; the chosen one, else the first, can be moved. One alone
  /// is that light.
  void choose_together(const std::string& word);
  /// Back to where the scene has it.
  void reset_light();
  void choose_view(const std::string& name);
  void set_light(const Light& light);
  void set_view(const View& view);
  bool is_light_moved() const { return light_moved_; }
  bool is_view_moved() const { return view_moved_; }
  void set_size(int width, int height);
  /// Camera, light or a slider moves: true from now until a quarter of a second after the last call.
  void mark_moving();
  /// Seconds until the motion is over; nothing while nothing moves.
  std::optional<double> motion_left() const;
  /// Ends the motion when that time is over.
  void settle();
  /// Frames of full size while something moves.
  void set_full_while_moving(bool is_full) { selection_.full_while_moving = is_full; }
  /// Both sides do resolve once more, for its time.
  void do_again() { ++selection_.repeat; }
  /// Whether they do so whenever all is computed.
  bool repeats = false;

  // The time of a scene that moves. Scenes without animations say so.
  const Player& player() const { return player_; }
  /// The animation of this name from its first frame, paused; an empty name: at rest, as the file has it.
  void choose_animation(const std::string& name);
  void go_to_frame(int frame);
  void set_looping(bool loops) { player_.loops = loops; }
  /// While it plays, to the frame of this moment.
  void play_on();
  /// Seconds until another frame of the animation is due; nothing while it does not play.
  std::optional<double> frame_left() const;
  /// Shows the pose by itself, as a still of `gnomon render` does, until another time is shown: techniques build, and fit to
  /// that pose alone. Whether it did not do so before.
  bool show_still();

  // The sides. Call `technique_changed` after setting a technique's parameters.
  Technique& technique(int side) { return *technique_[side]; }
  const Technique& technique(int side) const { return *technique_[side]; }
  void choose_technique(int side, const std::string& id);
  void technique_changed(int side);
  void choose_layer(int side, const std::string& layer) { selection_.sides[side].layer = layer; }
  /// Starts a technique that failed anew.
  void start_again(int side) { ++selection_.sides[side].attempt; }
  void swap_sides();
  /// Measures the left side's error against samples, or drops the curve.
  void ask_for_curve(bool is_wanted) { selection_.curve = is_wanted ? ++curve_count_ : 0; }

  // The parameters of both sides and of the scene, by the names of their controls: "left.resolution", "scene.count".
  std::vector<std::string> parameter_names() const;
  /// Throws Error for a name that is none of these, and for a value that its row refuses.
  void set_parameter(const ParameterSetting& to);
  /// The one that keys change; empty until one is chosen.
  const std::string& chosen_parameter() const { return chosen_parameter_; }

  /// The pixel that is explained, of the full picture.
  std::optional<glm::ivec2> picked() const { return picked_; }
  void pick(std::optional<glm::ivec2> pixel);

  /// What a key does, `count` times where it goes on while held.
  void act(const KeyEffect& effect, double count = 1);

  /// A key of a script as the scene that is shown has it, or what it sets.
  void follow(const ScriptStep& step);

  /// A line for the person; an empty one takes the last away.
  void say(const std::string& text, bool is_warning = false);
  const std::string& message() const { return message_; }
  bool is_warning() const { return is_warning_; }

 private:
  void carry_out(Action action);
  void set_scene_parameter(const SceneSetting& to);
  void step_technique(int step);
  Parameter& parameter(const std::string& name) const;
  void step_parameters(const ParameterSteps& steps, double count);
  void next_layer();
  void flip_profile();
  void flip_together();
  void renew_together(const std::string& word);
  Player player_of(const std::string& animation) const;
  void renew_animation(bool is_same_scene);
  bool has_animation();
  void flip_playing();
  void step_frames(double count);
  void take_time();

  Selection selection_;
  std::shared_ptr<const LoadedScene> loaded_;
  std::unique_ptr<SceneGenerator> generator_;
  bool light_moved_ = false, view_moved_ = false, keeps_moved_ = false;
  std::optional<glm::ivec2> picked_;
  Player player_;
  double moving_until_ = 0;
  std::uint64_t curve_count_ = 0;
  std::string chosen_parameter_;
  double value_rest_ = 0;  ///< of a step of its value, while a key is held
  std::string message_;
  bool is_warning_ = false;
  /// Techniques that were on a side keep their settings.
  std::map<std::string, std::shared_ptr<Technique>> known_[2];
  std::shared_ptr<Technique> technique_[2];
};

/// Throws Error for a parameter that is not there when a script sets it, and for a value that it refuses. A script that steps
/// through techniques or scenes is followed that far.
void check_script(std::span<const ScriptStep> script, const Selection& selection, std::shared_ptr<const LoadedScene> loaded);

/// The part of a scene's reference before its settings: "composite" of "composite:object=cone". Of a file, its path.
std::string scene_id(const std::string& reference);

}  // namespace gnomon::viewer
