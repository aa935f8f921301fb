#include "measure/scratch_folder.h"

#include <gnomon/error.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>
#include <optional>

namespace scratch_folder_test {

using namespace gnomon;
namespace fs = std::filesystem;

TEST(scratch_folder, is_removed_with_all_that_is_in_it) {
  std::optional<ScratchFolder> folder(ScratchFolder::temporary("gnomon_scratch"));
  const fs::path path = folder->path();
  fs::create_directories(path / "below");
  std::ofstream(path / "below/file") << "text";
  const ScratchFolder named = ScratchFolder::at(path / "a/b");
  EXPECT_TRUE(fs::is_directory(path / "a/b"));
  folder.reset();
  EXPECT_FALSE(fs::exists(path));
}

TEST(scratch_folder, two_of_one_prefix_differ_and_one_that_moves_is_removed_once) {
  const ScratchFolder outer = ScratchFolder::temporary("gnomon_scratch");
  const ScratchFolder one = ScratchFolder::in(outer.path(), "x"), two = ScratchFolder::in(outer.path(), "x");
  EXPECT_NE(one.path(), two.path());
  {
    ScratchFolder first = ScratchFolder::in(outer.path(), "y");
    const fs::path path = first.path();
    const ScratchFolder second = std::move(first);
    EXPECT_EQ(second.path(), path);
    EXPECT_TRUE(fs::is_directory(path));
  }
  EXPECT_EQ(std::distance(fs::directory_iterator(outer.path()), {}), 2);
}

TEST(scratch_folder, what_a_killed_process_left_in_memory_is_removed) {
  // A process that has ended and been waited for has no number any more; ours has one.
  const pid_t child = fork();
  if (child == 0) _exit(0);
  ASSERT_EQ(waitpid(child, nullptr, 0), child);
  const ScratchFolder ours = ScratchFolder::in_memory("gnomon-scratch-test");
  const fs::path root = ours.path().parent_path();
  const fs::path dead = root / fmt::format("gnomon-scratch-test-{}", child), other = root / "gnomon-scratch-test-x";
  fs::create_directories(dead);
  fs::create_directories(other);
  const ScratchFolder again = ScratchFolder::in_memory("gnomon-scratch-test");
  EXPECT_FALSE(fs::exists(dead));
  EXPECT_TRUE(fs::exists(other)) << "its name has no number of a process";
  fs::remove_all(other);
}

TEST(scratch_folder, a_place_that_cannot_be_written_is_an_error) {
  const ScratchFolder outer = ScratchFolder::temporary("gnomon_scratch");
  std::ofstream(outer.path() / "file") << "text";
  EXPECT_THROW(ScratchFolder::at(outer.path() / "file/below"), Error);
  EXPECT_THROW(ScratchFolder::in(outer.path() / "file", "x"), Error);
}

}  // namespace scratch_folder_test
