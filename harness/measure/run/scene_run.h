#pragma once
#include <filesystem>
#include <optional>

#include "measure/frame/frame.h"
#include "measure/run/jobs.h"
#include "measure/run/worker_client.h"

namespace gnomon {

/// A frame of a row: all that its mask depends on but the technique, its settings and the truth.
struct RowFrame {
  std::size_t light = 0, view = 0;  ///< indices in the scene
  int width = 0, height = 0;
  std::optional<Path> path;
  int number = 0;  ///< on the path

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
           std::filesystem::path scratch_folder)
      : reference(std::move(scene_reference)),
        scene(std::move(the_scene)),
        frames(scene, cache),
        scratch(std::move(scratch_folder)),
        suite(the_suite) {}

  RowFrame first_frame(const Job& job) const;
  Light light(const RowFrame& frame) const;
  FrameKey key(const RowFrame& frame, Truth truth) const;
  FrameRequest request(const RowFrame& frame, Truth truth);
};

}  // namespace gnomon
