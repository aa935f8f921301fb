#pragma once
#include <gnomon/technique.h>

#include <filesystem>
#include <fstream>
#include <functional>

#include "measure/gl_inputs.h"
#include "measure/statistics/statistics.h"
#include "measure/truth_over.h"

namespace gnomon {

/// Version of the record's fields: the one that is written and read. One more with every change; scripts/results --convert
/// converts kept folders.
inline constexpr int record_schema = 7;

enum class Status { ok, unsupported, failed };
std::string_view name(Status status);
std::string_view name(Role role);

/// By name of the metric; nothing where it could not be measured. Rates and shares are fractions of 1.
using Metrics = std::map<std::string, std::optional<double>, std::less<>>;

/// One row: what one technique did with one scene, light and view. Raw first: every repetition of every stage, so that a new
/// statistic or metric reads old runs. Missing is null. docs/records.md describes every field for readers of the file.
struct Record {
  std::string job;  ///< hexadecimal hash of the job: the same one has the same hash in every run
  std::string suite;
  std::string scene;  ///< reference as written, "soup:ground=false"
  /// Name of the light, or of several lights together as written, "a+b", "all+"; their kinds, "point+rect".
  std::string light, light_kind, view;
  std::string technique;             ///< id
  std::string settings;              ///< "a=1,b=2": what differs from the defaults
  std::optional<std::string> label;  ///< short name that the suite gives the row
  Role role = Role::contender;
  Json parameters = json_object();  ///< every parameter of the technique with its value, number or text
  int width = 0, height = 0;
  Truth truth = Truth::shape;  ///< the truth that headline metrics use
  /// What the row asked for beside the truth at pixel centers; nothing where that was all, and in older rows.
  std::optional<TruthOver> truth_over;
  std::string path;  ///< camera path, light path or animation that the row follows; empty: nothing moves
  /// Of a row whose geometry moves: seconds of the animation at its first frame, and frames per second.
  std::optional<double> start, frame_rate;
  std::optional<int> frame_count;  ///< and how many there are
  std::uint64_t place = 0;         ///< position in the expanded suite: the order of rows, also of merged shards

  Status status = Status::failed;
  std::optional<Support::Kind> support;  ///< nothing when the technique gave no answer
  std::string reason;                    ///< why approximate, unsupported or failed

  std::array<ProcessTimes, std::size(stage_names)> stages;  ///< by Stage; setup has one repetition per process
  /// Of a row whose geometry moves: relight and resolve in the frames after `update`, which may keep what did not move. Times
  /// of `stages` are those of the first frame, `update` of all.
  std::array<ProcessTimes, std::size(stage_names)> moving_stages;
  /// The same as `stages` by the device's own clock, with OpenGL where it has one; as many processes, repetitions and
  /// iterations.
  std::array<ProcessTimes, std::size(stage_names)> device_stages;
  /// The same by the harness's clock, of a technique whose own clock counts, because it runs in a program of its own.
  std::array<ProcessTimes, std::size(stage_names)> harness_stages;
  std::map<std::string, std::uint64_t> iterations;  ///< by stage: calls whose mean is one repetition
  std::string stop;  ///< why there are no more processes: "fixed", "target" (interval narrow enough) or "budget"
  Counts counts;
  std::optional<std::uint64_t> bytes;       ///< the technique's own count, and the scene's triangles in OpenGL
  std::optional<std::uint64_t> peak_bytes;  ///< largest resident memory of a worker
  /// The barest pass that the technique needs, by its data sheet, on the same scene and picture in the same processes: times of
  /// one pass.
  struct FloorTimes {
    std::string pass;  ///< "depth_draw", "fetch", "copy"
    ProcessTimes ms, device_ms;
  };
  std::optional<FloorTimes> floor;  ///< nothing without OpenGL, and of a technique that names none
  std::optional<GlInputs> gl;       ///< nothing without OpenGL

  /// Where the answer is a fraction: which of its two true numbers the technique was scored against, and how well that is
  /// known.
  struct ReferenceFacts {
    LightShareKind estimates = LightShareKind::area;
    double target = 0;      ///< standard error
    std::uint64_t cap = 0;  ///< most places of the light that one point samples
    std::uint64_t rays = 0;
    double error_mean = 0, error_max = 0;  ///< standard errors, over the pixels that face the light
    /// Of the picture of all light that the technique's was compared with, where the run has one.
    struct GlobalFacts {
      int samples = 0;  ///< light paths of a pixel
      std::uint64_t rays = 0;
      double error = 0;  ///< root mean square of its standard errors, as a share of that of the picture
    };
    std::optional<GlobalFacts> global = {};
  };

  /// How well the truth over the pixel is known under a light without area, over the pixels of T; on a path at its last frame.
  struct PixelFacts {
    int rays = 0;                          ///< eye rays of a pixel
    double kept = 0;                       ///< share of them that count
    std::uint64_t tested = 0;              ///< pixels that keep half of theirs or more
    double error_mean = 0, error_max = 0;  ///< standard errors over these
  };

