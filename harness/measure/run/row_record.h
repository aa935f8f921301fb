#pragma once
#include "measure/run/row.h"

namespace gnomon {

/// A record with all that is known before anything runs. `scene` is null where it is not fetched.
Record start_record(const Job& job, const Suite& suite, const Scene* scene, const Json& context);

/// Writes mask, error and shaded picture below `out` and names them in the record.
void write_pictures(Record& record, const SceneRun& run, const MeasuredRow& measured, const std::filesystem::path& out);
/// Removes those that the record names.
void remove_pictures(const Record& record, const std::filesystem::path& out);

}  // namespace gnomon
