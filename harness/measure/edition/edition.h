#pragma once
#include "measure/record/record.h"
#include "measure/run/run.h"

namespace gnomon {

/// What a run of an edition may set of its techniques: nothing; anything that was found on training scenes; anything.
enum class Division : std::uint8_t { default_settings, tuned, open };
inline constexpr const char* division_names[] = {"default", "tuned", "open"};
inline const char* name(Division division) { return division_names[static_cast<std::size_t>(division)]; }
/// Throws Error on a word that is none of the names.
Division parse_division(const std::string& text);

/// A mended fault of a technique after which its numbers are not those that an edition's first results have.
struct Erratum {
  std::string technique;  ///< id
  std::string version;    ///< of the program, from which on: "0.2.0"
  std::string reason;
  std::string rows;  ///< regular expression over "SCENE LIGHT [VIEW] [PATH] TECHNIQUE:SETTINGS"; empty: all of the technique
};

/// A suite with a name that stays as it is: scenes, metrics and defaults are those of the day when it was frozen.
struct Edition {
  std::string name, title;
  std::string hash;                           ///< of its file without the line of the hash: 16 hex digits
  Suite suite;                                ///< of the edition's own techniques; its name is edition_suite_name(name)
  std::vector<std::string> training;          ///< scenes that settings may be found on: none of them is scored
  std::map<std::string, std::string> scenes;  ///< hash as records have it (context.scene_hash), by scene_key
  std::map<std::string, int> metrics;         ///< versions, by name
  std::map<std::string, Json> techniques;     ///< id -> object of all parameters at their defaults, as records have them
  std::vector<Erratum> errata;
};

/// Those of bench/editions, sorted.
std::vector<std::string> edition_names();
/// Reads bench/editions/NAME.toml and NAME.errata.toml. Throws Error on an unknown name, on a file that is not what its hash
/// says, on unknown keys, and on what read_suite refuses.
Edition read_edition(const std::string& name);
/// The word by which records name the suite of an edition: "edition_2027".
std::string edition_suite_name(const std::string& name);

/// Where Edition::scenes has the scene of a row: "SCENE LIGHT", and "SCENE LIGHT moving" where its geometry moves.
std::string scene_key(const Job& job);
std::string scene_key(const Record& record);

/// What this program would measure otherwise than the edition says, a line each: scenes, versions of metrics, parameters and
/// defaults of techniques. Empty: it gives the edition. A scene that is not fetched is a difference.
std::vector<std::string> edition_differences(const Edition& edition, SceneLibrary& library);
/// edition_differences, thrown as one Error where there are any.
void require_edition(const Edition& edition, SceneLibrary& library);

/// The edition's places with these contenders in place of its own. Each is treated as one that `*` names: it has no rows in
/// a group of which it supports nothing.
Suite with_contenders(const Edition& edition, const std::vector<Contender>& contenders);
/// Throws Error on settings in the default division.
void require_division(Division division, const std::vector<Contender>& contenders);

/// The text of bench/editions/NAME.toml as this program freezes it: the hand-written part as it is, and below it scenes,
/// metrics, techniques and the hash as they are today. Throws Error on a scene that is not fetched.
std::string frozen_edition(const std::string& name, SceneLibrary& library);

}  // namespace gnomon
