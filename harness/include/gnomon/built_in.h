#pragma once
#include <gnomon/registry.h>

/// Written by the build from the names of the files in techniques/ and scenes/.
extern "C" void gnomon_roll_call(gnomon::Registry& registry);

namespace gnomon {

/// Adds all techniques and generated scenes of Gnomon itself. For programs other than `gnomon`, which link gnomon::techniques;
/// once a process.
inline void add_built_in(Registry& registry) { gnomon_roll_call(registry); }

}  // namespace gnomon
