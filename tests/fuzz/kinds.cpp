// The kinds of input, and where their seeds come from.
#include <algorithm>
#include <fstream>
#include <set>
#include <sstream>
#include <utility>

#include "fuzz.h"
#include "places.h"
#include "run_words.h"

namespace fuzz {

namespace fs = std::filesystem;

namespace {

std::string text_of(const fs::path& file) {
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
}

/// "\n" is a new line, "{k}" the number of the repetition.
std::string line_of_recipe(std::string text, std::size_t k) {
  for (const auto& [word, value] : {std::pair<std::string, std::string>("\\n", "\n"), {"{k}", std::to_string(k)}})
    for (std::size_t at = text.find(word); at != text.npos; at = text.find(word, at + value.size()))
      text.replace(at, word.size(), value);
  return text;
}

std::vector<fs::path> files_of(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code none;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, none))
    if (entry.is_regular_file()) files.push_back(entry.path());
  std::ranges::sort(files);
  return files;
}

}  // namespace

Input read_input(const fs::path& file, std::size_t kind) {
  Input input{kind, file.filename().string(), text_of(file)};
  if (file.extension() != ".repeat") return input;
  std::istringstream recipe(std::exchange(input.bytes, {}));
  input.name = file.stem().string();  // deep.toml of deep.toml.repeat
  for (std::string line; std::getline(recipe, line);) {
    const std::size_t blank = line.find(' ');
    const std::size_t count = std::stoul(line.substr(0, blank));
    for (std::size_t k = 0; k < count; ++k) input.bytes += line_of_recipe(line.substr(blank + 1), k);
  }
  return input;
}

std::vector<Kind> all_kinds(const fs::path& scratch) {
  std::vector<Kind> kinds = {{"scene", 20, true, read_described_scene},
                             {"suite", 15, true, read_suite_file},
                             {"mesh", 20, false, read_mesh},
                             {"answer", 8, false, read_answer_of_importer},
                             {"records", 10, true, read_records_of_run},
                             {"mask", 8, false, read_mask},
                             {"words", 10, true, read_words},
                             {"settings", 10, true, read_settings},
                             {"requests", 3, true, read_requests},
                             {"replies", 2, true, read_replies},
                             {"blob", 10, false, read_blob}};
  if (!has_program) std::erase_if(kinds, [](const Kind& kind) { return kind.name == "words"; });
  for (std::size_t k = 0; k < kinds.size(); ++k) {
    const std::string& name = kinds[k].name;
    std::vector<fs::path> files = files_of(data_file("fuzz/" + name));
    const auto add = [&](const fs::path& folder, const std::string& beginning, const std::string& ending) {
      for (const fs::path& file : files_of(folder))
        if (file.filename().string().starts_with(beginning) && file.extension().string().ends_with(ending))
          files.push_back(file);
    };
    if (name == "scene") add(tree_file("scenes"), "", ".toml");
    if (name == "suite") add(tree_file("bench/suites"), "", ".toml");
    if (name == "mesh") {
      add(data_file(""), "tetrahedron", "");
      std::set<fs::path> cases;  // in order
      for (const fs::directory_entry& folder : fs::directory_iterator(data_file("cases"))) cases.insert(folder.path());
      for (const fs::path& folder : cases)
        for (const char* ending : {".obj", ".ply", ".off", ".stl", ".gltf", ".glb"}) add(folder, "", ending);
    }
    if (name == "records") add(data_file("records"), "", ".jsonl");
    for (const fs::path& file : files)
      if (file.extension() != ".repeat") kinds[k].seeds.push_back(read_input(file, k));  // recipes are long: only replayed
    for (Input& seed : written_seeds(name, scratch)) kinds[k].seeds.push_back({k, seed.name, seed.bytes});
    for (Input& seed : kinds[k].seeds) seed.is_seed = true;
  }
  return kinds;
}

}  // namespace fuzz
