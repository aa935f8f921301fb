#include <gnomon/kit/progress.h>
#include <gtest/gtest.h>

namespace progress_test {
using namespace gnomon;

TEST(progress, goes_where_it_is_watched) {
  tell_progress(0.5);  // nowhere
  std::atomic<std::size_t> steps = 7;
  watch_progress(&steps);
  tell_progress(0.25);
  EXPECT_EQ(steps, progress_steps / 4);
  tell_progress(2);
  EXPECT_EQ(steps, progress_steps);
  tell_progress(-1);
  EXPECT_EQ(steps, 0u);
  watch_progress(nullptr);
  tell_progress(0.5);
  EXPECT_EQ(steps, 0u);
}

}  // namespace progress_test
