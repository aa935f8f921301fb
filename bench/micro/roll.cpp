// Calls the roll before main, so that benchmarks find every technique and scene registered.
#include <gnomon/registry.h>

extern "C" void gnomon_roll_call(gnomon::Registry& registry);

namespace {
[[maybe_unused]] const bool called = (gnomon_roll_call(gnomon::registry()), true);
}
