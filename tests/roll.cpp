// Calls the roll before main, so that tests find every technique and scene registered, and says where tree and program are.
#include <gnomon/registry.h>

#include <cstdlib>

#include "places.h"

extern "C" void gnomon_roll_call(gnomon::Registry& registry);

namespace {
[[maybe_unused]] const bool called = [] {
  setenv("GNOMON_ROOT", tree().c_str(), 0);
  setenv("GNOMON_PROGRAM", tested_program().c_str(), 0);
  gnomon_roll_call(gnomon::registry());
  return true;
}();
}  // namespace
