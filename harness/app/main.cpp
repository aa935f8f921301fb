#include <gnomon/registry.h>

// Installed as source, to be linked with other techniques: it declares what it calls and needs no header but the contract's.
namespace gnomon::app {
int run_program(int argc, char** argv);
}

/// Written by the build from the names of the files in techniques/ and scenes/.
extern "C" void gnomon_roll_call(gnomon::Registry& registry);

int main(int argc, char** argv) {
  gnomon_roll_call(gnomon::registry());
  return gnomon::app::run_program(argc, argv);
}
