#include "measure/keeper.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

namespace keeper_test {

using namespace gnomon;

int ends[2] = {-1, -1};

void tell(int) { [[maybe_unused]] const ssize_t ignored = write(ends[1], "x", 1); }

// The window of the viewer closes when its handler writes to a pipe; a keeper that is told to end has the same handler and
// pipe.
TEST(keeper, what_it_is_told_reaches_no_handler_of_the_program) {
  ASSERT_EQ(pipe2(ends, O_CLOEXEC | O_NONBLOCK), 0);
  struct sigaction handler {};
  struct sigaction before {};
  handler.sa_handler = tell;
  ASSERT_EQ(sigaction(SIGTERM, &handler, &before), 0);
  for (int round = 0; round < 100; ++round) {
    const pid_t keeper = fork_kept([] {
      sleep(100);
      _exit(0);
    });
    ASSERT_GT(keeper, 0);
    end_kept(keeper);
  }
  char told = 0;
  EXPECT_LT(read(ends[0], &told, 1), 1);
  sigaction(SIGTERM, &before, nullptr);
  close(ends[0]);
  close(ends[1]);
}

TEST(keeper, ends_as_the_process_did) {
  for (const int number : {0, 3, SIGKILL, SIGUSR1}) {
    const bool is_signal = number == SIGKILL || number == SIGUSR1;
    const pid_t keeper = fork_kept([&] {
      if (is_signal) kill(getpid(), number);
      _exit(number);
    });
    int status = 0;
    while (!has_ended(keeper, status)) usleep(1000);
    if (is_signal)
      EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == number) << number;
    else
      EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == number) << number;
  }
}

}  // namespace keeper_test
