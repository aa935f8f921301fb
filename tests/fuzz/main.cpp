// Reads mutants of foreign input: scenes, suites, meshes, records, pictures, words of the command line, and what programs and
// workers say to each other. See scripts/fuzz.
#include <fmt/format.h>

#include <cstring>
#include <iostream>

#include "fuzz.h"
#include "measure/scratch_folder.h"
#include "places.h"
#include "supervise.h"

namespace fuzz {
namespace {

namespace fs = std::filesystem;

/// Input `n`, drawn from the seeds by numbers that nothing else depends on.
Input drawn(const Options& options, std::vector<Kind>& kinds, std::uint64_t n) {
  Random random(options.seed * 0x9e3779b97f4a7c15 + n);
  std::size_t shares = 0;
  for (const Kind& kind : kinds) shares += kind.share;
  std::size_t drawn = random.below(shares), k = 0;
  while (drawn >= kinds[k].share) drawn -= kinds[k++].share;
  Kind& kind = kinds[k];
  Input input = random.pick(kind.seeds);
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

int run(const Options& options) {
  const gnomon::ScratchFolder scratch = gnomon::ScratchFolder::in_memory("gnomon-fuzz");
  fs::create_directories(scratch.path() / "beside");
  for (const char* ending : {"obj", "mtl", "ply", "stl", "off", "gltf", "glb"})
    fs::copy(data_file(std::string("tetrahedron.") + ending), scratch.path() / "beside");
  std::vector<Kind> kinds = all_kinds(scratch.path());
  Source source;
  std::vector<Input> replayed;
  if (options.replay.empty()) {
    for (Kind& kind : kinds)
      if (!options.only.empty() && (options.only + ",").find(kind.name + ",") == std::string::npos) kind.share = 0;
    source.make = [&](std::uint64_t n) { return drawn(options, kinds, n); };
  } else {
    for (std::size_t k = 0; k < kinds.size(); ++k)
      if (const fs::path folder = fs::path(options.replay) / kinds[k].name; fs::is_directory(folder))
        for (const fs::directory_entry& file : fs::directory_iterator(folder)) replayed.push_back(read_input(file.path(), k));
    source.count = replayed.size();
    source.make = [&](std::uint64_t n) { return replayed[n]; };
  }
  fmt::print("seed {}, {}\n", options.seed,
             options.replay.empty() ? fmt::format("{:g} minutes", options.minutes) : options.replay);
  return Supervisor(options, source, kinds, scratch.path()).run();
}

}  // namespace
}  // namespace fuzz

int main(int argc, char** argv) {
  try {
    if (argc > 2 && std::strcmp(argv[1], "worker") == 0) return fuzz::say_replies(std::stoi(argv[2]));
    return fuzz::run(fuzz::read_options(argc, argv));
  } catch (const std::exception& error) {
    std::cerr << "gnomon_fuzz: " << error.what() << '\n';
    return 2;
  }
}
