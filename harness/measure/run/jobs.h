#pragma once
#include "measure/row/contender_worker.h"
#include "measure/run/suite.h"

namespace gnomon {

/// One row to be: a technique with settings on one scene, light and view.
struct Job {
  std::string hash;                 ///< the same job has the same hash in every run and shard
  std::string scene, light, view;   ///< `light` as tables write it, see RowLights
  std::vector<std::string> lights;  ///< names; where the scene is not fetched that of `light` alone
  Contender contender;
  int width = 0, height = 0;
  std::string path;                      ///< that it follows, a path or an animation; empty: nothing moves
  int global_samples = 0;                ///< see SuiteGroup
  std::size_t place = 0;                 ///< position in the expanded suite
  std::optional<FrameTimes> times = {};  ///< of a row whose geometry moves; complete where the scene is there
  int frame_count = 1;                   ///< of the path; unknown, 1, where the scene is not fetched
  std::string title() const;             ///< "SCENE LIGHT [VIEW] [PATH] TECHNIQUE:SETTINGS", as of its record
  std::string motion() const;            ///< "frames 9 rate 60 start 0"; empty where the geometry stands still
};

/// Scenes of a run. A scene that is not fetched is kept with its reason. A suite may name a scene at many times: where those
/// that are there take more than 1 GiB of geometry, all are let go before the next is loaded, and loaded again when they are
/// needed.
class SceneLibrary {
 public:
  struct Entry {
    std::optional<Scene> scene;
    std::string missing;  ///< why there is no scene: it is not fetched
  };
  explicit SceneLibrary(std::size_t most_bytes = std::size_t{1} << 30) : most_bytes_(most_bytes) {}
  /// It may end the life of all entries that were got before, but not of that of the same name.
  const Entry& get(const std::string& reference);
  /// From now on the scene of this name is read from another place, as load_scene takes it; the first call for a name counts.
  void read_from(const std::string& reference, const std::string& place) { places_.emplace(reference, place); }
  void forget(const std::string& reference);
  std::size_t size() const { return entries_.size(); }
  /// Where the scene of this name is read.
  const std::string& place_of(const std::string& reference) const;

 private:
  std::map<std::string, std::unique_ptr<Entry>> entries_;
  std::size_t most_bytes_, bytes_ = 0;  ///< of geometry
  std::map<std::string, std::string> places_;
};

struct SuiteJobs {
  std::vector<Job> jobs;  ///< in order, each once
  /// Techniques that a group names by `*` and that support no scene and light of it, each once, in alphabetical order:
  /// "shadow_map: a shadow map has one center ...". They have no job in the group.
  std::vector<std::string> left_out;
};
/// All jobs of a suite. Workers query what techniques of a `*` support; one that does not answer stays: its rows report why.
/// Throws Error when a scene lacks a named light, view, path or animation, or one of these has a frame that cannot be drawn.
SuiteJobs expand_jobs(const Suite& suite, SceneLibrary& library, const WorkerOptions& worker);

/// The same row with another contender.
Job with_contender(Job job, Contender contender, const Suite& suite);

/// The first frame of the job's row. The scene is at rest, or the job's geometry moves: slides are made for a scene at rest.
RowFrame first_frame(const Job& job, const Scene& scene);
/// Every parameter of a contender with its value, number or text, as records have them.
Json parameters_of(const Contender& contender);
/// The job's record with all facts from before the run. `scene` is null where it is not fetched.
Record start_record(const Job& job, const Suite& suite, const Scene* scene, const Json& context);

}  // namespace gnomon
