// Reads mutants of foreign input: scenes, suites, meshes, records, pictures, words of the command line, and what programs and
// workers say to each other. See scripts/fuzz.
#include <fmt/format.h>

#include <cstdlib>
#include <cstring>
#include <iostream>
#include <set>
#include <sstream>

#include "fuzz.h"
#include "measure/paths.h"
#include "measure/scene/import.h"
#include "measure/scratch_folder.h"
#include "places.h"
#include "supervise.h"

namespace fuzz {
namespace {

namespace fs = std::filesystem;

constexpr double unchanged_share = 1.0 / 16;  // of the inputs; see Supervisor::look_for_blindness

/// Input `n`, drawn from the seeds by numbers that nothing else depends on. The first ones are the seeds.
Input drawn(const Options& options, std::vector<Kind>& kinds, std::uint64_t n) {
  for (std::uint64_t seed = n; const Kind& kind : kinds) {
    if (kind.share == 0) continue;
    if (seed < kind.seeds.size()) return kind.seeds[seed];
    seed -= kind.seeds.size();
  }
  Random random(options.seed * 0x9e3779b97f4a7c15 + n);
  std::size_t shares = 0;
  for (const Kind& kind : kinds) shares += kind.share;
  std::size_t drawn = random.below(shares), k = 0;
  while (drawn >= kinds[k].share) drawn -= kinds[k++].share;
  Kind& kind = kinds[k];
  Input input = random.pick(kind.seeds);
  if ((input.is_seed = random.chance(unchanged_share))) return input;
  const std::string& other = random.pick(kind.seeds).bytes;
  const bool is_text = kind.is_text || input.bytes.find('\0') == std::string::npos;
  input.bytes =
      is_text && random.chance(0.9) ? mutate_text(random, input.bytes, other) : mutate_binary(random, input.bytes, other);
  if (random.chance(0.8)) input.bytes = mend(input.name, std::move(input.bytes));
  return input;
}

Options read_options(int argc, char** argv) {
  Options options;
  for (int k = 1; k + 1 < argc; k += 2) {
    const std::string name = argv[k], value = argv[k + 1];
    if (name == "--seed")
      options.seed = std::stoull(value);
    else if (name == "--minutes")
      options.minutes = std::stod(value);
    else if (name == "--replay")
      options.replay = value;
    else if (name == "--only")
      options.only = value;
    else if (name == "--findings")
      options.findings = fs::absolute(value);
    else
      throw std::runtime_error("there is no option " + name);
  }
  if (argc % 2 == 0)
    throw std::runtime_error("usage: gnomon_fuzz [--seed N] [--minutes M] [--only KIND] [--replay FOLDER] [--findings FOLDER]");
  options.findings = fs::absolute(options.findings);
  return options;
}

/// Names with commas between; the others get no share.
void keep_only(const std::string& names, std::vector<Kind>& kinds) {
  std::set<std::string> kept;
  std::istringstream words(names);
  for (std::string name; std::getline(words, name, ',');) kept.insert(name);
  for (Kind& kind : kinds)
    if (kept.erase(kind.name) == 0) kind.share = 0;
  if (!kept.empty()) throw std::runtime_error("there is no kind " + *kept.begin());
}

std::size_t seed_count(const std::vector<Kind>& kinds) {
  std::size_t count = 0;
  for (const Kind& kind : kinds) count += kind.share > 0 ? kind.seeds.size() : 0;
  return count;
}

int run(const Options& options) {
  const gnomon::ScratchFolder scratch = gnomon::ScratchFolder::in_memory("gnomon-fuzz");
  fs::create_directories(scratch.path() / "beside");
  for (const char* ending : {"obj", "mtl", "ply", "stl", "off", "gltf", "glb"})
    fs::copy(data_file(std::string("tetrahedron.") + ending), scratch.path() / "beside");
  std::vector<Kind> kinds = all_kinds(scratch.path());
  Source source;
  std::vector<Input> replayed;
  if (options.replay.empty()) {
    if (!options.only.empty()) keep_only(options.only, kinds);
    source.make = [&](std::uint64_t n) { return drawn(options, kinds, n); };
    if (options.minutes == 0) source.count = seed_count(kinds);
  } else {
    for (std::size_t k = 0; k < kinds.size(); ++k)
      if (const fs::path folder = fs::path(options.replay) / kinds[k].name; fs::is_directory(folder))
        for (const fs::directory_entry& file : fs::directory_iterator(folder)) replayed.push_back(read_input(file.path(), k));
    source.count = replayed.size();
    source.make = [&](std::uint64_t n) { return replayed[n]; };
  }
  fmt::print("seed {}, {}{}\n", options.seed,
             options.replay.empty() ? fmt::format("{:g} minutes", options.minutes) : options.replay,
             options.only.empty() ? "" : ", only " + options.only);
  return Supervisor(options, source, kinds, scratch.path()).run();
}

}  // namespace
}  // namespace fuzz

#ifdef __SANITIZE_ADDRESS__
// In effect wherever the program is started, and for the importers and workers that it starts. ASAN_OPTIONS has precedence.
extern "C" const char* __asan_default_options() { return "detect_leaks=0:quarantine_size_mb=16:max_allocation_size_mb=2000"; }
extern "C" const char* __ubsan_default_options() { return "print_stacktrace=1"; }
#endif

int main(int argc, char** argv) {
  try {
    if (argc > 2 && std::strcmp(argv[1], "worker") == 0) return fuzz::say_replies(std::stoi(argv[2]));
    if (argc > 3 && std::strcmp(argv[1], "import-mesh") == 0) return gnomon::import_child_main(argv[2], std::stoi(argv[3]));
    setenv("GNOMON_PROGRAM", gnomon::program_path().c_str(), 1);  // the importer under the same sanitizers, see import.cpp
    return fuzz::run(fuzz::read_options(argc, argv));
  } catch (const std::exception& error) {
    std::cerr << "gnomon_fuzz: " << error.what() << '\n';
    return 2;
  }
}
