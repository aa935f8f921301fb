#pragma once
#include <gnomon/technique.h>

#include "measure/scratch_folder.h"
#include "measure/worker/shared_count.h"
#include "measure/worker/worker_process.h"

namespace gnomon {

/// What a worker serves: one technique with its settings, on one scene.
struct TechniqueOnScene {
  std::filesystem::path scene_file;  ///< with scene_bytes
  std::string technique, settings;   ///< id; "a=1,b=2"
};

/// Lights, mostly one, and a view of the worker's scene; on a path, where that has moved one of them to.
struct SceneLightAndView {
  std::vector<std::size_t> lights = {0};  ///< indices in the scene
  std::size_t view = 0;
  std::string path = {};  ///< its name; empty: neither moves
  int path_frame = 0;
};
/// The same, but they need not be the scene's.
struct FreeLightAndView {
  std::vector<Light> lights;
  View view;
};

/// Both as bytes: the same for the same numbers and names.
std::vector<std::byte> light_and_view_bytes(const std::vector<Light>& lights, const View& view);
inline std::vector<std::byte> light_and_view_bytes(const Light& light, const View& view) {
  return light_and_view_bytes(std::vector{light}, view);
}

/// What a technique is to answer next.
struct FrameRequest {
  std::filesystem::path gbuffer_file;  ///< as write_gbuffer writes it
  int width = 0, height = 0;
  Truth truth = Truth::shape;
  std::variant<SceneLightAndView, FreeLightAndView> seen;
  std::optional<WantedPose> pose = {};  ///< nothing: meshes are at rest
  bool begins_sequence = false;         ///< what a technique remembers of frames before is gone first
};

/// What a technique says that a mask is wrong by: Technique::error_terms.
struct ErrorParts {
  std::vector<std::string> causes;         ///< of each part
  std::vector<std::vector<float>> values;  ///< of each part, of each pixel
};

/// The technique's support of a frame, before it does anything.
struct FrameReply {
  Support support;
  std::vector<Support> lights;  ///< each; one that is unsupported beside others casts no shadows
  std::string floor;            ///< name of the bare pass that `time_floor` draws; empty: none
  std::optional<bool> shares;   ///< of several lights: whether they share what setup and build make
};

/// What a stage took, in milliseconds, by clocks beside the one that counts; nothing where there is none.
struct OtherClocks {
  std::optional<double> device;   ///< of the device that draws
  std::optional<double> harness;  ///< the harness's, where the technique's own one counts
};

struct MaskReply {
  std::vector<float> mask;  ///< 1 lit, 0 umbra; one a pixel of the frame, of several lights one after the other
  Counts counts;
  std::uint64_t peak_bytes = 0;  ///< largest resident memory of the worker so far
  std::string maker;             ///< WorksElsewhere::maker
  std::optional<GlInputs> gl;    ///< with OpenGL
};

/// A typed client of one worker: load, go to a frame, do stages, read the results. Calls wait for their answer and come from
/// one thread, except `interrupt`. Any failure on the worker's side (no program, a crash, a hang, an exception, an answer of
/// another shape or size, a mask outside 0 .. 1) is a WorkerFailure with its reason; the worker has ended then.
class WorkerClient {
 public:
  /// Starts the process. Files between both sides are named `files` and an ending: "scratch/0" gives scratch/0.mask. An answer
  /// may take `timeout_seconds`.
  WorkerClient(const WorkerOptions& options, std::filesystem::path files, double timeout_seconds);

  /// Both parts of a load, so that several workers can load at the same time.
  void begin_load(const TechniqueOnScene& what);
  void end_load();
  void load(const TechniqueOnScene& what) {
    begin_load(what);
    end_load();
  }
  /// After a load; nothing for a technique that does not draw.
  const std::optional<WorkerGl>& gl() const { return gl_; }
  /// Other settings of the same technique: the stages that they spoil are out of date, the others stay.
  void set(const std::string& settings);
  FrameReply frame(const FrameRequest& request);

  /// Stages that are up to date, from setup on: 0 .. 5. After build update is, too.
  int fresh_count() const { return fresh_count_; }
  /// Does one stage so many times more, those before it untimed where they are out of date. Milliseconds of all iterations
  /// together by the worker's own clock. They are one request, or a few where they take long: each answer may take
  /// `timeout_seconds`, of several iterations longest_portion_seconds more.
  double time(Stage stage, int iterations = 1);
  /// The last of these by other clocks.
  const OtherClocks& other_clocks() const { return other_clocks_; }
  /// Draws the frame's bare pass so many times in a row, at most most_floor_times. Milliseconds of all together; other
  /// clocks as above.
  double time_floor(int times);
  /// Present state of the card: WorkerGl::card.
  std::optional<Json> card();
  /// Does what is out of date up to this stage.
  void bring_up(Stage stage);

  // Each brings up what it needs first.
  std::vector<float> mask();
  MaskReply answer();
  /// The technique's explanations of pixels of the last answer under one of the frame's lights, one for each; nothing where it
  /// has none.
  std::vector<std::optional<Explanation>> explain(std::span<const std::uint32_t> pixels, std::size_t light = 0);
  /// The parts of the difference between the last mask under one of the frame's lights and what is exact, one value a pixel.
  ErrorParts error_terms(std::span<const float> exact, std::size_t light = 0);
  /// Technique::depth_curve of a pixel under one of the frame's lights; each of its curves has a share for each depth.
  std::optional<DepthCurve> depth_curve(std::uint32_t pixel, std::size_t light = 0);
  /// Technique::image_parts under one of the frame's lights, one a pixel; empty from a technique of one part.
  std::vector<std::uint32_t> parts(std::size_t light = 0);
  /// Three linear floats a pixel of the frame.
  std::vector<float> debug_layer(const std::string& name, std::size_t light = 0);
  /// Technique::global_picture under one of the frame's lights, its size and values checked.
  std::optional<std::vector<float>> global_picture(std::size_t light = 0);
  /// Of the last relight.
  SurfaceDetail surface_detail(std::size_t light = 0);

  /// The share of the present stage that is done, 0 .. 1, where its technique reports it (gnomon/kit/progress.h), else 0. From
  /// any thread.
  double progress() const;

  /// From any thread: ends the worker; a call that waits fails at once.
  void interrupt() { process_.interrupt(); }

 private:
  template <class Read>
  auto checked(const Read& read);
  std::vector<float> read_mask();
  std::filesystem::path file(const char* ending) const;

  std::filesystem::path files_;
  ScratchFolder program_files_;  ///< outlives the process
  SharedCount progress_;
  WorkerProcess process_;
  double timeout_seconds_;
  std::optional<WorkerGl> gl_;
  OtherClocks other_clocks_;
  std::size_t pixel_count_ = 0, light_count_ = 1;  ///< of the frame
  int fresh_count_ = 0;
};

/// The machine_context of a program that serves this one. Throws Error when it cannot be started, is no gnomon, or has another
/// protocol.
Json context_of_program(const WorkerOptions& options);

}  // namespace gnomon
