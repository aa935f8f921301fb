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
  int frames = 0;                             ///< frame_version: of G-buffers, references and pixel classes
  std::map<std::string, std::string> scenes;  ///< hash as records have it (context.scene_hash), by scene_key
  std::map<std::string, int> metrics;         ///< versions, by name
  /// Objects of all parameters as records have them: of each technique at its defaults by id, and of each contender that has
  /// settings by its name, "area_rays:samples=16".
  std::map<std::string, Json> techniques;
  std::vector<Erratum> errata;
};

/// Those of bench/editions, sorted.
std::vector<std::string> edition_names();
/// Reads bench/editions/NAME.toml and NAME.errata.toml. Throws Error on an unknown name and as read_edition_file does.
Edition read_edition(const std::string& name);
/// The same of a file NAME.toml, with NAME.errata.toml beside it where that is there. Throws Error, with file and line, on a
/// file that is not what its hash says or is not frozen, on unknown keys, on what read_suite refuses, and on rows that the file
/// leaves open: techniques, lights or views that are not named, a key of the suite that is left to its default.
Edition read_edition_file(const std::filesystem::path& file);
/// The word by which records name the suite of an edition: "edition_2027".
std::string edition_suite_name(const std::string& name);

/// Where Edition::scenes has the scene of a row: "SCENE LIGHT", and "SCENE LIGHT moving" where its geometry moves.
std::string scene_key(const Job& job);
std::string scene_key(const Record& record);

/// What this program would measure otherwise than the edition says, a line each: scenes, versions of metrics and of frames,
/// parameters and defaults of techniques. Empty: it gives the edition. A scene that is not fetched is a difference; a metric or
/// parameter that has come since is none.
std::vector<std::string> edition_differences(const Edition& edition, SceneLibrary& library);

/// The edition's places with these contenders in place of its own. Each is treated as one that `*` names: it has no rows in
/// a group of which it supports nothing.
Suite with_contenders(const Edition& edition, const std::vector<Contender>& contenders);
/// Throws Error on a contender with settings in the default division, unless the edition itself has it.
void require_division(const Edition& edition, Division division, const std::vector<Contender>& contenders);

/// Whether an erratum is of this program, whose version is that or a later one.
bool applies(const Erratum& erratum);

/// The text of a file NAME.toml as this program freezes it: the hand-written part as it is, and below it scenes, metrics,
/// techniques and the hash as they are today. Throws Error on a scene that is not fetched, and as read_edition_file does on
/// the hand-written part.
std::string frozen_edition(const std::filesystem::path& file, SceneLibrary& library);
/// The part above the line that says that the rest is frozen; the whole text where there is no such line.
std::string hand_written_part(const std::string& text);
/// The file of an edition of this name. Throws Error where there is none.
std::filesystem::path edition_file(const std::string& name);

}  // namespace gnomon
