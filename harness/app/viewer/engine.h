#pragma once
#include <functional>
#include <memory>
#include <string>

#include "app/viewer/picture_parts.h"
#include "measure/worker/worker_process.h"

namespace gnomon::viewer {

/// A technique on one side of the picture.
struct SideSelection {
  std::string technique, settings;  ///< settings as `Parametrized::settings` writes them
  std::string layer;                ///< debug layer to draw; empty: none
  int attempt = 0;                  ///< raised to start the technique again after it failed
  friend bool operator==(const SideSelection&, const SideSelection&) = default;
};

/// As the command line writes it: ID, or ID:param=value,...
inline std::string written(const SideSelection& side) {
  return side.settings.empty() ? side.technique : side.technique + ":" + side.settings;
}

/// What is selected to be shown: a plain value that the window edits and the engine follows.
struct Selection {
  std::string scene;  ///< as `--scene`; when it is another one than before it is loaded
  /// The scene that light and view are of, as EngineState gave it; null until one is loaded. What was made of another one stays
  /// until the selection names the new one here.
  std::shared_ptr<const LoadedScene> loaded;
  Truth truth = Truth::shape;
  Light light;  ///< one of the scene's, perhaps moved
  /// Several lights that are shown together, as the scene has them and in its order; `light` replaces the one of its
  /// name, which is one of them, and its other channels are where it is. Empty: it is alone.
  std::vector<Light> together = {};
  View view;  ///< one of the scene's, perhaps moved
  /// The time of an animation of `loaded` at which its meshes are shown; nothing: at rest.
  std::optional<RowPose> at = {};
  int width = 960, height = 540;
  bool is_moving = false;          ///< camera or light is under way: smaller frames will do
  bool full_while_moving = false;  ///< they will not
  std::array<SideSelection, 2> sides;
  std::optional<std::uint32_t> picked;  ///< pixel of the full picture to be explained
  std::uint64_t repeat = 0;             ///< raised to have both sides do resolve once more, for its time
  /// Another number than before to have the left side's error measured against samples; 0: no curve. It is dropped when
  /// anything but the picked pixel is selected anew.
  std::uint64_t curve = 0;
};

/// The lights that a list offers: each, and after one of several channels each of these alone.
std::vector<Light> listed_lights(const Scene& scene);
/// The light of that name: one, or its channels. A scene that lacks it gives the light that it is a channel of, else its first.
std::vector<Light> lights_named(const Scene& scene, const std::string& name);
/// The lights that are shown, one at least; the one that can be moved where it was moved to, with its other channels.
std::vector<Light> lights_of(const Selection& selection);
/// Whether a frame is under the selected lights, and the same of them can be moved.
bool is_lit_by(const Frame& frame, const Selection& selection);
/// What `--light` calls those that are shown together, of so many that there are: "all+", "sun+lamp", of the three channels of
/// sun "sun"; empty where one is alone.
std::string together_word(const Selection& selection, std::size_t all_count);

/// Whether engine and workers would do the same for both.
bool are_same(const Light& a, const Light& b);
bool are_same(std::span<const Light> a, std::span<const Light> b);
bool are_same(const View& a, const View& b);
bool are_same(const Selection& a, const Selection& b);

enum class Phase { starting, working, done, unsupported, failed };
inline constexpr const char* phase_names[] = {"starting", "working", "done", "unsupported", "failed"};

struct SideState {
  Phase phase = Phase::starting;
  std::string words = {};     ///< what it does now ("setup"), or why it is unsupported or failed
  double seconds = 0;         ///< that the present request has taken
  double progress = 0;        ///< share of it that is done, 0 .. 1; 0 where the technique does not report it
  bool is_reference = false;  ///< it shows the reference itself, which no worker computes
  std::shared_ptr<const SideAnswer> answer = nullptr;
  std::shared_ptr<const Counts> counts;  ///< of `counted_answer`; null until there is one
  std::shared_ptr<const SideAnswer> counted_answer;
  std::shared_ptr<const Verdict> verdict;  ///< of `answer`, or of one before
  std::shared_ptr<const LayerPicture> layer;
  std::shared_ptr<const Explanation> explanation;      ///< of the picked pixel, for `answer`; null where there is none
  std::shared_ptr<const DepthCurve> depth_curve;       ///< of the picked pixel, too; null of techniques that hold none
  std::optional<std::uint32_t> explained;              ///< the pixel of `explanation`
  std::shared_ptr<const SideAnswer> explained_answer;  ///< the answer that `explanation` is of
  StageTimes newest_ms;                                ///< the last time that each stage was done
  std::uint64_t answer_count = 0;                      ///< how often resolve was done since the worker started
  std::string renderer;                                ///< what draws, of a technique that draws; else empty

  bool is_approximate() const { return answer && answer->support.kind() == Support::Kind::approximate; }
};

/// All that is computed so far. Copies are cheap.
struct EngineState {
  std::uint64_t number = 0;                   ///< counts up with every change
  std::uint64_t selection_number = 0;         ///< of the selection that it follows: how often `select` was called
  std::shared_ptr<const LoadedScene> loaded;  ///< the scene loaded last
  std::string scene_error;                    ///< why the selected scene could not be loaded; the one before stays
  bool is_loading = false;
  std::string trouble;                              ///< what keeps the viewer itself from working: no memory, a full disk
  std::shared_ptr<const Frame> frame;               ///< the newest
  std::shared_ptr<const ReferenceState> reference;  ///< the newest
  std::array<SideState, 2> sides;
  std::shared_ptr<const SampleCurve> curve;  ///< null where none is measured
  bool is_finished = false;                  ///< nothing is left to do: full frame, both sides, reference, classes, causes
};

/// The samples that a curve measures: 1, 4, 16, ... as far as the range of the parameter `samples` goes. None where there is no
/// such parameter.
std::vector<int> curve_samples(const Parametrized& technique);

/// Follows what is selected, in the background: loads scenes, makes frames, has a worker process for each side, computes the
/// reference and refines it. No call waits for any of that.
class Engine {
 public:
  /// `changed` is called from any thread after every change of the state.
  Engine(WorkerOptions workers, double timeout_seconds, std::function<void()> changed);
  ~Engine();  ///< ends the workers
  Engine(const Engine&) = delete;
  Engine& operator=(const Engine&) = delete;

  /// Before the first selection: a scene that need not be loaded again. The engine makes its store.
  void offer(std::shared_ptr<LoadedScene> loaded);
  /// Returns the number of this selection.
  std::uint64_t select(const Selection& selection);
  EngineState state() const;

 private:
  struct Body;
  std::unique_ptr<Body> body_;
};

}  // namespace gnomon::viewer
