#pragma once
#include "measure/json.h"

namespace gnomon {

/// The machine and the build, for every record: version, commit, build_type, compiler, flags, processor, cores, threads,
/// load_average, started, libraries; and "shaders": "kept" where the environment keeps them.
Json machine_context(int threads);

/// Whether GNOMON_SHADERS=keep lets all workers take what earlier ones compiled: a setup tells no time of shaders then, and
/// records say so. Throws Error on another word.
bool environment_keeps_shaders();

}  // namespace gnomon
