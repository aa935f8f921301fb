// The part of an edition's file that the program writes.
#include "measure/edition/edition_text.h"

#include <gnomon/registry.h>

#include "measure/frame/frame.h"
#include "measure/scene/blob.h"
#include "measure/score/metrics.h"

namespace gnomon {

namespace {

constexpr std::string_view frozen_mark = "# Frozen by `gnomon edition ";
constexpr std::string_view hash_line = "hash = \"";

/// Where a line begins that starts with `words`; npos where there is none.
std::size_t find_line(std::string_view text, std::string_view words) {
  if (text.starts_with(words)) return 0;
  const std::size_t at = text.find('\n' + std::string(words));
  return at == text.npos ? at : at + 1;
}

/// A key of TOML: in quotes where it has more than letters, digits, _ and -.
std::string key_text(const std::string& key) {
  const auto is_bare = [](char c) { return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_' || c == '-'; };
  return !key.empty() && std::ranges::all_of(key, is_bare) ? key : json_text(Json(key));  // JSON's quotes are TOML's, too
}

}  // namespace

std::string edition_hash(std::string_view text) {
  std::string rest(text);
  if (const std::size_t at = find_line(rest, hash_line); at != rest.npos) rest.erase(at, rest.find('\n', at) - at + 1);
  return content_hash(rest).substr(0, 16);
}

std::string hand_written_part(const std::string& text) {
  return text.substr(0, std::min(find_line(text, frozen_mark), text.size()));
}

std::string frozen_part(const Edition& edition) {
  std::string text = fmt::format("{}{} --freeze`, which writes all below this line.\n", frozen_mark, edition.name);
  if (!edition.hash.empty()) text += fmt::format("{}{}\"\n", hash_line, edition.hash);
  text += fmt::format("frames = {}\n\n[metrics]\n", edition.frames);
  for (const auto& [name, version] : edition.metrics) text += fmt::format("{} = {}\n", key_text(name), version);
  text += "\n[scenes]\n";
  for (const auto& [key, hash] : edition.scenes) text += fmt::format("{} = \"{}\"\n", key_text(key), hash);
  for (const auto& [name, parameters] : edition.techniques) {
    text += fmt::format("\n[techniques.{}]\n", key_text(name));
    for (const auto& [parameter, value] : parameters.items())
      text += fmt::format("{} = {}\n", key_text(parameter), json_text(value));
  }
  return text;
}

std::string frozen_edition(const std::filesystem::path& file, SceneLibrary& library) {
  Edition edition = read_hand_written_part(file);
  edition.frames = frame_version();
  for (const MetricInfo& info : metric_infos()) edition.metrics.emplace(info.name, info.version);
  for (const SuiteGroup& group : edition.suite.groups)
    for (const EditionScene& scene : scenes_of_group(edition.suite, group, library)) {
      if (!scene.missing.empty()) throw Error("edition {} cannot be frozen: {}", edition.name, scene.missing);
      edition.scenes.emplace(scene.key, scene.hash);
    }
  edition.techniques = parameters_of_contenders(edition.suite);
  std::string hand = hand_written_part(edition.suite.text);
  if (!hand.empty() && !hand.ends_with('\n')) hand += '\n';
  const std::size_t own = find_line(hand, "[edition]");
  if (own == hand.npos || find_line(std::string_view(hand).substr(own + 1), "[") != hand.npos)
    throw Error("edition {}: [edition] is the last table that is written by hand ({})", edition.name, file.string());
  edition.hash = edition_hash(hand + frozen_part(edition));
  return hand + frozen_part(edition);
}

}  // namespace gnomon
