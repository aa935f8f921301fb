// Reserves addresses: a thousand times more than the machine has memory, as the driver of a GPU may. It writes to none of them,
// and nothing goes wrong.
#include <gnomon/error.h>
#include <sys/mman.h>

#include "faults/harmless.h"

namespace {
using namespace gnomon;

class Reserves final : public Harmless {
 public:
  void setup() override {
    constexpr std::size_t bytes = std::size_t{1} << 45;
    if (mmap(nullptr, bytes, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0) == MAP_FAILED)
      throw Error("{} bytes of addresses were refused", bytes);
  }
};

}  // namespace

GNOMON_TECHNIQUE(reserves, Reserves,
                 {.title = "Reserves addresses",
                  .summary = "Reserves far more addresses than there is memory, and uses none.",
                  .source = "none",
                  .error = "Lit everywhere.",
                  .fails = "Never."})
