#pragma once
// Private to formats: what assimp does not see in files that it reads.
#include "measure/formats/mesh_file.h"

namespace gnomon::importing {

/// Throws Error where a 3DS file is shorter than it says or a face names a vertex that is not there, and where an IFC file has
/// no end: importers fill what is missing with what they read last, and mend indices in silence.
void check_foreign(const std::filesystem::path& file, const ReadFile& read);

}  // namespace gnomon::importing
