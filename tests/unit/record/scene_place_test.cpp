// Where the file of a record's scene is, seen from a run's folder; stills have the place of their scene and their own time.
#include "measure/record/scene_place.h"

#include <gtest/gtest.h>

#include <fstream>

#include "measure/scratch_folder.h"

namespace scene_place_test {

using namespace gnomon;
namespace fs = std::filesystem;

TEST(scene_place, a_still_is_found_again_by_the_place_of_its_scene_at_its_time) {
  const ScratchFolder scratch = ScratchFolder::temporary("gnomon_place");
  const fs::path& folder = scratch.path();
  std::ofstream(folder / "x.obj") << "v 0 0 0\n";
  const fs::path run = folder / "runs/a";
  fs::create_directories(run);
  for (const std::string time : {"", "@1.5", "@walk=0.25"}) {
    EXPECT_EQ(path_to_scene(run, (folder / "x.obj").string() + time), "../../x.obj");
    Record record;
    record.scene = "elsewhere/x.obj" + time;
    record.context = {{"scene_file", "../../x.obj"}};
    EXPECT_EQ(scene_reference(record, run), (folder / "x.obj").string() + time);
    record.context = {{"scene_file", "../../gone.obj"}};
    EXPECT_EQ(scene_reference(record, run), record.scene);
  }
  EXPECT_EQ(path_to_scene(run, "walking_boxes@walk=0.25"), std::nullopt);
}

}  // namespace scene_place_test
