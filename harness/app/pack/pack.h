#pragma once
// Private to the command `pack`: what goes into its archive. docs/pack.md describes the archive.
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "measure/json.h"

namespace gnomon::app {

/// What is in the archive, before it is one: a folder of links to files of this machine and of texts. Names in the archive are
/// relative and stay within it.
class Pack {
 public:
  explicit Pack(std::filesystem::path folder);

  const std::filesystem::path& folder() const { return folder_; }
  /// Throws Error where the file is no regular file that can be read, or the name is taken by another file.
  void add(const std::filesystem::path& file, const std::filesystem::path& name);
  void write(const std::filesystem::path& name, std::string_view text);
  /// Says in a sentence what belongs into the archive and is not in it.
  void miss(const std::string& what);
  const std::vector<std::string>& missing() const { return missing_; }
  std::size_t file_count() const { return files_.size(); }

 private:
  std::filesystem::path place_of(const std::filesystem::path& name);

  std::filesystem::path folder_;
  std::map<std::filesystem::path, std::filesystem::path> files_;  ///< by name; empty for a text
  std::vector<std::string> missing_;
};

/// What the rows of a run say of where they come from.
struct PackedRows {
  struct SceneRow {
    std::string reference;  ///< as load_scene takes it
    std::string hash;       ///< context.scene_hash; empty where the scene was not there
    std::vector<std::string> lights;
    bool is_moving = false;
  };
  std::size_t count = 0, foreign_count = 0;
  std::set<std::string> commits;              ///< of rows that techniques made
  std::map<std::string, SceneRow> scenes;     ///< by the scene as written, of its first row that has a hash
  std::map<std::string, std::string> hashes;  ///< of plugins and programs, by path
};

/// By a word of commands and suites, the same word in the archive; empty: the word and the option before it go.
using PackedNames = std::map<std::string, std::string>;

/// Descriptions, models and what belongs to them, with the page of their licenses. Adds the scenes that are files to `names`.
void pack_scenes(Pack& pack, const PackedRows& rows, PackedNames& names);

/// Libraries and sources of plugins, descriptions and files of programs that `commands` name. Returns {"path", "library",
/// "sources", "target"} for each plugin; adds what both are called to `names`.
Json pack_outside(Pack& pack, const PackedRows& rows, const std::vector<std::vector<std::string>>& commands,
                  PackedNames& names);

/// The tree of each commit, from the repository in this folder, and what it was changed by. Returns, for each entry of
/// run.json,
/// {"commit", "archive", "changes", "build"}; `archive` and `changes` are null where there is none.
Json pack_sources(Pack& pack, const PackedRows& rows, const Json& runs, const std::filesystem::path& repository);

/// The words of the entries that can be called again, in the archive, each once: {"words", "run", "suite"}; and their suites.
Json pack_commands(Pack& pack, const Json& runs, const PackedNames& names);

/// Plugins and programs that the words of a command name.
std::vector<std::string> outside_words(const std::vector<std::string>& words);

/// The words of the entries of run.json.
std::vector<std::vector<std::string>> commands_of(const Json& runs);

/// Makes a gzipped tar file of the folder `name` in `parent`, with what links in it lead to. Throws Error.
void make_archive(const std::filesystem::path& parent, const std::string& name, const std::filesystem::path& archive);

/// Runs a program of this machine to its end, in this folder. Throws Error where there is none of this name.
struct ToolEnd {
  bool is_good = false;
  std::string said;  ///< on standard output and error, without the newline at the end
};
ToolEnd run_tool(std::vector<std::string> words, const std::filesystem::path& folder);

/// The folder that all these files are in, as deep as possible; they are absolute.
std::filesystem::path common_folder(const std::vector<std::filesystem::path>& files);

/// "A", or with more of the same name "A and 3 more".
std::string first_of(const std::vector<std::string>& names);

}  // namespace gnomon::app
