#pragma once
#include <sys/types.h>

#include <functional>

namespace gnomon {

/// The last 64 KiB of a kept process's standard error are kept.
inline constexpr std::size_t most_last_words = 64 << 10;

/// Forks a keeper, and from it a process that runs `body`, which must end by exec or _exit and may use plain system calls only.
/// Whatever that process starts, in whatever session and with whatever environment, ends with it: when it ends, when the keeper
/// gets SIGTERM, and when the process that called this is gone, by whatever signal. The keeper ends as the process did, with
/// its status or its signal; by SIGTERM with status 0. `last_words`, a descriptor of a file or -1: receives the end of the
/// standard error of the process and its children; -1: that goes nowhere. Returns the keeper's number, or -1 as fork does.
pid_t fork_kept(const std::function<void()>& body, int last_words = -1);

/// Ends a keeper and all that it keeps, and waits until they are gone; one that does not go is killed.
void end_kept(pid_t keeper);

/// Whether a keeper has ended, and its status, as `waitpid` gives it. Once: the number is free then.
bool has_ended(pid_t keeper, int& status);

/// From now on this process ends the orphans of a keeper that is killed itself. For the program, not for a library's caller: it
/// ends the children of this process that have a session of their own and that no `fork_kept` made.
void end_orphans_of_keepers();

}  // namespace gnomon
