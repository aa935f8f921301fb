#include "measure/process_memory.h"

#include <fmt/format.h>
#include <unistd.h>

#include <charconv>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>

namespace gnomon {

namespace {

/// By the number of their parent, the processes that run now. Those that end meanwhile are left out.
std::multimap<int, int> processes_by_parent() {
  std::multimap<int, int> children;
  std::error_code error;
  for (auto it = std::filesystem::directory_iterator("/proc", error); !error && it != std::filesystem::directory_iterator();
       it.increment(error)) {
    const std::string name = it->path().filename().string();
    int process = 0, parent = 0;
    if (std::from_chars(name.data(), name.data() + name.size(), process).ptr != name.data() + name.size()) continue;
    std::string text;
    std::getline(std::ifstream(it->path() / "stat"), text, '\0');
    const std::size_t name_end = text.rfind(')');  // "12 (a name) S 7 ...": the state, then the parent
    if (name_end == text.npos || text.size() < name_end + 5) continue;
    std::from_chars(text.data() + name_end + 4, text.data() + text.size(), parent);
    children.emplace(parent, process);
  }
  return children;
}

/// 0 when it has ended. Not from getrusage: that figure survives exec, and would be the parent's.
double peak_of(int process) {
  std::ifstream status(fmt::format("/proc/{}/status", process));
  for (std::string line; std::getline(status, line);)
    if (line.starts_with("VmHWM:")) return 1024.0 * std::stod(line.substr(6));
  return 0;
}

double peak_of_all(int process, const std::multimap<int, int>& children) {
  double bytes = peak_of(process);
  for (auto [it, end] = children.equal_range(process); it != end; ++it) bytes += peak_of_all(it->second, children);
  return bytes;
}

}  // namespace

double peak_bytes() { return peak_of_all(getpid(), processes_by_parent()); }

double own_resident_bytes(int process) {
  std::ifstream file(fmt::format("/proc/{}/statm", process));
  double size = 0, resident = 0, shared = 0;
  file >> size >> resident >> shared;
  return file ? (resident - shared) * static_cast<double>(sysconf(_SC_PAGESIZE)) : 0;
}

}  // namespace gnomon
