#pragma once
#include "measure/frame/frame.h"
#include "measure/progress.h"
#include "measure/worker/worker_process.h"

namespace gnomon {

/// Called ten times a second while a frame is traced, with the frame and the share of its pixels that is done, 0 where it is
/// not counted. Once the frame is made, or cannot be, the share is 1.
using TraceWatch = std::function<void(const MissingFrame& missing, double share)>;

/// Shows the tracing of a scene of this name on a bar. The bar must outlive it.
TraceWatch shown_on(Progress& progress, std::string scene);

/// Has frames traced by a worker, so that a scene which crashes the ray tracer costs its own rows only. The worker starts when
/// a frame is missing, and stays for the next one. Where a signal ends it, which may have come from outside, another one tries
/// once more. A frame that could not be made is a WorkerFailure with its reason, "the reference crashed in trace: ...", and is
/// not tried again.
class WorkerFrameMaker final : public FrameMaker {
 public:
  /// Files between both sides are named `files` and an ending; empty: they lie in a folder for temporary files. `program` is
  /// whose process the worker is; empty: this one.
  explicit WorkerFrameMaker(std::filesystem::path files = {}, std::string program = {}, TraceWatch watch = {})
      : files_(std::move(files)), program_(std::move(program)), watch_(std::move(watch)) {}
  std::vector<std::byte> make(const MissingFrame& missing) override;

 private:
  std::filesystem::path file(const char* ending);
  /// The bytes that the worker wrote for the request.
  std::vector<std::byte> ask(TraceRequest request, const MissingFrame& missing);

  std::optional<WorkerProcess> process_;
  std::filesystem::path files_;
  std::string program_;
  TraceWatch watch_;
  std::optional<ScratchFolder> scratch_;
  std::map<std::string, std::string> failures_;  ///< reasons, by the hash of the frame
};

}  // namespace gnomon
