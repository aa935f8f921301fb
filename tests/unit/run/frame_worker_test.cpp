// Frames that a worker traces: the same as this process traces, and a reason where there are none.
#include "measure/run/frame_worker.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>

#include "measure/scene/load.h"
#include "places.h"

namespace {

using namespace gnomon;
namespace fs = std::filesystem;

TEST(frame_worker, makes_what_this_process_makes) {
  const ScratchFolder here = ScratchFolder::temporary("gnomon_frames"), there = ScratchFolder::temporary("gnomon_frames");
  const Scene scene = load_scene("composite");
  FrameStore ours(scene, here.path()), theirs(scene, there.path(), std::make_unique<FrameWorker>(fs::path(), tested_program()));
  for (const Truth truth : {Truth::shape, Truth::mesh}) {
    const FrameKey key{scene.views[0], 97, 61, truth};
    ours.gbuffer(key);
    theirs.gbuffer(key);
    for (const Light& light : scene.lights) {
      if (!reference_support(scene, light, key.view)) continue;
      ours.reference(key, light);
      theirs.reference(key, light);
    }
  }
  int files = 0;
  for (const auto& entry : fs::directory_iterator(here.path())) {
    ++files;
    const auto a = MappedFile::open(entry.path()), b = MappedFile::open(there.path() / entry.path().filename());
    EXPECT_TRUE(std::ranges::equal(a->bytes(), b->bytes())) << entry.path();
  }
  EXPECT_GE(files, 1 + 2 + 2);  // the scene, a G-buffer and a reference under each truth
}

TEST(frame_worker, says_how_the_worker_ended_and_asks_twice) {
  const ScratchFolder folder = ScratchFolder::temporary("gnomon_frames");
  const fs::path program = folder.path() / "program", starts = folder.path() / "starts";
  std::ofstream(program) << "#!/bin/bash\necho start >> " << starts.string()
                         << "\nread -r line <&$2\necho 'assertion failed' >&2\n"
                         << "kill -ABRT $$\n";
  fs::permissions(program, fs::perms::owner_all);
  const Scene scene = load_scene("single_triangle");
  FrameStore frames(scene, folder.path(), std::make_unique<FrameWorker>(folder.path() / "frame", program.string()));
  for (const int width : {64, 64, 32}) {
    try {
      frames.gbuffer({scene.views[0], width, 36, Truth::shape});
      ADD_FAILURE() << "a frame came from nowhere";
    } catch (const WorkerFailure& failure) {
      EXPECT_STREQ(failure.what(), "the reference crashed in trace: Aborted (signal 6); it said: assertion failed");
    }
  }
  std::ifstream lines(starts);
  EXPECT_EQ(std::count(std::istreambuf_iterator<char>(lines), {}, '\n'), 4);  // two for each size
}

TEST(frame_worker, a_worker_that_is_killed_costs_no_frame) {
  const ScratchFolder folder = ScratchFolder::temporary("gnomon_frames");
  const fs::path program = folder.path() / "program", mark = folder.path() / "was_killed";
  std::ofstream(program) << "#!/bin/bash\nif [ ! -e " << mark.string() << " ]; then touch " << mark.string()
                         << "; kill -KILL $$; fi\nexec " << tested_program() << " \"$@\"\n";
  fs::permissions(program, fs::perms::owner_all);
  const Scene scene = load_scene("single_triangle");
  FrameStore frames(scene, folder.path(), std::make_unique<FrameWorker>(folder.path() / "frame", program.string()));
  EXPECT_EQ(frames.gbuffer({scene.views[0], 64, 36, Truth::shape}).size(), 64u * 36u);
  EXPECT_TRUE(fs::exists(mark));
}

}  // namespace
