// Names more causes: all lit, and of its own it says why: the right half of a picture is out of its sight. It shares one cause
// with names_causes, which has it at another place of its data sheet.
#include "faults/harmless.h"

namespace {
using namespace gnomon;

constexpr OwnCause causes[] = {
    {"right_half", "The right half of the picture is out of its sight.", {240, 172, 240}},
    {"never", "A cause that holds nowhere.", {20, 255, 148}},
};

class NamesMore final : public Harmless {
 public:
  void resolve(const GBuffer& gbuffer, VisibilityMask& mask) override {
    Harmless::resolve(gbuffer, mask);
    width_ = static_cast<std::size_t>(gbuffer.width);
  }
  std::optional<Explanation> explain(std::size_t index) const override {
    Explanation why;
    if (index % width_ >= width_ / 2) why.cause = "right_half";
    return why;
  }

 private:
  std::size_t width_ = 1;
};

}  // namespace

GNOMON_TECHNIQUE(names_more, NamesMore,
                 {.title = "Names more causes",
                  .summary = "Lights everything, and has other causes of its own.",
                  .source = "none",
                  .error = "All of it.",
                  .fails = "Everywhere.",
                  .causes = causes})
