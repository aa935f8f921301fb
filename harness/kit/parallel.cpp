#include <gnomon/kit/parallel.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_for_each.h>

#include <algorithm>

namespace gnomon {

void for_blocks(std::size_t count, std::size_t block, const std::function<void(std::size_t, std::size_t)>& work) {
  const std::size_t blocks = (count + block - 1) / block;
  tbb::parallel_for(std::size_t{0}, blocks, [&](std::size_t i) { work(i * block, std::min(count, (i + 1) * block)); });
}

void for_pointers(void* first, const std::function<void(void*, const std::function<void(void*)>&)>& work) {
  tbb::parallel_for_each(&first, &first + 1,
                         [&](void* task, tbb::feeder<void*>& feeder) { work(task, [&](void* added) { feeder.add(added); }); });
}

}  // namespace gnomon