  /// One light of the row.
  struct LightFacts {
    std::string name, kind;                  ///< kind: "point", "rect"; empty where the scene could not be loaded
    AnswerKind answer = AnswerKind::binary;  ///< as the reference has it
    std::optional<Support::Kind> support;    ///< of several lights one that is unsupported casts no shadows
    std::string reason;
    std::optional<ReferenceFacts> reference;
    std::optional<PixelFacts> pixel_truth;  ///< where the row asked for it
    // As in the record, of this light's mask. Of one light they are the record's, and the file has them only there.
    std::map<std::string, std::uint64_t> classes;
    Metrics metrics;  ///< headline truth
    std::optional<std::map<std::string, std::uint64_t>> causes;
    std::optional<std::map<std::string, double>> cause_errors;
  };
  std::vector<LightFacts> lights;          ///< one at least, in the scene's order
  AnswerKind answer = AnswerKind::binary;  ///< of the headline; see row_answer
  std::optional<bool> shares_build;        ///< of several lights: whether they share what setup and build make

  std::map<std::string, std::uint64_t> classes;  ///< pixels of class "B", "F", "G", "S", "U", "T"; sums over several lights
  std::map<Truth, Metrics> metrics;              ///< on a path: means over its frames
  /// Wrong pixels of T by cause (of a light with area, those that are off at all), headline truth, on a path summed over its
  /// frames; nothing when the run sought none.
  std::optional<std::map<std::string, std::uint64_t>> causes;
  /// A cause of this technique alone, from its data sheet: enough to show it where the technique is not loaded.
  struct OwnCauseFacts {
    std::string name, sentence;
    std::array<std::uint8_t, 3> color{};  ///< sRGB
  };
  std::vector<OwnCauseFacts> own_causes;  ///< in the data sheet's order; empty where the technique has none
  /// Under a light with area: what each cause holds of the mean error; they add up to `error`. Of several lights: of the
  /// error of the share of the light received, where pixels have the cause of the light that errs most.
  std::optional<std::map<std::string, double>> cause_errors;
  /// On a path: by metric, its value at every frame, headline truth.
  std::map<std::string, std::vector<std::optional<double>>> frames;
  /// What irradiance is multiplied by in the row's pictures, m2/W; on a path that of the last frame.
  std::optional<double> exposure;
  std::optional<std::string> mask, error_picture, shaded_picture;  ///< paths relative to the run's folder
  /// On a path: pictures of its frames, NUMBER.png in these folders, relative to the run's (frame_picture).
  struct KeptFrames {
    std::vector<int> numbers;  ///< of the frames that have them, from 0, ascending
    std::string mask;          ///< this row's
    std::string reference;     ///< those of all rows with the same frames; empty until the row has all of its own
  };
  std::optional<KeptFrames> kept_frames;  ///< nothing where the run keeps none

  struct SceneFacts {
    std::uint64_t meshes = 0, triangles = 0;
    bool closed = false;
    std::uint64_t boundary_edges = 0, nonmanifold_edges = 0, misoriented_edges = 0, degenerate = 0;
  };
  std::optional<SceneFacts> scene_facts;  ///< sums over the meshes; closed when every mesh is
  std::vector<std::string> notes;
  /// Free, but these keys have a meaning: version, commit, build_type, compiler, flags, processor, cores, threads,
  /// load_average, started, gl_renderer, gl_version, gl_subpixel_bits, libraries (object: name -> version).
  Json context = json_object();
  std::optional<double> seconds;  ///< wall time that the row took
  Json unknown = json_object();   ///< fields that this program does not define, kept as read

  // Compiled once: Record is in most files, and has many members.
  Record();
  Record(const Record&);
  Record(Record&&) noexcept;
  Record& operator=(const Record&);
  Record& operator=(Record&&) noexcept;
  ~Record();

