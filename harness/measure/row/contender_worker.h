#pragma once
#include "measure/row/row.h"
#include "measure/worker/worker_client.h"
#include "measure/worker/worker_frame_maker.h"

namespace gnomon {

/// A frame of a row: all that its mask depends on but the technique, its settings and the truth.
struct RowFrame {
  std::vector<std::size_t> lights = {0};  ///< indices in the scene
  std::size_t view = 0;
  int width = 0, height = 0;
  std::optional<Path> path;
  int number = 0;          ///< on the path
  int global_samples = 0;  ///< light paths of a pixel of the reference of pictures of all light; 0: no such pictures

  int count() const { return path ? path->frame_count : 1; }  ///< frames of the row
};

/// Everything about one scene that its rows share.
struct SceneRun {
  struct Options {
    std::filesystem::path cache, scratch;  ///< folders of kept frames, and for files between this process and its workers
    AreaTarget target = {};                ///< of the reference under lights with area
    double timeout = 60;                   ///< seconds that one step of a worker may take
    TraceWatch watch = {};
    std::string program_that_traces = {};  ///< empty: this one
    TruthOver truth_over = TruthOver::center;
  };
  Scene scene;  ///< in the pose of the frame that `go_to` was called with last
  Options options;
  PosedScene posed;
  FrameStore frames;

  SceneRun(Scene the_scene, Options the_options)
      : scene(std::move(the_scene)),
        options(std::move(the_options)),
        posed(scene),
        frames(scene, options.cache,
               std::make_unique<WorkerFrameMaker>(options.scratch / "frames", options.program_that_traces, options.watch)) {}

  /// Moves the scene's meshes to where they are at the frame. Whatever reads the scene for a frame comes after it.
  void go_to(const RowFrame& frame);
  /// Moves them back to where they were when the run began.
  void go_to_rest() { posed.go_to(std::nullopt); }
  std::vector<Light> lights(const RowFrame& frame) const;
  // Both are for the frame that the scene is at.
  FrameKey key(const RowFrame& frame, Truth truth);
  FrameRequest request(const RowFrame& frame, Truth truth);
  /// All that the picture of a frame shows, as text: the same for frames that show the same.
  std::string shown(const RowFrame& frame, Truth truth);
};

/// A failure that says at which frame it was.
class FailureAtFrame : public WorkerFailure {
  using WorkerFailure::WorkerFailure;
};
/// Does something of a frame of a row. Where its worker fails, the failure says at which one, by its kind and number.
auto at_frame(std::string_view kind, int number, const auto& work) {
  try {
    return work();
  } catch (const FailureAtFrame&) {
    throw;
  } catch (const WorkerFailure& failure) {
    throw FailureAtFrame(fmt::format("{} (at {} {})", failure.what(), kind, number));
  }
}
/// The same of a frame of a path.
auto at_frame(int number, const auto& work) { return at_frame("frame", number, work); }

/// A worker that serves one technique with its settings on a scene, and its present frame of a row.
class ContenderWorker {
 public:
  ContenderWorker(SceneRun& run, std::string technique, std::string settings, const WorkerOptions& options);

  /// The worker loads scene and technique; in two parts, so that all workers of a batch can load at the same time.
  void begin_load();
  void end_load() { client_.end_load(); }
  /// Goes to a frame under a truth. Returns the technique's support, or the reference's where that has no answer. Where it
  /// begins a sequence, a technique that remembers forgets the frames before.
  Support go(const RowFrame& frame, Truth truth, bool begins_sequence = false);
  /// Objects that do setup and build for the frame: one for each of several lights where these share nothing, else one for each
  /// channel.
  std::size_t object_count() const;
  struct SetupTime {
    double ms = 0;
    OtherClocks other_clocks;
  };
  /// What setup took in this process for so many objects; does it at the first call.
  SetupTime setup_time();
  /// The technique's mask of the frame under each light beside the reference, causes left out; counts and memory go to `record`
  /// unless it is null.
  std::vector<Answer> answers(Record* record);
  /// Hands the technique what is exact at each pixel of the frame, once after each resolve of a sequence. Throws Error where
  /// the parts that it answers do not add up to the difference of these answers, which are of that resolve. Returns whether it
  /// answers any.
  bool check_error_terms(std::span<const Answer> answers);
  /// Of a technique that runs in a program of its own: what it counted of time, after more frames.
  void count_times_again(Record& record);
  /// The technique's picture of all light beside the reference's, both sums over the lights with area; nothing where the frame
  /// has no `global_samples`, the technique has no picture or refuses one of these lights, or the scene is endless.
  std::optional<GlobalAnswer> global_answer();
  /// Whether a light of the frame casts shadows.
  bool supports_light(std::size_t k) const { return static_cast<bool>(reply_.lights[k]); }
  /// Records the technique's support of each light of the frame.
  void note_lights(Record& record) const;
  /// Records the OpenGL of the worker.
  void note_gl(Record& record) const;
  /// Records the state of the card now, and at the load; nothing where it is unknown.
  void note_card(Record& record);
  /// Name of the frame's bare pass; empty: none.
  const std::string& floor() const { return reply_.floor; }
  WorkerClient& client() { return client_; }

 private:
  SceneRun& run_;
  std::string technique_, settings_;
  WorkerClient client_;
  FrameReply reply_{.support = Support::full(), .lights = {}, .floor = {}, .shares = {}};  ///< of the frame
  RowFrame frame_;
  Truth truth_ = Truth::shape;
  std::map<std::size_t, SetupTime> setup_times_;  ///< by objects
};

}  // namespace gnomon
