#include <gnomon/registry.h>

#include "app/app.h"

/// Written by the build from the names of the files in techniques/ and scenes/.
extern "C" void gnomon_roll_call(gnomon::Registry& registry);

int main(int argc, char** argv) {
  gnomon_roll_call(gnomon::registry());
  return gnomon::app::run_program(argc, argv);
}
