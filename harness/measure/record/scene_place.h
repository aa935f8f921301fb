#pragma once
#include "measure/record/record.h"

namespace gnomon {

/// The path from a run's folder to the file of a scene, as a record keeps it beside the scene as written (context.scene_file),
/// so that both are found again together wherever they are and whatever folder the program runs in. Nothing for ids of scenes,
/// for files that are not there, and where the two have nothing in common but the root. A time of the scene is left out.
std::optional<std::string> path_to_scene(const std::filesystem::path& run_folder, const std::string& reference);

/// What load_scene takes for the scene of a record in this folder: the file that the record's path leads to, else the scene as
/// written; at the record's time.
std::string scene_reference(const Record& record, const std::filesystem::path& run_folder);

}  // namespace gnomon
