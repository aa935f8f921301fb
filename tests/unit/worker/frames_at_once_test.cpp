// Programs that request the same frames at the same time.
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <map>

#include "measure/frame/frame.h"
#include "measure/scene/load.h"
#include "measure/scratch_folder.h"
#include "places.h"

namespace frames_at_once_test {

using namespace gnomon;
namespace fs = std::filesystem;

std::map<std::string, std::string> files_of(const fs::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.is_regular_file()) {
      std::ifstream in(entry.path(), std::ios::binary);
      files[entry.path().filename()] = {std::istreambuf_iterator<char>(in), {}};
    }
  return files;
}

TEST(frame, processes_that_make_the_same_frames_at_once_do_not_disturb_each_other) {
  const ScratchFolder folder = ScratchFolder::temporary("gnomon_frame");
  const fs::path cache = folder.path() / "cache";
  std::vector<FILE*> running;
  for (int k = 0; k < 4; ++k) {
    const std::string command =
        fmt::format("GNOMON_CACHE='{}' '{}' render --scene contact --technique unshadowed --size 64x36 --out '{}' 2>&1",
                    cache.string(), tested_program(), (folder.path() / fmt::format("out_{}", k)).string());
    running.push_back(popen(command.c_str(), "r"));
    ASSERT_TRUE(running.back());
  }
  for (FILE* pipe : running) {
    std::string said;
    for (int c; (c = std::fgetc(pipe)) != EOF;) said += static_cast<char>(c);
    EXPECT_EQ(pclose(pipe), 0) << said;
  }
  // What they left is what one process makes alone, with no temporary file beside it.
  const Scene scene = load_scene("contact");
  FrameStore alone(scene, folder.path() / "alone");
  const FrameKey key{scene.views[0], 64, 36, Truth::shape};
  for (const Light& light : scene.lights) alone.reference(key, light);
  alone.scene_file();
  const auto made = files_of(cache / "frames");
  for (const auto& [name, bytes] : files_of(folder.path() / "alone")) {
    ASSERT_TRUE(made.contains(name)) << name;
    EXPECT_TRUE(made.at(name) == bytes) << name;
  }
  for (const auto& [name, bytes] : made) EXPECT_FALSE(name.ends_with(".part")) << name;
}

}  // namespace frames_at_once_test
