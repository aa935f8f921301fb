#pragma once

namespace gnomon {

/// Largest resident memory of this process so far, bytes.
double peak_bytes();

/// Resident memory of a process that it shares with no file, bytes; 0 when it has ended.
double own_resident_bytes(int process);

}  // namespace gnomon
