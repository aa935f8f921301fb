#pragma once
#include "measure/picture/picture.h"
#include "measure/record/record.h"
#include "measure/run/frame_worker.h"
#include "measure/run/jobs.h"
#include "measure/run/worker_client.h"
#include "measure/score/score.h"
#include "measure/score/together.h"

namespace gnomon {

/// A frame of a row: all that its mask depends on but the technique, its settings and the truth.
struct RowFrame {
  std::vector<std::size_t> lights = {0};  ///< indices in the scene
  std::size_t view = 0;
  int width = 0, height = 0;
  std::optional<Path> path;
  int number = 0;          ///< on the path
  int global_samples = 0;  ///< see SuiteGroup

  int count() const { return path ? path->frame_count : 1; }  ///< frames of the row
};

/// Everything about one scene that its rows share.
struct SceneRun {
  std::string reference;
  Scene scene;
  FrameStore frames;
  std::filesystem::path scratch;  ///< folder for files between this process and its workers
  const Suite& suite;

  SceneRun(std::string scene_reference, Scene the_scene, const Suite& the_suite, const std::filesystem::path& cache,
           std::filesystem::path scratch_folder, TraceWatch watch = {}, std::string program_that_traces = {})
      : reference(std::move(scene_reference)),
        scene(std::move(the_scene)),
        frames(scene, cache,
               std::make_unique<FrameWorker>(scratch_folder / "frames", std::move(program_that_traces), std::move(watch))),
        scratch(std::move(scratch_folder)),
        suite(the_suite) {}

  RowFrame first_frame(const Job& job) const;
  std::vector<Light> lights(const RowFrame& frame) const;
  FrameKey key(const RowFrame& frame, Truth truth) const;
  FrameRequest request(const RowFrame& frame, Truth truth);
};

/// All light toward the eye, three floats a pixel.
/// Of a row's mask file, where pictures of all light were asked for: "global.R" and so on, linear radiance.
inline constexpr std::string_view global_channel = "global", global_reference_channel = "global_reference";

struct GlobalAnswer {
  std::vector<float> picture, reference, error;  ///< the technique's; the reference's with its standard errors
  /// By light of the row; nothing of those without area, which have no radiance.
  std::vector<std::optional<Record::ReferenceFacts::GlobalFacts>> facts;
};

/// A worker that holds one contender of a scene, and the frame of a row that it was asked about last.
class ContenderWorker {
 public:
  ContenderWorker(SceneRun& run, const Contender& contender, const WorkerOptions& options);

  /// The worker loads scene and technique; in two parts, so that all workers of a batch can be at it at once.
  void begin_load();
  void end_load() { client_.end_load(); }
  /// Goes to a frame under a truth. What the technique says of it, or the reference where that cannot answer it.
  Support go(const RowFrame& frame, Truth truth);
  /// Objects that setup and build are done by for the frame: one for each of several lights where these share nothing.
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
  /// The technique's picture of all light beside the reference's, both sums over the lights with area; nothing where the frame
  /// does not ask for it, the technique has none or refuses one of these lights, or the scene is endless.
  std::optional<GlobalAnswer> global_answer();
  /// Whether a light of the frame casts shadows.
  bool supports_light(std::size_t k) const { return reply_.lights.empty() || reply_.lights[k]; }
  /// What the technique said of each light of the frame.
  void note_lights(Record& record) const;
  /// What GL it has, and what went up to it for the frame.
  void note_gl(Record& record) const;
  /// How the card does now, beside how it did when the worker was loaded; nothing where nobody knows.
  void note_card(Record& record);
  /// Name of the frame's bare pass; empty: none.
  const std::string& floor() const { return reply_.floor; }
  WorkerClient& client() { return client_; }

 private:
  SceneRun& run_;
  Contender contender_;
  WorkerClient client_;
  FrameReply reply_{.support = Support::full(), .upload = {}, .lights = {}, .floor = {}, .shares = {}};  ///< of the frame
  RowFrame frame_;
  Truth truth_ = Truth::shape;
  std::map<std::size_t, SetupTime> setup_times_;  ///< by objects
};

/// The answer under one light of a row.
struct MeasuredLight {
  Light light;  ///< that counts, which on a path is not the scene's
  Answer answer;
  std::optional<std::vector<float>> other_mask;  ///< under the other truth, where there are two
};
/// The answers of a row with their score.
struct MeasuredRow {
  std::vector<MeasuredLight> lights;
  std::optional<Together> together;  ///< of several lights
  std::optional<GlobalAnswer> global;
  ErrorCounts errors;

  const GBuffer& gbuffer() const { return lights.front().answer.gbuffer; }
  /// Of the light, of several of the lights together. This and the scene must outlive it.
  Evidence evidence(const Scene& scene) const;
  /// Its visibility shown: of several lights the share of the light that they would give.
  std::span<const float> mask() const { return together ? together->shown : lights.front().answer.mask; }
};
/// Makes `together` of several lights that have their answers.
void put_together(MeasuredRow& row, const Scene& scene);
/// The scene in the light that the row's masks let through.
Picture shade(const Scene& scene, const MeasuredRow& row);

/// All of a row but its times: counts, memory, classes, causes, metrics against both truths, what GL it ran on. The worker has
/// gone to `first` and ends there, under the headline truth. A row on a path is measured at every frame: metrics are means,
/// classes and causes sums over its frames, and the answer is that of the last one; a mean is there where every frame has the
/// metric (instability: every frame but the first). The record gets the worst support of all frames, and there is no answer
/// when one is unsupported.
std::optional<MeasuredRow> measure(Record& record, SceneRun& run, ContenderWorker& worker, const RowFrame& first);

/// A record with all that is known before anything runs. `scene` is null where it is not fetched.
Record start_record(const Job& job, const Suite& suite, const Scene* scene, const Json& context);

/// What a record knows of the scene itself.
void describe_scene(Record& record, const Scene& scene);

/// How well the reference of a light with area is known, over all pixels that it was asked for.
Record::ReferenceFacts reference_facts(const Reference& reference, LightShareKind estimates, const AreaTarget& target);

/// Writes the mask below `out` and names it in the record.
void write_mask(Record& record, const MeasuredRow& measured, const std::filesystem::path& out);
/// The same of error picture and shaded picture.
void write_pictures(Record& record, const Scene& scene, const MeasuredRow& measured, const std::filesystem::path& out);
/// Removes those that the record names.
void remove_pictures(const Record& record, const std::filesystem::path& out);

}  // namespace gnomon
