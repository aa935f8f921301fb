#pragma once
#include <nlohmann/json.hpp>

namespace gnomon {

/// The machine and the build, for every record: version, commit, build_type, compiler, flags, processor, cores, threads,
/// load_average, started, libraries.
nlohmann::ordered_json machine_context(int threads);

}  // namespace gnomon
