// Techniques from outside in the archive of a run: plugins with their sources, programs with their files.
#include <gnomon/error.h>
#include <gnomon/param.h>

#include <algorithm>
#include <fstream>

#include "app/pack/pack.h"
#include "measure/paths.h"
#include "measure/program/description.h"
#include "measure/scene/blob.h"

namespace gnomon::app {

namespace fs = std::filesystem;

namespace {

// --- the sources of a plugin, as gnomon_add_plugin notes them in the library ---

struct NotedSources {
  std::vector<fs::path> techniques;  ///< one file each
  std::vector<fs::path> others;      ///< files of their folders, and the project's CMakeLists.txt
};

/// Reads the note without loading the library. Nothing where there is none.
NotedSources noted_sources(const fs::path& library) {
  constexpr std::string_view mark = "gnomon plugin sources:\n";
  const auto mapped = MappedFile::open(library);
  const std::string_view bytes(reinterpret_cast<const char*>(mapped->bytes().data()), mapped->bytes().size());
  NotedSources sources;
  const std::size_t at = bytes.find(mark);
  if (at == bytes.npos) return sources;
  const std::string_view note = bytes.substr(at + mark.size(), bytes.find('\0', at) - at - mark.size());
  bool is_behind = false;
  for (std::size_t begin = 0, end = 0; (end = note.find('\n', begin)) != note.npos; begin = end + 1) {
    const std::string_view line = note.substr(begin, end - begin);
    if (line.empty())
      is_behind = true;
    else
      (is_behind ? sources.others : sources.techniques).push_back(fs::path(line).lexically_normal());
  }
  return sources;
}

/// The NAME of a line `#include "NAME"`; empty where it is another line.
std::string included(std::string_view line) {
  for (const std::string_view word : {"#", "include", "\""}) {
    line.remove_prefix(std::min(line.find_first_not_of(" \t"), line.size()));
    if (!line.starts_with(word)) return {};
    line.remove_prefix(word.size());
  }
  return std::string(line.substr(0, line.find('"')));
}

/// What these sources include by "NAME", and what that includes; and the folders in which names were found that are not beside
/// the file.
class Includes {
 public:
  std::set<fs::path> files, folders;

  void add(const fs::path& file) {
    if (!files.insert(file).second) return;
    std::ifstream stream(file);
    std::string line;
    while (std::getline(stream, line))
      if (const std::string name = included(line); !name.empty()) add_named(file.parent_path(), name);
  }

 private:
  void add_named(const fs::path& folder, const std::string& name) {
    constexpr int most_up = 3;
    std::error_code code;
    fs::path from = folder;
    for (int up = 0; up <= most_up; ++up, from = from.parent_path()) {
      const fs::path file = (from / name).lexically_normal();
      if (!fs::is_regular_file(file, code)) continue;
      if (up > 0) folders.insert(from);
      return add(file);
    }
  }
};

/// A project that builds the plugin from what is packed.
std::string cmake_project(const std::string& target, const std::vector<fs::path>& techniques,
                          const std::set<fs::path>& folders) {
  std::string files, places;
  for (const fs::path& file : techniques) files += fmt::format(" \"{}\"", file.string());
  for (const fs::path& folder : folders) places += fmt::format(" \"{}\"", folder.string());
  return fmt::format(
      "cmake_minimum_required(VERSION 3.25)\nproject(packed_plugin CXX)\nfind_package(gnomon REQUIRED)\n"
      "gnomon_add_plugin({0}{1})\n{2}",
      target, files, places.empty() ? "" : fmt::format("target_include_directories({}{}{})\n", target, " PRIVATE", places));
}

/// Whether CMake takes the name for a target; it is one of ours then, without quotes and blanks.
bool is_target_name(const std::string& name) {
  return !name.empty() &&
         name.find_first_not_of("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_-") == name.npos;
}

/// One word behind --plugin or --program, in a folder of its own.
class OutsideFiles {
 public:
  OutsideFiles(Pack& pack, std::string word, fs::path file, fs::path folder)
      : pack_(pack), word_(std::move(word)), file_(std::move(file)), folder_(std::move(folder)) {}

