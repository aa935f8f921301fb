#pragma once
#include "measure/record/record.h"
#include "measure/run/suite.h"

namespace gnomon {

/// From fewer processes no interval of the bootstrap covers 95 %, or nearly (statistics.h).
inline constexpr std::size_t least_processes = 5;

/// Whether relight and resolve are known well enough: the 95 % interval of each is at most the share `interval` of its time
/// wide and comes from `least_processes` at least. Times that nothing is judged by (statistics.h's least_time) are.
bool is_narrow(const Record& record, double interval);

/// No row gets more processes than this, however wide its intervals are.
int most_processes(const Suite& suite);

}  // namespace gnomon
