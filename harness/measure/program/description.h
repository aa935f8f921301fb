#pragma once
#include <gnomon/registry.h>

#include <array>
#include <filesystem>

#include "measure/program/described_parameter.h"

namespace gnomon {

/// A cause of wrong pixels that only this program has (OwnCause).
struct ProgramCause {
  std::string id, sentence;
  std::array<std::uint8_t, 3> color{};
};

/// What must be there before a program can run, and how it gets there.
struct ProgramNeed {
  std::string program;            ///< looked for in PATH; or
  std::vector<std::string> runs;  ///< a command that ends with 0
  std::string install;            ///< "apt install povray"
};

/// By kind_name.
inline constexpr std::string_view all_light_kinds[] = {"point", "spot", "directional", "rect", "disc", "sphere"};

enum class ProgramMask { float32, exr, png };

/// A technique that is a program: the content of techniques/ID.toml. docs/protocol.md describes each key.
struct ProgramDescription {
  std::filesystem::path file;  ///< as given
  std::string id;              ///< the file's stem
  std::string title, summary, source, error, fails;
  About about;                                           ///< of the texts above
  std::vector<std::string> command;                      ///< run in the file's folder; the first word ready for exec
  std::array<bool, std::size(stage_names)> has_stage{};  ///< by stage: whether the program does it
  std::vector<std::string> lights;                       ///< kinds that it supports
  std::vector<std::string_view> light_kinds;             ///< the same, for `about`
  std::vector<Feature> handles;                          ///< of scenes, for `about`
  std::string approximate;                               ///< why its answers are; empty: they are not
  bool answers_supports = false, explains = false;
  bool wants_gltf = false, wants_scene_arrays = true, wants_gbuffer_exr = false, wants_gbuffer_arrays = true;
  ProgramMask mask = ProgramMask::float32;
  std::vector<ProgramNeed> needs;
  std::vector<DescribedParameter> parameters;
  std::vector<ProgramCause> causes;
  std::vector<OwnCause> cause_rows;  ///< of these, for `about`
};

/// Reads and checks it. Throws Error with file and line.
std::shared_ptr<const ProgramDescription> read_program(const std::filesystem::path& file);

/// The files of a program: its description, those words of its command that are files where it runs, and the files of the
/// folder ID beside ID.toml and of the folders there that these words lead into: several programs may share one.
std::vector<std::filesystem::path> program_files(const ProgramDescription& description);

/// Whether a technique is a program of its own.
bool is_program(const TechniqueEntry& entry);

/// The names of the stages that a technique receives by its description; none where it is no program.
std::vector<std::string> described_stages(const TechniqueEntry& entry);

/// Where programs are looked for: beside this one, then in PATH.
std::string search_path();

/// Which of its needs this machine lacks, in words with the way to get them; empty: none. Looked up once in a process.
std::string missing_needs(const ProgramDescription& description);

}  // namespace gnomon
