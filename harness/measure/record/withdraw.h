#pragma once
#include <string>

#include "measure/record/record.h"

namespace gnomon {

/// Leaves what was asked, where, and what the technique said of its support: all that was measured goes.
void forget_results(Record& record);

/// Makes it an unsupported row with this reason and without results.
void withdraw(Record& record, const std::string& reason);

/// Withdraws a row of a light with area that was scored against the hard shadow of the light's center, as programs did while
/// their reference knew no other (frames of version 5 and before, see frame_version).
void withdraw_false_reference(Record& record);

}  // namespace gnomon
