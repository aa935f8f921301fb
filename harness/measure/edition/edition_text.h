#pragma once
// Private to the room: the file of an edition as text. Its end is written by the program, below a line that says so.
#include "measure/edition/edition.h"

namespace gnomon {

/// The text of a file without the line of its hash, hashed: 16 hex digits.
std::string edition_hash(std::string_view text);
/// The frozen part, from that line on.
std::string frozen_part(const Edition& edition);
/// What is written by hand, read from the file: without hash, frames, scenes, metrics and techniques.
Edition read_hand_written_part(const std::filesystem::path& file);

/// A place of the edition's rows and the hash of its scene; "" where the scene is not fetched.
struct EditionScene {
  std::string key, hash;
  std::string missing;  ///< why there is no scene
};
/// Those of one group, each once.
std::vector<EditionScene> scenes_of_group(const Suite& suite, const SuiteGroup& group, SceneLibrary& library);
/// Edition::techniques as this program has them.
std::map<std::string, Json> parameters_of_contenders(const Suite& suite);

}  // namespace gnomon
