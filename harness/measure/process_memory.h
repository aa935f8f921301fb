#pragma once

namespace gnomon {

/// Largest resident memory so far of this process, and of each process below it that still runs, bytes. Memory that two of them
/// share counts for each.
double peak_bytes();

/// Resident memory of a process that it shares with no file, bytes; 0 when it has ended.
double own_resident_bytes(int process);

}  // namespace gnomon
