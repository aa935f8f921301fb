#include <gnomon/kit/parallel.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_for_each.h>

#include <algorithm>

namespace gnomon {

void run_blocks(std::size_t count, std::size_t block, const void* work, void (*call)(const void*, std::size_t, std::size_t)) {
  const std::size_t blocks = (count + block - 1) / block;
  tbb::parallel_for(std::size_t{0}, blocks, [=](std::size_t i) { call(work, i * block, std::min(count, (i + 1) * block)); });
}

using Feeder = tbb::feeder<void*>;

void run_tasks(void* first, const void* work, void (*call)(const void* work, void* task, void* feeder)) {
  tbb::parallel_for_each(&first, &first + 1, [=](void* task, Feeder& feeder) { call(work, task, &feeder); });
}

void feed(void* feeder, void* task) { static_cast<Feeder*>(feeder)->add(task); }

}  // namespace gnomon
