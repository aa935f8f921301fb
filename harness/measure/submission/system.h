#pragma once
#include "measure/record/record.h"

namespace gnomon {

/// This machine, and what drew the rows: what submission.json has as `system`. What is unknown is null.
Json describe_system(std::span<const Record> records);

}  // namespace gnomon
