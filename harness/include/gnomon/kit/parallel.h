#pragma once
#include <cstddef>
#include <functional>

namespace gnomon {

/// Private to for_tasks.
void for_pointers(void* first, const std::function<void(void* task, const std::function<void(void*)>& add)>& work);

/// Runs work(begin, end) for the blocks 0 .. block, block .. 2 block, ... of 0 .. count, on all threads that the process may
/// use, and returns when all are done. Which thread runs a block, and when, is open: a result must not depend on it. What work
/// throws is thrown here.
void for_blocks(std::size_t count, std::size_t block, const std::function<void(std::size_t begin, std::size_t end)>& work);

/// Runs work(task, add) for a first task and for every task that work adds by add(task), on all threads, and returns when all
/// are done. The rest as for blocks. A task is a pointer.
template <class Task>
void for_tasks(Task first, const auto& work) {
  for_pointers(first, [&](void* task, const std::function<void(void*)>& add) { work(static_cast<Task>(task), add); });
}

}  // namespace gnomon
