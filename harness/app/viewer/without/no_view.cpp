#include "app/app.h"

namespace gnomon::app {

/// Built with GNOMON_VIEWER=OFF.
void add_view(Program& program) {
  struct None {};
  program.line.command<None>("view", "A window; this program was built without it", [](None&) -> int {
    throw Error("this program was built without its window: configure with -DGNOMON_VIEWER=ON");
  });
}

}  // namespace gnomon::app
