#include "measure/process_memory.h"

#include <fmt/format.h>
#include <unistd.h>

#include <fstream>
#include <string>

namespace gnomon {

// Not from getrusage: that figure survives exec, and would be the parent's.
double peak_bytes() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.starts_with("VmHWM:")) return 1024.0 * std::stod(line.substr(6));
  return 0;
}

double own_resident_bytes(int process) {
  std::ifstream file(fmt::format("/proc/{}/statm", process));
  double size = 0, resident = 0, shared = 0;
  file >> size >> resident >> shared;
  return file ? (resident - shared) * static_cast<double>(sysconf(_SC_PAGESIZE)) : 0;
}

}  // namespace gnomon
