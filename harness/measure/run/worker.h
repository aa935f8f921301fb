#pragma once
#include <atomic>
#include <chrono>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

namespace gnomon {

using Json = nlohmann::ordered_json;

/// A worker that crashed, hung, threw or ran out of memory. It costs its own row only; the text is the row's reason.
class WorkerFailure : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

struct WorkerOptions {
  int threads = 0;  ///< pins the worker to this many cores and tells llvmpipe, Embree and TBB before any starts; 0: all
  std::vector<std::string> plugins;
  std::string program = {};  ///< that workers are processes of; empty: this one
};

/// Version of what is said between a program and its workers, and of the files that pass between them. One more with every
/// change that an older worker would misunderstand.
inline constexpr int worker_protocol = 3;

/// What a program says of itself before it may work for this one: the context of its build (context.h). Throws Error when it
/// cannot be started, is no gnomon, or speaks another protocol.
Json ask_program(const WorkerOptions& options);

/// A fresh process of a program that holds one technique and does what it is asked, one request at a time. Requests and
/// answers are single lines of JSON over a socket; worker_main documents them. Dies with its owner.
class Worker {
 public:
  explicit Worker(const WorkerOptions& options);
  ~Worker();
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;

  void send(const Json& request);
  /// Waits for the answer to the last request. Throws WorkerFailure; the worker is dead then.
  Json receive(double timeout_seconds);
  /// From any thread: ends the worker, and whoever waits in `receive` gets its WorkerFailure at once.
  void interrupt();
  Json ask(const Json& request, double timeout_seconds) {
    send(request);
    return receive(timeout_seconds);
  }

 private:
  [[noreturn]] void fail(const std::string& how);
  std::string last_words() const;

  int process_ = -1, socket_ = -1, errors_ = -1;
  std::atomic<bool> is_interrupted_ = false;
  std::string pending_, doing_;
};

/// The worker's own side: answers requests on `socket` until it closes. Requests:
///   {"do": "protocol"}                                                      -> {"protocol": n, "context": {...}}
///   {"do": "open", "scene": FILE, "technique": ID, "settings": "a=1"}       -> {"gl": {...} or null}
///   {"do": "set", "settings": "a=2"}                                        -> {"fresh": n}  of the same technique
///   {"do": "frame", "gbuffer": FILE, "view": K, "width", "height", "truth", "light": K} -> {"support", "why", "fresh", ...}
///   {"do": "frame", "gbuffer": FILE, "stand": FILE, "width", "height", "truth"}         -> the same
///   {"do": "setup"}                                                         -> {"ms": t}
///   {"do": "time", "stage": NAME}                                           -> {"ms": t}   earlier stages brought up untimed
///   {"do": "bring_up", "stage": NAME}                                       -> {}          all stages up to this one, once
///   {"do": "answer", "mask": FILE}                                          -> {"counts": [...], "peak_bytes": n}
///   {"do": "mask", "mask": FILE}                                            -> {}          the mask without counting
///   {"do": "explain", "pixels": FILE, "out": FILE}                          -> {"explained": bool}
///   {"do": "debug", "layer": NAME, "out": FILE}                             -> {}
///   {"do": "detail", "out": FILE}                                           -> {}          detail_bytes of the last relight
/// A stand is the scene_bytes of a scene without meshes that holds one light and one view, wherever they are: they count
/// instead of the scene's. `fresh` is how many stages, from setup on, are up to date. `pixels` holds uint32 indices of the mask
/// last answered; `out` gets the explanation_bytes of them, in their order. An exception is answered as {"error": text}.
int worker_main(int socket, int threads);

}  // namespace gnomon
