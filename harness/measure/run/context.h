#pragma once
#include "measure/json.h"

namespace gnomon {

/// The machine and the build, for every record: version, commit, build_type, compiler, flags, processor, cores, threads,
/// load_average, started, libraries.
Json machine_context(int threads);

}  // namespace gnomon
