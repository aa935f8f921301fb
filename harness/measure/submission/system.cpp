#include "measure/submission/system.h"

#include <sys/utsname.h>
#include <unistd.h>

#include <fstream>

namespace gnomon {

namespace {

/// The value of a context over all rows: of the first that has one; null where none has.
Json first_value(std::span<const Record> records, const char* key) {
  for (const Record& record : records)
    if (const auto found = record.context.find(key); found != record.context.end() && !found->is_null()) return *found;
  return nullptr;
}

/// Of a line `NAME="text"` the text.
Json system_name() {
  std::ifstream file("/etc/os-release");
  constexpr std::string_view key = "PRETTY_NAME=";
  for (std::string line; std::getline(file, line);)
    if (line.starts_with(key)) {
      std::string text = line.substr(key.size());
      std::erase(text, '"');
      return text;
    }
  return nullptr;
}

Json kernel_name() {
  utsname facts{};
  return uname(&facts) == 0 ? Json(fmt::format("{} {} {}", facts.sysname, facts.release, facts.machine)) : Json();
}

/// The highest clock of the first core, in MHz; without one of the frequency now.
Json clock_mhz() {
  constexpr double khz = 1000;
  double value = 0;
  if (std::ifstream file("/sys/devices/system/cpu/cpu0/cpufreq/cpuinfo_max_freq"); file >> value) return value / khz;
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);)
    if (line.starts_with("cpu MHz")) return std::strtod(line.c_str() + line.find(':') + 1, nullptr);
  return nullptr;
}

/// "4.5 (Core Profile) Mesa 22.3.6" has the driver behind the version of OpenGL. A kernel's own of a card says more.
Json driver_of(const Json& gl_version) {
  if (!gl_version.is_string()) return nullptr;
  const std::string version = gl_version.get<std::string>();
  if (std::ifstream file("/proc/driver/nvidia/version"); version.find("NVIDIA") != version.npos && file) {
    std::string line;
    if (std::getline(file, line)) return line;
  }
  const std::size_t mesa = version.find("Mesa"), blank = version.find(' ');
  return mesa != version.npos ? version.substr(mesa) : blank != version.npos ? version.substr(blank + 1) : version;
}

}  // namespace

Json describe_system(std::span<const Record> records) {
  double load = 0;
  for (const Record& record : records)
    if (const auto found = record.context.find("load_average"); found != record.context.end() && found->is_number())
      load = std::max(load, found->get<double>());
  const Json libraries = first_value(records, "libraries");
  const Json gl_version = first_value(records, "gl_version");
  const double pages = static_cast<double>(sysconf(_SC_PHYS_PAGES)), page = static_cast<double>(sysconf(_SC_PAGESIZE));
  return json_object({{"processor", first_value(records, "processor")},
                      {"cores", first_value(records, "cores")},
                      {"threads", first_value(records, "threads")},
                      {"memory_bytes", pages > 0 && page > 0 ? Json(static_cast<std::uint64_t>(pages * page)) : Json()},
                      {"clock_mhz", clock_mhz()},
                      {"os", system_name()},
                      {"kernel", kernel_name()},
                      {"compiler", first_value(records, "compiler")},
                      {"flags", first_value(records, "flags")},
                      {"gl_renderer", first_value(records, "gl_renderer")},
                      {"gl_version", gl_version},
                      {"driver", driver_of(gl_version)},
                      {"load_average", load},
                      {"embree", libraries.is_object() ? libraries.value("embree", Json()) : Json()},
                      {"libraries", libraries}});
}

}  // namespace gnomon
