// Names causes: all lit, and of its own it says why: the left half of a picture is out of its sight, of the rest nothing. The
// environment makes it name a cause that it does not declare, or declare one in a color that is taken.
#include <cstdlib>

#include "faults/names_half.h"

namespace {
using namespace gnomon;

std::string word(const char* variable) {
  const char* text = std::getenv(variable);
  return text ? text : "";
}

const std::array<std::uint8_t, 3> acne_color{224, 120, 0}, free_color{252, 0, 132};
const OwnCause causes[] = {
    {"left_half", "The left half of the picture is out of its sight.",
     word("GNOMON_TEST_COLOR") == "taken" ? acne_color : free_color},
    {"never", "A cause that holds nowhere.", {20, 255, 148}},
};

class NamesCauses final : public NamesHalf {
 public:
  NamesCauses() : NamesHalf(Half::left, "left_half") {}

  std::optional<Explanation> explain(std::size_t index) const override {
    auto why = NamesHalf::explain(index);
    if (const std::string other = word("GNOMON_TEST_CAUSE"); !other.empty()) why->cause = other;
    return why;
  }
};

}  // namespace

GNOMON_TECHNIQUE(names_causes, NamesCauses,
                 {.title = "Names causes",
                  .summary = "Lights everything, and has causes of its own.",
                  .source = "none",
                  .error = "All of it.",
                  .fails = "When it is told to.",
                  .causes = causes})
