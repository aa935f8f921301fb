#include "run_input.h"

#include <fmt/format.h>
#include <gnomon/error.h>
#include <sys/resource.h>

#include <fstream>
#include <regex>

namespace fuzz {

namespace fs = std::filesystem;

namespace {

double seconds_of(int who) {
  rusage used{};
  getrusage(who, &used);
  const auto seconds = [](const timeval& t) { return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec); };
  return seconds(used.ru_utime) + seconds(used.ru_stime);
}

/// A line of /proc/self/status in megabytes.
double megabytes(const std::string& field) {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.starts_with(field)) return std::stod(line.substr(field.size())) / 1024;
  return 0;
}

[[maybe_unused]] double megabytes_of_children() {
  rusage used{};
  getrusage(RUSAGE_CHILDREN, &used);
  return static_cast<double>(used.ru_maxrss) / 1024;
}

void forget_peak() { std::ofstream("/proc/self/clear_refs") << 5; }

/// Words of a library's own exceptions, which tell a user nothing.
void check_words(const std::string& words) {
  for (const char* foreign :
       {"std::", "bad_alloc", "json.exception", "basic_string", "vector::", "_M_", "map::at", "stoi", "stod"})
    if (words.find(foreign) != words.npos) throw Problem{fmt::format("crash: the complaint speaks of {}: {}", foreign, words)};
  if (words.empty()) throw Problem{"crash: an empty complaint"};
}

/// Shapes in many segments are what the input requests: they may take what they need.
bool asks_for_much(const std::string& bytes) {
  static const std::regex many("segments\\s*=\\s*\\+?[0-9_]{3,}");
  return bytes.find("segments") != bytes.npos && std::regex_search(bytes, many);
}

}  // namespace

Answer run_input(const Kind& kind, const Input& input, const fs::path& scratch) {
  const fs::path folder = scratch / "input";
  fs::remove_all(folder);
  fs::create_directories(folder);
  for (const fs::directory_entry& entry : fs::directory_iterator(scratch / "beside"))
    fs::create_symlink(entry.path(), folder / entry.path().filename());
  const fs::path file = folder / ("input" + fs::path(input.name).extension().string());
  std::ofstream(file, std::ios::binary) << input.bytes;

  forget_peak();
  const double seconds = seconds_of(RUSAGE_SELF) + seconds_of(RUSAGE_CHILDREN), before = megabytes("VmRSS:");
  Answer answer = Outcome::refused;
  try {
    answer = kind.read(file, input.bytes);
  } catch (const gnomon::Error& error) {
    answer.complaint = error.what();
    check_words(answer.complaint);
  } catch (const std::exception& other) {
    throw Problem{fmt::format("crash: an exception that is no Error: {}", other.what())};
  }
  const double took = seconds_of(RUSAGE_SELF) + seconds_of(RUSAGE_CHILDREN) - seconds, peak = megabytes("VmHWM:") - before;
  if (asks_for_much(input.bytes)) return answer;
  if (took > most_seconds) throw Problem{fmt::format("hang: {:.1f} s of processor time", took)};
  if (peak > most_megabytes) throw Problem{fmt::format("memory: {:.0f} MB", peak)};
#ifndef __SANITIZE_ADDRESS__  // an importer has no limit of memory then
  if (const double children = megabytes_of_children() - before; children > most_megabytes)
    throw Problem{fmt::format("memory: {:.0f} MB in a child", children)};
#endif
  return answer;
}

}  // namespace fuzz
