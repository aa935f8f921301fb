// Names more causes: all lit, and of its own it says why: the right half of a picture is out of its sight. It shares one cause
// with names_causes, which has it at another place of its data sheet.
#include "faults/names_half.h"

namespace {
using namespace gnomon;

constexpr OwnCause more_causes[] = {
    {"right_half", "The right half of the picture is out of its sight.", {240, 172, 240}},
    {"never", "A cause that holds nowhere.", {20, 255, 148}},
};

class NamesMore final : public NamesHalf {
 public:
  NamesMore() : NamesHalf(Half::right, "right_half") {}
};

}  // namespace

GNOMON_TECHNIQUE(names_more, NamesMore,
                 {.title = "Names more causes",
                  .summary = "Lights everything, and has other causes of its own.",
                  .source = "none",
                  .error = "All of it.",
                  .fails = "Everywhere.",
                  .causes = more_causes})