  /// {"path", "library", "sources", "target"}; `target` is null where it cannot be built.
  Json add_plugin(const std::string& hash) {
    const fs::path library = folder_ / file_.filename();
    Json facts = json_object({{"path", word_}, {"library", library.string()}, {"sources", Json::array()}, {"target", nullptr}});
    if (!hash.empty() && content_hash(MappedFile::open(file_)->bytes()) != hash)
      pack_.miss(fmt::format("plugin {} as it was: it has been built anew since its rows were measured", word_));
    pack_.add(file_, library);
    const NotedSources noted = noted_sources(file_);
    if (noted.techniques.empty()) {
      pack_.miss(fmt::format("the sources of plugin {}: it does not say which they are; gnomon_add_plugin notes them", word_));
      return facts;
    }
    Includes all;
    std::vector<std::string> gone, newer;
    for (const std::vector<fs::path>* list : {&noted.techniques, &noted.others})
      for (const fs::path& source : *list) add_source(source, all, gone, newer);
    if (!gone.empty())
      pack_.miss(fmt::format("sources of plugin {}: {} gone", word_, first_of(gone) + (gone.size() == 1 ? " is" : " are")));
    if (!newer.empty())
      pack_.miss(fmt::format("sources of plugin {} as they were: {} changed since it was built", word_,
                             first_of(newer) + (newer.size() == 1 ? " has" : " have")));
    if (all.files.empty()) return facts;
    const fs::path common = common_folder({all.files.begin(), all.files.end()});
    const auto packed = [&](const fs::path& file) { return fs::path("source") / file.lexically_relative(common); };
    for (const fs::path& file : all.files) {
      pack_.add(file, folder_ / packed(file));
      facts["sources"].push_back((folder_ / packed(file)).string());
    }
    const std::string target = file_.stem().string();
    if (!gone.empty() || !is_target_name(target)) return facts;
    std::vector<fs::path> techniques;
    for (const fs::path& file : noted.techniques) techniques.push_back(packed(file));
    std::set<fs::path> folders;
    for (const fs::path& folder : all.folders)
      if (const fs::path inside = folder.lexically_relative(common); !inside.empty() && *inside.begin() != "..")
        folders.insert(inside == "." ? fs::path("source") : fs::path("source") / inside);
    pack_.write(folder_ / "CMakeLists.txt", cmake_project(target, techniques, folders));
    facts["target"] = target;
    return facts;
  }

  /// Returns the name of its description.
  std::string add_program(const std::string& hash) {
    const auto description = read_program(file_);
    const std::vector<fs::path> files = program_files(*description);
    std::string together;
    for (const fs::path& file : files) together += content_hash(MappedFile::open(file)->bytes());
    if (!hash.empty() && (files.size() > 1 ? content_hash(together) : together) != hash)
      pack_.miss(fmt::format("program {} as it was: its files have changed since its rows were measured", word_));
    const fs::path home = fs::absolute(file_).lexically_normal().parent_path();
    for (const fs::path& file : files) {
      const fs::path inside = fs::absolute(file).lexically_normal().lexically_relative(home);
      if (inside.empty() || *inside.begin() == "..")
        pack_.miss(fmt::format("{}: program {} names it, and it is outside of the program's folder", file.string(), word_));
      else
        pack_.add(file, folder_ / inside);
    }
    return (folder_ / file_.filename()).string();
  }

 private:
  void add_source(const fs::path& source, Includes& all, std::vector<std::string>& gone,
                  std::vector<std::string>& newer) const {
    std::error_code code;
    if (!fs::is_regular_file(source, code)) return gone.push_back(source.string());
    if (source.filename() != "CMakeLists.txt" && fs::last_write_time(source, code) > fs::last_write_time(file_, code))
      newer.push_back(source.string());
    all.add(source);
  }

  Pack& pack_;
  const std::string word_;
  const fs::path file_, folder_;
};

/// As records name it: below the folder of the testbed without that.
std::string recorded(const std::string& word) {
  const std::string root = find_data_root().string() + "/";
  return root.size() > 1 && word.starts_with(root) ? word.substr(root.size()) : word;
}

}  // namespace

std::vector<std::string> outside_words(const std::vector<std::string>& words) {
  std::vector<std::string> found;
  for (std::size_t k = 0; k < words.size(); ++k)
    for (const std::string option : {"--plugin", "--program"}) {
      if (words[k] == option && k + 1 < words.size()) found.push_back(words[k + 1]);
      if (words[k].starts_with(option + "=")) found.push_back(words[k].substr(option.size() + 1));
    }
  return found;
}

Json pack_outside(Pack& pack, const PackedRows& rows, const std::vector<std::vector<std::string>>& commands,
                  PackedNames& names) {
  Json plugins = Json::array();
  std::set<std::string> seen;
  for (const std::vector<std::string>& words : commands)
    for (const std::string& word : outside_words(words)) {
      if (!seen.insert(recorded(word)).second) continue;
      const auto row = rows.hashes.find(recorded(word));
      names[word] = "";  // it goes where no row needs it, and where it is not there
      if (row == rows.hashes.end()) continue;
      const bool is_program = word.ends_with(".toml");
      std::error_code code;
      if (!fs::is_regular_file(word, code)) {
        pack.miss(fmt::format("{} {}: it is not there; pack in the folder in which the run was called",
                              is_program ? "program" : "plugin", word));
        continue;
      }
      OutsideFiles files(pack, word, word, fs::path(is_program ? "programs" : "plugins") / fmt::format("{}", seen.size()));
      try {
        if (is_program) {
          names[word] = files.add_program(row->second);
        } else {
          plugins.push_back(files.add_plugin(row->second));
          names[word] = plugins.back()["library"].get<std::string>();
        }
      } catch (const Error& error) {
        pack.miss(fmt::format("{}: {}", word, error.what()));
      }
    }
  for (const auto& [path, hash] : rows.hashes)
    if (!seen.contains(path) && !fs::exists(find_data_root() / path))
      pack.miss(fmt::format("{}: rows come from it, and no command of run.json names it", path));
  return plugins;
}

}  // namespace gnomon::app
