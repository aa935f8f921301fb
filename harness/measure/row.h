#pragma once
#include <filesystem>

#include "measure/frame.h"
#include "measure/jobs.h"
#include "measure/record.h"
#include "measure/score.h"
#include "measure/worker.h"

namespace gnomon {

/// Everything about one scene that its rows share.
struct SceneRun {
  std::string reference;
  Scene scene;
  FrameStore frames;
  std::filesystem::path scratch;  ///< for masks on their way from a worker
  const Suite& suite;

  SceneRun(std::string scene_reference, Scene the_scene, const Suite& the_suite, const std::filesystem::path& cache,
           std::filesystem::path scratch_folder)
      : reference(std::move(scene_reference)),
        scene(std::move(the_scene)),
        frames(scene, cache),
        scratch(std::move(scratch_folder)),
        suite(the_suite) {}

  std::size_t light_index(const std::string& name) const;
  std::size_t view_index(const std::string& name) const;
  FrameKey key(std::size_t view, Truth truth) const {
    return {scene.views[view], suite.width, suite.height, scene.has_curved_shapes() ? truth : Truth::shape};
  }
};

/// A contender's seat in one process: its worker and the frame it stands at.
class Seat {
 public:
  Seat(SceneRun& run, const Contender& contender, const WorkerOptions& options);

  /// The worker loads scene and technique; split in two so that all seats can do it at once.
  void open_begin();
  void open_end();
  /// Goes to a light and view under a truth. Answers the support.
  Support go(std::size_t light, std::size_t view, Truth truth);
  /// What setup took in this process; does it at the first call.
  double setup_ms();
  /// Does build, relight or resolve once more.
  double time(Stage stage);
  /// Mask and coverage of the frame it stands at; counts and memory go to `record` when it is not null.
  Answer answer(Record* record);
  const Json& gl() const { return gl_; }
  const Json& frame_reply() const { return frame_reply_; }
  Worker& worker() { return worker_; }

 private:
  SceneRun& run_;
  Contender contender_;
  Worker worker_;
  Json gl_, frame_reply_;
  std::size_t light_ = 0, view_ = 0;
  Truth truth_ = Truth::shape;
  std::optional<double> setup_ms_;
};

/// A record with all that is known before anything runs.
Record start_record(const Job& job, const Suite& suite, const Scene* scene, const Json& context);

/// An answer with its score.
struct Measured {
  Answer answer;
  Tally tally;
};

/// All of a row but its times, at the light and view where the seat stands: counts, memory, classes, metrics against both
/// truths, what GL it ran on. The seat ends where it began.
Measured measure(Record& record, SceneRun& run, Seat& seat);

/// Writes mask, error and shaded picture below `out` and names them in the record.
void write_pictures(Record& record, const SceneRun& run, const Measured& measured, const std::filesystem::path& out);

}  // namespace gnomon
