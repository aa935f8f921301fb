#pragma once
#include <cstddef>
#include <functional>

namespace gnomon {

/// Runs work(begin, end) for the blocks 0 .. block, block .. 2 block, ... of 0 .. count, on all threads that the process may
/// use, and returns when all are done. Which thread runs a block, and when, is open: a result must not depend on it. What work
/// throws is thrown here.
void for_blocks(std::size_t count, std::size_t block, const std::function<void(std::size_t begin, std::size_t end)>& work);

}  // namespace gnomon
