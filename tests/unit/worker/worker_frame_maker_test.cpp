// Frames that a worker traces: the same as this process traces, and a reason where there are none.
#include "measure/worker/worker_frame_maker.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <regex>
#include <thread>

#include "measure/scene/load.h"
#include "measure/worker/shared_count.h"
#include "places.h"

namespace worker_frame_maker_test {

using namespace gnomon;
namespace fs = std::filesystem;

TEST(worker_frame_maker, makes_what_this_process_makes) {
  const ScratchFolder here = ScratchFolder::temporary("gnomon_frames"), there = ScratchFolder::temporary("gnomon_frames");
  const Scene scene = load_scene("composite");
  FrameStore ours(scene, here.path()),
      theirs(scene, there.path(), std::make_unique<WorkerFrameMaker>(fs::path(), tested_program()));
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
    if (!entry.is_regular_file()) continue;
    ++files;
    const auto a = MappedFile::open(entry.path()), b = MappedFile::open(there.path() / entry.path().filename());
    EXPECT_TRUE(std::ranges::equal(a->bytes(), b->bytes())) << entry.path();
  }
  EXPECT_GE(files, 1 + 2 + 2);  // the scene, a G-buffer and a reference under each truth
}

TEST(worker_frame_maker, says_how_the_worker_ended_and_asks_twice) {
  const ScratchFolder folder = ScratchFolder::temporary("gnomon_frames");
  const fs::path program = folder.path() / "program", starts = folder.path() / "starts";
  std::ofstream(program) << "#!/bin/bash\necho start >> " << starts.string()
                         << "\nread -r line <&$2\necho 'assertion failed' >&2\n"
                         << "kill -ABRT $$\n";
  fs::permissions(program, fs::perms::owner_all);
  const Scene scene = load_scene("single_triangle");
  FrameStore frames(scene, folder.path(), std::make_unique<WorkerFrameMaker>(folder.path() / "frame", program.string()));
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

TEST(worker_frame_maker, a_worker_that_is_killed_costs_no_frame) {
  const ScratchFolder folder = ScratchFolder::temporary("gnomon_frames");
  const fs::path program = folder.path() / "program", mark = folder.path() / "was_killed";
  std::ofstream(program) << "#!/bin/bash\nif [ ! -e " << mark.string() << " ]; then touch " << mark.string()
                         << "; kill -KILL $$; fi\nexec " << tested_program() << " \"$@\"\n";
  fs::permissions(program, fs::perms::owner_all);
  const Scene scene = load_scene("single_triangle");
  FrameStore frames(scene, folder.path(), std::make_unique<WorkerFrameMaker>(folder.path() / "frame", program.string()));
  EXPECT_EQ(frames.gbuffer({scene.views[0], 64, 36, Truth::shape}).size(), 64u * 36u);
  EXPECT_TRUE(fs::exists(mark));
}

/// A rectangle over single_triangle.
Scene under_a_lamp() {
  Scene scene = load_scene("single_triangle");
  scene.lights = {{.name = "lamp", .kind = RectLight{{0.3f, 4, 0.2f}, {0.5f, 0, 0}, {0, 0, 0.5f}}}};
  return scene;
}

TEST(worker_frame_maker, counts_the_pixels_of_a_soft_reference) {
  const ScratchFolder folder = ScratchFolder::temporary("gnomon_frames");
  const Scene scene = under_a_lamp();
  std::vector<double> shares;
  const auto watch = [&](const MissingFrame& missing, double share) {
    if (missing.light) shares.push_back(share);
  };
  FrameStore frames(scene, folder.path(), std::make_unique<WorkerFrameMaker>(folder.path() / "frame", tested_program(), watch));
  frames.reference({scene.views[0], 64, 36, Truth::shape}, scene.lights[0]);
  ASSERT_FALSE(shares.empty());
  EXPECT_TRUE(std::ranges::is_sorted(shares));
  EXPECT_EQ(shares.back(), 1);
}

TEST(worker_frame_maker, what_makes_a_soft_reference_counts_each_pixel) {
  struct Counting : FrameMaker {
    FrameTracer tracer;
    std::atomic<std::size_t>& done;
    Counting(const Scene& scene, std::atomic<std::size_t>& count) : tracer(scene), done(count) {}
    std::vector<std::byte> make(const MissingFrame& missing) override {
      MissingFrame counted = missing;
      counted.done = &done;
      return tracer.make(counted);
    }
  };
  const ScratchFolder folder = ScratchFolder::temporary("gnomon_frames");
  const Scene scene = under_a_lamp();
  SharedCount done;
  FrameStore frames(scene, folder.path(), std::make_unique<Counting>(scene, done.value()));
  frames.reference({scene.views[0], 64, 36, Truth::shape}, scene.lights[0]);
  EXPECT_EQ(SharedCount(done.place()).value(), 64u * 36u);
}

// A worker that has done 1,152 = 0x480 pixels of 2,304, takes its time and ends.
TEST(worker_frame_maker, says_meanwhile_how_much_is_done) {
  const ScratchFolder folder = ScratchFolder::temporary("gnomon_frames");
  const fs::path program = folder.path() / "program";
  std::ofstream(program) << "#!/bin/bash\nread -r line <&$2\ndone=${line#*'\"done\":\"'}\n"
                            "printf '\\x80\\x04' | dd conv=notrunc status=none of=\"${done%%'\"'*}\"\nsleep 1\nexit 3\n";
  fs::permissions(program, fs::perms::owner_all);
  const Scene scene = load_scene("single_triangle");
  std::vector<double> shares;
  const auto watch = [&](const MissingFrame& missing, double share) {
    EXPECT_FALSE(missing.light);
    shares.push_back(share);
  };
  FrameStore frames(scene, folder.path(), std::make_unique<WorkerFrameMaker>(folder.path() / "frame", program.string(), watch));
  EXPECT_THROW(frames.gbuffer({scene.views[0], 64, 36, Truth::shape}), WorkerFailure);
  EXPECT_TRUE(std::ranges::count(shares, 0.5) > 0);
  EXPECT_EQ(shares.back(), 1);
}

TEST(shared_count, is_of_one_process_where_there_is_no_file_for_it) {
  const ScratchFolder folder = ScratchFolder::temporary("gnomon_frames");
  SharedCount missing((folder.path() / "missing").string());
  EXPECT_EQ(missing.value() += 3, 3u);
  std::ofstream(folder.path() / "short") << "1234567";
  SharedCount short_one((folder.path() / "short").string());
  EXPECT_EQ(short_one.value() += 3, 3u);
  SharedCount one, other(one.place());
  one.value() += 3;
  EXPECT_EQ(other.value(), 3u);
  EXPECT_NE(truncate(one.place().c_str(), 0), 0) << "nobody shortens what another has in its memory";
  EXPECT_EQ(one.value(), 3u);
}

// Off terminals a part that takes long has a line from its sixth second on, and a short one none.
TEST(progress, a_part_that_takes_long_has_plain_lines) {
  ::testing::internal::CaptureStderr();
  {
    Progress progress;
    progress.part("reference of a, b", 0);
    progress.part("reference of a, b", 0.25);
    progress.end_part();
    progress.part("reference of a, c", 0);
    std::this_thread::sleep_for(std::chrono::milliseconds(5100));
    progress.part("reference of a, c", 0.25);
    progress.part("reference of a, c", 0.26);
    progress.end_part();
  }
  const std::string lines = ::testing::internal::GetCapturedStderr();
  EXPECT_TRUE(std::regex_match(lines, std::regex(" 25 %  [0-9]+ s left +reference of a, c\n"))) << lines;
}

}  // namespace worker_frame_maker_test
