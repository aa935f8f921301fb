#pragma once
#include "measure/json.h"

namespace gnomon {

/// The build and the machine, for every record: the fields of build_context, processor, cores, threads, load_average, started,
/// libraries; and "shaders": "kept" where the environment keeps them.
Json machine_context(int threads);

/// The same of this program for another one that compares with it, with `technique_sources`.
Json program_context();

/// Whether GNOMON_SHADERS=keep lets all workers reuse shaders that earlier ones compiled: a setup includes no time of shaders
/// then, and records note it. Throws Error on another word.
bool environment_keeps_shaders();

}  // namespace gnomon
