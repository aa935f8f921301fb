#pragma once
#include <cstddef>

namespace gnomon {

/// Private to for_blocks and for_tasks: `call` calls `work`.
void run_blocks(std::size_t count, std::size_t block, const void* work, void (*call)(const void*, std::size_t, std::size_t));
void run_tasks(void* first, const void* work, void (*call)(const void* work, void* task, void* feeder));
void feed(void* feeder, void* task);

/// Runs work(begin, end) for the blocks 0 .. block, block .. 2 block, ... of 0 .. count, on all threads that the process may
/// use, and returns when all are done. Which thread runs a block, and when, is open: a result must not depend on it. What work
/// throws is thrown here.
template <class Work>
void for_blocks(std::size_t count, std::size_t block, const Work& work) {
  run_blocks(count, block, &work,
             [](const void* w, std::size_t begin, std::size_t end) { (*static_cast<const Work*>(w))(begin, end); });
}

/// Runs work(task, add) for a first task and for every task that work adds by add(task), on all threads, and returns when all
/// are done. The rest as for blocks. A task is a pointer.
template <class Task, class Work>
void for_tasks(Task first, const Work& work) {
  run_tasks(first, &work, [](const void* w, void* task, void* feeder) {
    (*static_cast<const Work*>(w))(static_cast<Task>(task), [feeder](Task added) { feed(feeder, added); });
  });
}

}  // namespace gnomon
