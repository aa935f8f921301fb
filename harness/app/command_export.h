#pragma once
#include "app/app.h"
#include "app/time_option.h"

namespace gnomon::app {

/// What `gnomon export` takes.
struct ExportOptions {
  std::string scene, view, size = "640x360", truth = "shape";
  std::vector<std::string> lights;
  TimeOption time;  ///< with --sequence and without seconds, the animation is the one that the frames follow
  std::filesystem::path out;

  bool is_sequence = false;
  // Of a sequence alone.
  std::string technique, path;
  int frames = 0;  ///< 0: up to the last key
  std::optional<double> frame_rate, start;
  int threads = 0;
  double timeout = 120;
};

/// Writes the frames of one row on a path as pictures into the folder, numbered from 0, and sequence.json, which lists them.
/// Throws Error on names that are not there, where the row does not move or is not one, where the folder has files already, and
/// where the technique does not support a frame; then nothing is written.
void export_sequence(const ExportOptions& options, const WorkerOptions& worker);

}  // namespace gnomon::app
