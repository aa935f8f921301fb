#pragma once
#include "measure/record/record.h"

namespace gnomon {

/// Hash of the plugin that the row's technique came from; "" for a row of no plugin.
std::string plugin_hash(const Record& record);

/// Whether the row is of a mask that another program made: `gnomon score --label`. No technique runs for it.
bool is_foreign(const Record& record);

}  // namespace gnomon
