#pragma once
#include <atomic>
#include <chrono>
#include <filesystem>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "measure/json.h"

namespace gnomon {

/// A worker that could not be started, crashed, hung, threw, ran out of memory or answered nonsense. It costs its own row only;
/// the text is the row's reason.
class WorkerFailure : public std::runtime_error {
  using std::runtime_error::runtime_error;
};
/// A signal ended the worker, of its own doing or from outside: another one may do better.
class WorkerCrash : public WorkerFailure {
  using WorkerFailure::WorkerFailure;
};

/// The option that loads such a file: --program for a .toml, --plugin for any other.
std::string load_option(const std::string& path);

struct WorkerOptions {
  int threads = 0;  ///< pins the worker to this many cores and tells llvmpipe, Embree and TBB before any starts; 0: all
  std::vector<std::string> plugins;  ///< files of plugins, and of programs as techniques
  std::string program = {};          ///< whose processes the workers are; empty: this one
  std::string program_folder = {};   ///< for files between the worker and a technique that is a program; empty: one of its own
  std::string command = "worker";    ///< of the program: what its processes are there for
  /// Several iterations of a stage are one request. False: each is one, as older programs want it.
  bool takes_iterations = true;
  /// Drivers may keep compiled shaders on the disk. False: every setup compiles them, unless the environment says otherwise.
  bool keeps_shaders = false;
};

/// Whether GNOMON_SHADERS=keep lets all workers take what earlier ones compiled: a setup tells no time of shaders then, and
/// records say so. Throws Error on another word.
bool environment_keeps_shaders();

/// Version of what is said between a program and its workers, and of the files that pass between them. One more with every
/// change that an older worker would misunderstand.
inline constexpr int worker_protocol = 3;

/// A worker that is asked for several iterations of a stage answers after the one in which these seconds are over, with as many
/// as it has done: an answer takes no longer than this and one call of the stage.
inline constexpr double longest_portion_seconds = 0.1;

/// Bare passes in a row that a worker draws in one answer, at most.
inline constexpr int most_floor_times = 50;

/// The machine and the build, for every record: version, commit, build_type, compiler, flags, processor, cores, threads,
/// load_average, started, libraries; and "shaders": "kept" where the environment keeps them.
Json machine_context(int threads);

/// A fresh process of a program that serves one technique: requests and answers are single lines of JSON over a socket, one
/// answer to each request. It dies with its owner. What may be asked, and what is answered, is WorkerClient's business.
class WorkerProcess {
 public:
  /// Throws WorkerFailure that names the program when there is none to start: it was moved, or is being built.
  explicit WorkerProcess(const WorkerOptions& options);
  ~WorkerProcess();
  WorkerProcess(const WorkerProcess&) = delete;
  WorkerProcess& operator=(const WorkerProcess&) = delete;

  void send(const Json& request);
  /// Waits for the answer to the last request; calls `meanwhile` ten times a second. Throws WorkerFailure, as `fail` does.
  Json receive(double timeout_seconds, const std::function<void()>& meanwhile = {});
  /// What it was asked to do last, a stage by its name, as reasons of failures say it: "relight".
  const std::string& doing() const { return doing_; }
  /// From any thread: ends the process, and whoever waits in `receive` gets its WorkerFailure at once.
  void interrupt();
  /// Ends the process and throws WorkerFailure, or one of its kinds, with this reason and the last line that the process wrote
  /// to its stderr.
  template <class Failure = WorkerFailure>
  [[noreturn]] void fail(const std::string& how) {
    throw Failure(ended(how));
  }

 private:
  void end_process();
  [[noreturn]] void fail_as_it_ended();
  /// Ends the process; the reason with its last words.
  std::string ended(const std::string& how);
  std::string last_words() const;

  WorkerOptions options_;
  std::string mark_;  ///< in the environment of the process and of all that it starts
  int process_ = -1;  ///< -1: it has ended
  int socket_ = -1, errors_ = -1;
  std::atomic<bool> is_interrupted_ = false;
  std::string pending_, doing_;
};

/// Writes the line and its end; whether the other side is there to take it.
bool write_line(int socket, const std::string& line);

/// The worker's own side: answers requests on `socket` until it closes. Requests:
///   {"do": "protocol"}                                                      -> {"protocol": n, "context": {...},
///   "takes_iterations": true}
///   {"do": "open", "scene": FILE, "technique": ID, "settings": "a=1"}       -> {"gl": {...} or null}
///   the same with "progress": FILE: a SharedCount for what the technique tells of a stage under way
///   {"do": "set", "settings": "a=2"}                                        -> {"fresh": n}  of the same technique
///   {"do": "frame", "gbuffer": FILE, "view": K, "width", "height", "truth", "light": K} -> {"support", "why", "fresh", ...}
///   the same with "lights": [K, ...] instead of "light": several together  -> also "lights": [{"support", "why"}, ...],
///   "shares"
///   {"do": "frame", "gbuffer": FILE, "stand": FILE, "width", "height", "truth"}         -> the same
///   {"do": "time", "stage": NAME, "iterations": N}                          -> {"ms": t, "iterations": n, "device_ms": t,
///   "harness_ms": t}
///   {"do": "floor", "times": N}                                             -> {"ms": t, "device_ms": t}  of all N
///   {"do": "card"}                                                          -> {"card": {...} or null}
///   {"do": "bring_up", "stage": NAME}                                       -> {}          all stages up to this one, once
///   {"do": "answer", "mask": FILE}                                          -> {"counts": [...], "peak_bytes": n, "maker": ""}
///   {"do": "mask", "mask": FILE}                                            -> {}          the mask without counting
///   {"do": "explain", "pixels": FILE, "out": FILE}                          -> {"explained": bool}
///   {"do": "debug", "layer": NAME, "out": FILE}                             -> {}
///   {"do": "global", "out": FILE}                                           -> {"has_picture": bool}
///   {"do": "detail", "out": FILE}                                           -> {}          detail_bytes of the last relight
///   {"do": "trace", "scene": FILE, "stand": FILE, "gbuffer": FILE, "width", "height", "truth", "error", "cap",
///   "subpixel_bits", "global_samples", "out": FILE,
///    "done": FILE} -> {}
/// The last one is FrameWorker's: the reference, with `global_samples` that of all light, or where `stand` holds no light the
/// G-buffer, as the frame cache has them. The file `done`, which may be missing, is a SharedCount of the pixels that are
/// through. `stand` is a file with the scene_bytes of a scene without meshes that holds a light or several and one view,
/// wherever they are: they count instead of the scene's. `time` brings earlier stages up untimed, does this one N times, once
/// where nothing is said, or fewer (longest_portion_seconds), and answers the sum of their times and their number; `harness_ms`
/// beside `ms` where that is by the technique's own clock. Masks of several lights follow each other in one file; `explain`,
/// `debug`, `global` and `detail` are about the frame's first light, or that of their "light". A light that is unsupported
/// beside others has a mask of ones. `fresh` is how many stages, from setup on, are up to date. `pixels` holds uint32 indices
/// of the mask answered last; `out` gets their explanation_bytes, in the same order. An exception is answered as {"error":
/// text}.
int worker_main(int socket, int threads);

/// Answers each line of JSON on `socket` by what `handle` makes of it, an exception by {"error": text}; ends the process when
/// the other side is gone.
[[noreturn]] void answer_lines(int socket, const std::function<Json(const Json&)>& handle);

}  // namespace gnomon