  const ProcessTimes& times(Stage stage) const { return stages[static_cast<std::size_t>(stage)]; }
  ProcessTimes& times(Stage stage) { return stages[static_cast<std::size_t>(stage)]; }
  const ProcessTimes& moving_times(Stage stage) const { return moving_stages[static_cast<std::size_t>(stage)]; }
  ProcessTimes& moving_times(Stage stage) { return moving_stages[static_cast<std::size_t>(stage)]; }
  const ProcessTimes& device_times(Stage stage) const { return device_stages[static_cast<std::size_t>(stage)]; }
  ProcessTimes& device_times(Stage stage) { return device_stages[static_cast<std::size_t>(stage)]; }
  const ProcessTimes& harness_times(Stage stage) const { return harness_stages[static_cast<std::size_t>(stage)]; }
  ProcessTimes& harness_times(Stage stage) { return harness_stages[static_cast<std::size_t>(stage)]; }
  /// The metric against one truth, or against the headline truth; nothing when it is missing or null.
  std::optional<double> metric(Truth of, std::string_view name) const;
  std::optional<double> metric(std::string_view name) const { return metric(truth, name); }
};

/// What a frame takes, relight and resolve, by the host's clock and by that of what draws; nothing where one was not timed.
std::optional<double> frame_ms(const Record& record);
std::optional<double> frame_device_ms(const Record& record);
/// What part of a frame (relight and resolve) its bare pass takes, by the device's clock where both were taken by it.
std::optional<double> floor_share(const Record& record);
/// Count `rays` over the time of a frame, by the device's clock where there is one; nothing where no rays are counted.
std::optional<double> rays_per_second(const Record& record);
/// Whether the device's clock and the harness's, which waits for all to be done, can both be right: nothing took longer by the
/// device's, and of bare passes, in which the processor does nothing, no more than half is unexplained. Nothing without times
/// by the device's clock.
std::optional<bool> clocks_agree(const Record& record);
/// The share of each cause in the wrong rate, under a light with area in the error. Nothing when the run sought none, or tested
/// nothing.
std::optional<std::map<std::string, double>> cause_shares(const Record& record);
/// The share of a class, "S", among the pixels that face the light; nothing where none faces it.
std::optional<double> class_share(const Record& record, std::string_view letter);
std::vector<std::string> light_names(const Record& record);
/// The three channels of a light are one.
std::size_t light_count(const Record& record);
/// What its lights make the row's answer: that of one light, also where its channels are its lights; else `received`.
AnswerKind row_answer(const Record& record);
/// Name of the technique with its settings: the label that the suite gave, else "id:a=1,b=2".
std::string setting_name(const Record& record);
/// What makes it the same setting on another scene: id and settings, whatever its label.
std::string setting_key(const Record& record);
/// "SCENE LIGHT [VIEW] [PATH] TECHNIQUE:SETTINGS", the title of its job.
std::string title(const Record& record);
/// A text of the context, "" when it is not there; what is no text, as JSON.
std::string context_text(const Record& record, std::string_view key);
/// Hash of the plugin that the row's technique came from; "" for a row of no plugin.
std::string plugin_hash(const Record& record);
/// Whether the row is of a mask that another program made: `gnomon score --label`. No technique runs for it.
bool is_foreign(const Record& record);

/// `Json(record)` and `json.get<Record>()`. Reading throws Error with the field, its value and what is allowed; fields that
/// are absent or null keep their defaults, except schema, scene, lights, answer, technique and status, which must be there.
void to_json(Json& json, const Record& record);
void from_json(const Json& json, Record& record);
/// The same without a copy of the JSON, which takes as long as the rest.
Record record_of(Json json);

/// Removes all that was measured. The job, where it was to run, and the technique's support stay.
void forget_results(Record& record);

/// The pictures that it names, paths relative to the run's folder, but for those that other rows may name, too.
std::vector<std::string> pictures(const Record& record);
/// Those, which one row alone does not remove: of the references of its frames.
std::vector<std::string> shared_pictures(const Record& record);
/// The picture of a frame in a folder of KeptFrames.
std::string frame_picture(const std::string& folder, int frame);

/// The line of records.jsonl, newline included.
std::string record_line(const Record& record);

/// DIR/records.jsonl.
std::filesystem::path records_file(const std::filesystem::path& dir);

struct RecordFile {
  std::vector<Record> records;     ///< in order of the file; a job that was run again counts once, by its last line
  std::vector<std::string> notes;  ///< what was left out and why
};
/// Reads a file of records. A last line that a killed run left unfinished is left out with a note; any other line that is not a
/// record of today's schema throws Error with file and line.
RecordFile read_record_file(const std::filesystem::path& file);

/// The records of a run's folder one at a time, in the order of tables: those of a long run are larger than memory.
class RecordLines {
 public:
  /// Reads all once, and calls `seen` for each, in order of the file, from line 0. Throws and prints notes as `read_records`
  /// does.
  explicit RecordLines(const std::filesystem::path& dir, const std::function<void(const Record&)>& seen = {});
  /// The lines that count, in the order of tables.
  const std::vector<std::size_t>& order() const { return order_; }
  Record read(std::size_t line);

 private:
  std::filesystem::path file_;
  std::ifstream stream_;
  std::vector<std::streamoff> starts_;  ///< by line
  std::vector<std::size_t> order_;
};

/// Suites in order of first appearance, within one by place; records without a place stay in their order.
void sort_by_place(std::vector<Record>& records);

/// The records of a run's folder, sorted by place; notes go to stderr. Throws Error when there is no records.jsonl.
std::vector<Record> read_records(const std::filesystem::path& dir);

/// Appends records to DIR/records.jsonl, one line by one write, on the disk when `append` returns. Opening mends the line
/// that a killed run left unfinished. One writer at a time: a second one on the same folder is an Error.
class RecordWriter {
 public:
  explicit RecordWriter(const std::filesystem::path& dir);
  RecordWriter(const RecordWriter&) = delete;
  RecordWriter& operator=(const RecordWriter&) = delete;
  ~RecordWriter();
  /// Throws Error when the disk is full or broken; the file then holds the earlier lines, whole. A failed `append` may be tried
  /// again.
  void append(const Record& record);
  /// Replaces the content of the file by these records, at once; later records follow them. The folder stays this writer's all
  /// the while. Throws Error when they cannot be written; the file is as it was then.
  void replace(std::span<const Record> records);
  /// Throws Error when not everything arrived; the destructor can only close.
  void close();

 private:
  std::filesystem::path file_;
  int descriptor_ = -1;
};

}  // namespace gnomon
