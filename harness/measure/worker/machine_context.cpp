#include "measure/worker/machine_context.h"

#include <OpenImageIO/oiioversion.h>
#include <assimp/version.h>
#include <fmt/format.h>
#include <gnomon/error.h>
#include <gnomon/kit/rays/rays.h>
#include <tbb/version.h>

#include <cstdlib>
#include <ctime>
#include <fstream>
#include <thread>

#include "measure/worker/build.h"

namespace gnomon {

static std::string processor() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);)
    if (line.starts_with("model name")) return line.substr(line.find(':') + 2);
  return "unknown";
}

Json machine_context(int threads) {
  const int cores = static_cast<int>(std::thread::hardware_concurrency());
  double load[3] = {};
  getloadavg(load, 3);
  char started[32];
  const std::time_t now = std::time(nullptr);
  std::strftime(started, sizeof started, "%Y-%m-%dT%H:%M:%SZ", std::gmtime(&now));
  const std::string assimp = fmt::format("{}.{}.{}", aiGetVersionMajor(), aiGetVersionMinor(), aiGetVersionPatch());
  Json context = build_context();
  context.update(
      json_object({{"processor", processor()},
                   {"cores", cores},
                   {"threads", threads > 0 ? threads : cores},
                   {"load_average", load[0]},
                   {"started", started},
                   {"libraries", json_object({{"embree", embree_version()},
                                              {"openimageio", OIIO_VERSION_STRING},
                                              {"assimp", assimp},
                                              {"tbb", fmt::format("{}.{}", TBB_VERSION_MAJOR, TBB_VERSION_MINOR)}})}}));
  if (environment_keeps_shaders()) context["shaders"] = "kept";
  if (const char* const trial = std::getenv("GNOMON_TRIAL"); trial && *trial) context["trial"] = trial;
  return context;
}

Json program_context() {
  Json context = machine_context(0);
  context["technique_sources"] = technique_sources();
  return context;
}

bool environment_keeps_shaders() {
  const char* const word = std::getenv("GNOMON_SHADERS");
  if (!word || !*word) return false;
  if (std::string_view(word) != "keep") throw Error("GNOMON_SHADERS = {} is not keep", word);
  return true;
}

}  // namespace gnomon
