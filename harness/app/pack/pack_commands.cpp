// The commands of a run as they can be called again from its archive.
#include <gnomon/param.h>

#include <algorithm>
#include <array>

#include "app/pack/pack.h"
#include "measure/scene/time_reference.h"

namespace gnomon::app {

namespace {

// Where rows go, and which of them: those of a part, or those that were not there. They are made again all at once.
constexpr std::array dropped_options{"--out", "--shard"};
constexpr std::array dropped_flags{"--resume", "--retry-failed", "--rebuilt", "--quiet"};
// The commands that add rows and are told all that they need.
constexpr std::array repeatable{"run", "tune"};

bool is_one_of(const auto& list, const std::string& word) { return std::ranges::find(list, word) != list.end(); }

/// The words but the first, in the archive. Words that name no file stay as they are.
std::vector<std::string> packed_words(const std::vector<std::string>& words, const PackedNames& names) {
  std::vector<std::string> packed;
  for (std::size_t k = 1; k < words.size(); ++k) {
    const std::string& word = words[k];
    const std::size_t equal = word.starts_with("--") ? word.find('=') : word.npos;
    const std::string option = word.substr(0, equal);
    if (is_one_of(dropped_flags, word)) continue;
    if (is_one_of(dropped_options, option)) {
      if (equal == word.npos) ++k;
      continue;
    }
    const auto found = names.find(equal == word.npos ? word : word.substr(equal + 1));
    if (found == names.end())
      packed.push_back(word);
    else if (!found->second.empty())
      packed.push_back(equal == word.npos ? found->second : option + "=" + found->second);
    else if (equal == word.npos && !packed.empty())
      packed.pop_back();  // the option before it
  }
  return packed;
}

/// The text of a suite with the names of scenes in the archive: as "NAME" and 'NAME', which is how TOML writes them.
std::string packed_suite(std::string text, const PackedNames& names) {
  for (const auto& [word, name] : names)
    for (const char quote : {'"', '\''}) {
      const std::string from = quote + word + quote, to = '"' + name + '"';
      if (name.empty()) continue;
      for (std::size_t at = 0; (at = text.find(from, at)) != text.npos; at += to.size()) text.replace(at, from.size(), to);
    }
  return text;
}

bool can_be_repeated(const std::vector<std::string>& words) {
  return std::ranges::any_of(words, [](const std::string& word) { return is_one_of(repeatable, word); }) &&
         std::ranges::none_of(words, [](const std::string& word) { return word == "--live" || word.starts_with("--live="); });
}

/// The word of a command that is the file of this suite; empty where the suite is one of the program's own.
std::string suite_word(const std::vector<std::string>& words, const std::string& suite) {
  const auto found = std::ranges::find_if(words, [&](const std::string& word) {
    const std::filesystem::path path = word.starts_with("--suite=") ? word.substr(8) : word;
    return path.extension() == ".toml" && path.stem() == suite;
  });
  if (found == words.end()) return "";
  return found->starts_with("--suite=") ? found->substr(8) : *found;
}

}  // namespace

std::vector<std::vector<std::string>> commands_of(const Json& runs) {
  std::vector<std::vector<std::string>> commands;
  for (const Json& run : runs) {
    std::vector<std::string>& words = commands.emplace_back();
    const auto found = run.find("command");
    if (found == run.end() || !found->is_array()) continue;
    for (const Json& word : *found) words.push_back(plain_text(word));
  }
  return commands;
}

Json pack_commands(Pack& pack, const Json& runs, const PackedNames& names) {
  Json list = Json::array();
  std::set<std::vector<std::string>> known;
  std::map<std::string, std::string> suites;  // by text
  std::string all;
  const std::vector<std::vector<std::string>> commands = commands_of(runs);
  for (std::size_t k = 0; k < commands.size(); ++k) {
    const std::vector<std::string>& words = commands[k];
    if (!can_be_repeated(words)) {
      pack.miss(
          fmt::format("a way to make the rows of '{}' again: only calls of run and tune are repeated", joined(words, " ")));
      continue;
    }
    const Json suite = runs[k].value("suite", json_object());
    const std::string text = suite.contains("text") && suite["text"].is_string() ? suite["text"].get<std::string>() : "";
    const std::string name = suite.contains("name") ? plain_text(suite["name"]) : "";
    const std::string word = text.empty() ? "" : suite_word(words, name);
    all += joined(words, "\n") + "\n" + text + "\n";
    PackedNames own = names;
    std::string file;
    if (!text.empty()) {
      const auto [place, is_new] = suites.try_emplace(text, fmt::format("suites/{}/{}.toml", suites.size() + 1, name));
      file = place->second;
      if (is_new) pack.write(file, word.empty() ? text : packed_suite(text, names));
      if (!word.empty()) own[word] = file;
    }
    const std::vector<std::string> packed = packed_words(words, own);
    if (known.insert(packed).second)
      list.push_back(json_object({{"words", packed}, {"run", k}, {"suite", file.empty() ? Json() : Json(file)}}));
  }
  for (const auto& [from, to] : names)
    if (to.starts_with("scenes/") && from == without_time(from) && all.find(from) == all.npos)
      pack.miss(fmt::format("a call that names scene {} by itself: it is there as a part of a pattern", from));
  return list;
}

}  // namespace gnomon::app
