#include "measure/worker/worker_frame_maker.h"

#include "measure/worker/worker_client.h"

namespace gnomon {

/// Far more than any picture takes: it ends a worker that hangs, no slow one.
constexpr double longest_trace_seconds = 3600;

TraceWatch shown_on(Progress& progress, std::string scene) {
  return [&progress, scene = std::move(scene)](const MissingFrame& missing, double share) {
    if (share >= 1) return progress.end_part();
    const std::string_view what = missing.global_samples > 0 ? "all light"
                                  : missing.pixel_rays > 0   ? "truth over the pixel"
                                                             : "reference";
    progress.part(
        missing.light ? fmt::format("{} of {}, {}", what, scene, missing.light->name) : fmt::format("G-buffer of {}", scene),
        share);
  };
}

std::filesystem::path WorkerFrameMaker::file(const char* ending) {
  if (files_.empty()) files_ = scratch_.emplace(ScratchFolder::temporary("gnomon-frames")).path() / "frame";
  return std::filesystem::path(files_) += fmt::format(".{}", ending);
}

std::vector<std::byte> WorkerFrameMaker::make(const MissingFrame& missing) {
  const std::vector<Light> lights = missing.light ? std::vector{*missing.light} : std::vector<Light>();  // none: a G-buffer
  const std::vector<std::byte> view_and_light = light_and_view_bytes(lights, missing.key.view);
  const std::string frame =
      fmt::format("{} {} {} {} {} {} {} {} {} {}", content_hash(view_and_light), missing.key.width, missing.key.height,
                  name(missing.key.truth), missing.target.error, missing.target.cap, missing.subpixel_bits,
                  missing.global_samples, missing.pixel_rays, missing.key.pose ? missing.key.pose->hash : "at rest");
  if (const auto failure = failures_.find(frame); failure != failures_.end()) throw WorkerFailure(failure->second);
  write_file(file("view_and_light"), view_and_light);
  const TraceRequest request{.scene = missing.scene_file.string(),
                             .light_and_view = file("view_and_light").string(),
                             .gbuffer = missing.gbuffer_file.string(),
                             .out = file("frame").string(),
                             .width = missing.key.width,
                             .height = missing.key.height,
                             .truth = missing.key.truth,
                             .error = missing.target.error,
                             .cap = missing.target.cap,
                             .subpixel_bits = missing.subpixel_bits,
                             .global_samples = missing.global_samples,
                             .pixel_rays = missing.pixel_rays,
                             .pose = missing.key.pose};
  try {
    try {
      return ask(request, missing);
    } catch (const WorkerCrash&) {
      return ask(request, missing);
    }
  } catch (const WorkerFailure& failure) {
    failures_[frame] = fmt::format("the reference {}", failure.what());
    throw WorkerFailure(failures_[frame]);
  }
}

std::vector<std::byte> WorkerFrameMaker::ask(TraceRequest request, const MissingFrame& missing) {
  if (!process_) process_.emplace(WorkerOptions{.threads = 0, .plugins = {}, .program = program_});
  const SharedCount done;
  request.done = done.place();
  const double pixels = static_cast<double>(missing.key.width) * missing.key.height;
  const auto show = [&] { watch_(missing, static_cast<double>(done.value()) / pixels); };
  const auto end_show = [&] {
    if (watch_) watch_(missing, 1);
  };
  try {
    if (watch_) show();
    process_->ask(request, longest_trace_seconds, watch_ ? std::function<void()>(show) : nullptr);
  } catch (const WorkerFailure&) {
    end_show();
    process_.reset();
    throw;
  }
  end_show();
  const auto made = MappedFile::copy(file("frame"));
  return {made->bytes().begin(), made->bytes().end()};
}

}  // namespace gnomon
