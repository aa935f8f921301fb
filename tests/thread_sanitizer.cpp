// Tells the thread sanitizer what happens before what in TBB, which is built without it: who hands over a task had its say
// before the task begins, and what tasks did is done when the wait for them returns. These functions take the place of those of
// the library, which they call. Only linked where the sanitizer is on.
#include <dlfcn.h>
#include <sanitizer/tsan_interface.h>
#include <tbb/task_group.h>

#include <cstdlib>

namespace {

using namespace tbb::detail;

/// The library's function of that symbol.
template <class Function>
Function* original(const char* symbol) {
  return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, symbol));
}

/// Stands for a task that was handed over. Whoever executes it sees what the owner did before.
class HandedOver : public d1::task {
 public:
  explicit HandedOver(task& inner) : inner_(inner) { __tsan_release(this); }
  task* execute(d1::execution_data& data) override { return take_over(&task::execute, data); }
  task* cancel(d1::execution_data& data) override { return take_over(&task::cancel, data); }

 private:
  task* take_over(task* (task::*work)(d1::execution_data&), d1::execution_data& data) {
    __tsan_acquire(this);
    task* const next = (inner_.*work)(data);
    delete this;  // not when `execute` throws: the library calls `cancel` then
    return next;
  }
  task& inner_;
};

/// At its end, which may be an exception that a task threw. The last task has released the counter, which the sanitizer saw.
struct Waited {
  d1::wait_context& tasks;
  ~Waited() { __tsan_acquire(reinterpret_cast<char*>(&tasks) + sizeof(std::uint64_t)); }
};

}  // namespace

namespace tbb::detail::r1 {

void spawn(d1::task& task, d1::task_group_context& context) {
  static auto* const next =
      original<void(d1::task&, d1::task_group_context&)>("_ZN3tbb6detail2r15spawnERNS0_2d14taskERNS2_18task_group_contextE");
  next(*new HandedOver(task), context);
}

void spawn(d1::task& task, d1::task_group_context& context, d1::slot_id slot) {
  static auto* const next = original<void(d1::task&, d1::task_group_context&, d1::slot_id)>(
      "_ZN3tbb6detail2r15spawnERNS0_2d14taskERNS2_18task_group_contextEt");
  next(*new HandedOver(task), context, slot);
}

void execute_and_wait(d1::task& task, d1::task_group_context& context, d1::wait_context& waited,
                      d1::task_group_context& context_of_wait) {
  static auto* const next = original<void(d1::task&, d1::task_group_context&, d1::wait_context&, d1::task_group_context&)>(
      "_ZN3tbb6detail2r116execute_and_waitERNS0_2d14taskERNS2_18task_group_contextERNS2_12wait_contextES6_");
  const Waited at_end{waited};
  next(task, context, waited, context_of_wait);
}

void wait(d1::wait_context& waited, d1::task_group_context& context) {
  static auto* const next = original<void(d1::wait_context&, d1::task_group_context&)>(
      "_ZN3tbb6detail2r14waitERNS0_2d112wait_contextERNS2_18task_group_contextE");
  const Waited at_end{waited};
  next(waited, context);
}

// Tasks lie where the sanitizer sees that memory is given back and used again.
void* allocate(d1::small_object_pool*& pool, std::size_t size, const d1::execution_data&) { return allocate(pool, size); }
void* allocate(d1::small_object_pool*& pool, std::size_t size) {
  static std::uint64_t no_pool = 0;  // where one is, it is handed back to `deallocate`
  pool = reinterpret_cast<d1::small_object_pool*>(&no_pool);
  constexpr std::size_t line = 64;
  return std::aligned_alloc(line, (size + line - 1) / line * line);
}
void deallocate(d1::small_object_pool&, void* memory, std::size_t, const d1::execution_data&) { std::free(memory); }
void deallocate(d1::small_object_pool&, void* memory, std::size_t) { std::free(memory); }

}  // namespace tbb::detail::r1
