// Eats memory: requests blocks of 1 GiB in resolve until there are none. It never touches them, so they cost the machine
// nothing but a promise, of which a worker has a limited number.
#include <memory>
#include <vector>

#include "faults/harmless.h"

namespace {
using namespace gnomon;

class EatsMemory final : public Harmless {
 public:
  void resolve(const GBuffer&, VisibilityMask&) override {
    for (;;) blocks_.push_back(std::make_unique_for_overwrite<char[]>(std::size_t{1} << 30));
  }

 private:
  std::vector<std::unique_ptr<char[]>> blocks_;
};

}  // namespace

GNOMON_TECHNIQUE(eats_memory, EatsMemory,
                 {.title = "Eats memory",
                  .summary = "Requests memory in resolve until there is none.",
                  .source = "none",
                  .error = "It is the error.",
                  .fails = "Always."})
