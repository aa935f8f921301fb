// What a program reads is written anew only where it is another one: of a scene that moved, its positions alone.
#include "measure/program/program_files.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cstring>
#include <map>

#include "generated_scene.h"
#include "measure/scene/blob.h"

namespace program_files_test {
using namespace gnomon;
namespace fs = std::filesystem;

/// Which file lies under a name now: another one under the same name has another number or another time.
std::pair<ino_t, std::int64_t> identity(const fs::path& file) {
  struct stat facts {};
  EXPECT_EQ(stat(file.c_str(), &facts), 0) << file;
  return {facts.st_ino, facts.st_mtim.tv_sec * 1'000'000'000 + facts.st_mtim.tv_nsec};
}

std::map<std::string, std::pair<ino_t, std::int64_t>> identities(const fs::path& folder) {
  std::map<std::string, std::pair<ino_t, std::int64_t>> all;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) all[entry.path().filename()] = identity(entry.path());
  return all;
}

std::string text_of(const fs::path& file) {
  const auto mapped = MappedFile::copy(file);
  return {reinterpret_cast<const char*>(mapped->bytes().data()), mapped->bytes().size()};
}

std::vector<std::string> differing(const fs::path& folder,
                                   const std::map<std::string, std::pair<ino_t, std::int64_t>>& before) {
  std::vector<std::string> names;
  for (const auto& [name, now] : identities(folder))
    if (!before.contains(name) || before.at(name) != now) names.push_back(name);
  return names;
}

TEST(program_inputs, of_a_scene_that_moved_only_positions_are_written_again) {
  const ProgramDescription description{};
  ProgramInputs inputs(description);
  Scene scene = generated::make("fence");
  const Json first = inputs.scene(scene);
  const auto before = identities(inputs.folder());
  EXPECT_EQ(before.size(), 4u);  // scene.json, and the arrays position, triangle and mesh
  EXPECT_EQ(inputs.scene(scene), first);
  EXPECT_TRUE(differing(inputs.folder(), before).empty());

  const std::string positions = text_of(inputs.folder() / "scene_position.npy");
  const auto still_mapped = MappedFile::open(inputs.folder() / "scene_position.npy");
  scene.meshes.back().positions.back().x += 1;
  EXPECT_EQ(inputs.scene(scene), first);
  EXPECT_EQ(differing(inputs.folder(), before), std::vector<std::string>{"scene_position.npy"});
  EXPECT_NE(text_of(inputs.folder() / "scene_position.npy"), positions);
  EXPECT_EQ(std::memcmp(still_mapped->bytes().data(), positions.data(), positions.size()), 0) << "who maps it sees the old one";

  scene.meshes.back().positions.back().x -= 1;
  inputs.scene(scene);
  EXPECT_EQ(text_of(inputs.folder() / "scene_position.npy"), positions);
}

TEST(program_inputs, of_another_scene_all_that_differs_is_written) {
  const ProgramDescription description{};
  ProgramInputs inputs(description);
  inputs.scene(generated::make("fence"));
  const auto before = identities(inputs.folder());
  Scene scene = generated::make("fence");
  scene.meshes[0].receives = false;
  inputs.scene(scene);
  EXPECT_EQ(differing(inputs.folder(), before), std::vector<std::string>{"scene.json"});
  inputs.scene(generated::make("single_triangle"));
  EXPECT_EQ(differing(inputs.folder(), before).size(), 4u);
  const Json facts = parse_json(text_of(inputs.folder() / "scene.json"));
  EXPECT_EQ(facts.at("name"), "single_triangle");
  EXPECT_EQ(facts.at("arrays").at("mesh").at("shape"), Json({3}));
}

TEST(program_inputs, of_a_program_that_reads_gltf_alone_its_file_follows_what_moves) {
  ProgramDescription description;
  description.wants_scene_arrays = false;
  description.wants_gltf = true;
  ProgramInputs inputs(description);
  Scene scene = generated::make("single_triangle");
  inputs.scene(scene);
  std::map<std::string, std::string> before;
  for (const auto& [name, unused] : identities(inputs.folder())) before[name] = text_of(inputs.folder() / name);
  EXPECT_FALSE(before.contains("scene_position.npy"));
  scene.meshes.back().positions.back().x += 1;
  inputs.scene(scene);
  std::vector<std::string> other;
  for (const auto& [name, text] : before)
    if (text_of(inputs.folder() / name) != text) other.push_back(name);
  EXPECT_FALSE(other.empty());
  EXPECT_EQ(std::ranges::find(other, "scene.json"), other.end());
}

}  // namespace program_files_test
