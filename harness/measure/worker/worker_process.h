#pragma once
#include <atomic>
#include <functional>

#include "measure/worker/protocol.h"

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
  int threads = 0;  ///< pins the worker to this many cores, and limits llvmpipe, Embree and TBB before any starts; 0: all
  std::vector<std::string> plugins;  ///< files of plugins, and of programs as techniques
  std::string program = {};          ///< file that the workers run; empty: this program
  std::string program_folder = {};   ///< for files between the worker and a technique that is a program; empty: one of its own
  std::string command = "worker";    ///< of the program, by which a process becomes a worker
  /// Drivers may keep compiled shaders on the disk. False: every setup compiles them, unless the environment keeps them.
  bool keeps_shaders = false;
};

/// A fresh process of a program that serves one technique: requests and answers are single lines of JSON over a socket, one
/// answer to each request. It dies with its owner.
class WorkerProcess {
 public:
  /// Throws WorkerFailure that names the program when there is none to start: it was moved, or is being built.
  explicit WorkerProcess(const WorkerOptions& options);
  ~WorkerProcess();

  void send(const Json& request);
  /// Waits for the answer to the last request; calls `meanwhile` ten times a second. Throws WorkerFailure, as `fail` does.
  Json receive(double timeout_seconds, const std::function<void()>& meanwhile = {});
  // The same of requests that are structs, see protocol.h. An answer that is none to the request is a failure, too.
  template <class Request>
  typename Request::Reply receive_reply(double timeout_seconds, const std::function<void()>& meanwhile = {}) {
    const Json answer = receive(timeout_seconds, meanwhile);
    try {
      return message_from<typename Request::Reply>(answer, Request::verb);
    } catch (const Error& problem) {
      fail(fmt::format("answered {} with something else than was asked: {}", doing_, problem.what()));
    }
  }
  template <class Request>
  typename Request::Reply ask(const Request& request, double timeout_seconds, const std::function<void()>& meanwhile = {}) {
    send(request_json(request));
    return receive_reply<Request>(timeout_seconds, meanwhile);
  }
  /// The verb of the last request, of a stage its name, as reasons of failures quote it: "relight".
  const std::string& doing() const { return doing_; }
  /// From any thread: ends the process; a call of `receive` that waits throws its WorkerFailure at once.
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

  WorkerOptions options_;
  int process_ = -1;  ///< of the keeper; -1: it has ended
  int socket_ = -1, errors_ = -1;
  std::atomic<bool> is_interrupted_ = false;  ///< also makes the object uncopyable
  std::string pending_, doing_;
};

}  // namespace gnomon
