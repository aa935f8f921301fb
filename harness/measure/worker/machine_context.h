#pragma once
#include "measure/json.h"

namespace gnomon {

/// The build and the machine, for every record: what build_context has, processor, cores, threads, load_average, started,
/// libraries; and "shaders": "kept" where the environment keeps them.
Json machine_context(int threads);

/// The same of this program for another one that compares with it, and beside it `technique_sources`.
Json program_context();

/// Whether GNOMON_SHADERS=keep lets all workers take what earlier ones compiled: a setup tells no time of shaders then, and
/// records say so. Throws Error on another word.
bool environment_keeps_shaders();

}  // namespace gnomon
