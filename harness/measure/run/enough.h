#pragma once
#include "measure/record/record.h"
#include "measure/run/suite.h"

namespace gnomon {

/// Whether relight and resolve are known well enough: the 95 % interval of each is at most the share `interval` of its time
/// wide. Times that nothing is judged by (compare.h's least_time) are; a row with one process is not.
bool is_narrow(const Record& record, double interval);

/// No row gets more processes than this, however wide its intervals are.
int most_processes(const Suite& suite);

}  // namespace gnomon
