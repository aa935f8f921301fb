#pragma once
#include <filesystem>

#include "measure/frame/frame.h"
#include "measure/record/record.h"
#include "measure/run/jobs.h"
#include "measure/run/worker.h"
#include "measure/score/score.h"

namespace gnomon {

/// Where a row stands: all that its mask depends on but the technique and its settings.
struct Standpoint {
  std::size_t light = 0, view = 0;  ///< indices in the scene
  int width = 0, height = 0;
  std::optional<Path> path;
  int frame = 0;  ///< on the path

  int frame_count() const { return path ? path->frame_count : 1; }
};

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
  Standpoint place(const Job& job) const;
  Light light(const Standpoint& place) const;
  FrameKey key(const Standpoint& place, Truth truth) const;
};

/// A contender's seat in one process: its worker and the frame it stands at.
class Seat {
 public:
  Seat(SceneRun& run, const Contender& contender, const WorkerOptions& options);

  /// The worker loads scene and technique; split in two so that all seats can do it at once.
  void open_begin();
  void open_end();
  /// Goes to a place under a truth. Answers the support.
  Support go(const Standpoint& place, Truth truth);
  /// What setup took in this process; does it at the first call.
  double setup_ms();
  /// Does build, relight or resolve once more.
  double time(Stage stage);
  /// Mask of the frame it stands at, its causes left out; counts and memory go to `record` when it is not null.
  Answer answer(Record* record);
  /// What the technique says of these pixels of its last answer; nothing where it says nothing.
  std::vector<std::optional<Explanation>> explain(std::span<const std::uint32_t> pixels);
  const Json& gl() const { return gl_; }
  const Json& frame_reply() const { return frame_reply_; }
  Worker& worker() { return worker_; }

 private:
  SceneRun& run_;
  Contender contender_;
  Worker worker_;
  Json gl_, frame_reply_;
  Standpoint place_;
  Truth truth_ = Truth::shape;
  std::optional<double> setup_ms_;
};

/// A record with all that is known before anything runs.
Record start_record(const Job& job, const Suite& suite, const Scene* scene, const Json& context);

/// An answer with its score.
struct MeasuredRow {
  Light light;  ///< that counts, which on a path is not the scene's
  Answer answer;
  ErrorCounts errors;
  std::optional<std::vector<float>> other_mask;  ///< under the other truth, where there are two
};

/// All of a row but its times, at the place where the seat stands: counts, memory, classes, causes, metrics against both
/// truths, what GL it ran on. A row on a path is measured at every frame: metrics are means, classes and causes sums over its
/// frames, and the answer is that of the last one; a mean is there where every frame has the metric (instability: every frame
/// but the first). The seat ends at the first frame under the headline truth. What the technique says of its support counts at
/// every frame: the record gets the worst of it, and there is no answer when one is unsupported.
std::optional<MeasuredRow> measure(Record& record, SceneRun& run, Seat& seat, const Standpoint& place);

/// Writes mask, error and shaded picture below `out` and names them in the record.
void write_pictures(Record& record, const SceneRun& run, const MeasuredRow& measured, const std::filesystem::path& out);
/// Removes those that the record names.
void remove_pictures(const Record& record, const std::filesystem::path& out);

/// Leaves what was asked, where, and what the technique said of its support: all that was measured goes.
void forget_results(Record& record);

}  // namespace gnomon
