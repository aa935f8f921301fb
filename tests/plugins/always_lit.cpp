// Always lit: a second plugin beside the faults, which does nothing wrong.
#include "faults/harmless.h"

namespace {
using namespace gnomon;

class AlwaysLit final : public Harmless {};

}  // namespace

GNOMON_TECHNIQUE(always_lit, AlwaysLit,
                 {.title = "Always lit",
                  .summary = "There are no shadows.",
                  .source = "none",
                  .error = "Every shadow.",
                  .fails = "Wherever there is one."})
