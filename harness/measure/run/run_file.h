#pragma once
#include "measure/run/run.h"

namespace gnomon {

/// FOLDER/run.json: how the rows of a folder were made, so that they can be made again from it alone. {"schema":
/// "gnomon-run-1", "runs": [...]}, one entry for each time that a program ran in the folder, in order: `command`, the words;
/// `suite`, {"name", "text"}, null without a file; `scenes`, {"scene", "text", "lights", "views"} each, with the text of a TOML
/// file and else null; `context`, the machine and the build; `changes`, how the tree of the build differed from its commit; of
/// an edition `edition`, {"name", "hash", "division"}.

/// Adds the run that is about to start in options.out. Throws Error on a file that is there and is none of these.
void add_to_run_file(const RunOptions& options, const Json& context, SceneLibrary& library, std::span<const Job> jobs);

/// The entries of a folder; none where it has no such file. Throws Error on a file that is none of these.
Json run_entries(const std::filesystem::path& folder);

/// The edition of an entry; nothing where it is of none. Throws Error, with the folder, on one that is no edition.
std::optional<RunEdition> edition_of(const Json& entry, const std::filesystem::path& folder);
/// Throws Error where a folder holds runs of another edition or division than this, or of one where this is none.
void require_edition_of_folder(const std::filesystem::path& folder, const std::optional<RunEdition>& edition);
/// Throws Error where these folders are not all of one edition and division, or all of none.
void require_one_edition(std::span<const std::filesystem::path> folders);

/// Writes into `out` the entries of all these folders, in order; nothing where none has any.
void join_run_files(std::span<const std::filesystem::path> folders, const std::filesystem::path& out);

}  // namespace gnomon
