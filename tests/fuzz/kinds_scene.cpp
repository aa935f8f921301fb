// Scenes, suites and meshes.
#include <charconv>

#include "fuzz.h"
#include "measure/run/suite.h"
#include "measure/scene/import.h"
#include "measure/scene/load.h"
#include "measure/scene/pose.h"

namespace fuzz {

using namespace gnomon;
namespace fs = std::filesystem;

Outcome read_described_scene(const fs::path& file, const std::string&) {
  load_scene(file.string());
  return Outcome::accepted;
}

Outcome read_suite_file(const fs::path& file, const std::string&) {
  read_suite(file.string());
  return Outcome::accepted;
}

Outcome read_mesh(const fs::path& file, const std::string&) {
  load_scene(file.string());
  return Outcome::accepted;
}

Outcome read_answer_of_importer(const fs::path& file, const std::string& bytes) {
  Scene scene;
  importing::add_imported(file.string() + ".gltf", std::as_bytes(std::span(bytes)), {}, scene);
  if (scene.motion)
    for (const Animation& animation : scene.motion->animations) {
      Scene still = scene;
      pose(still, animation, animation.end() / 2);
    }
  finish_scene(scene, file.string());
  add_framing(scene);
  return Outcome::accepted;
}

}  // namespace fuzz
