#pragma once
#include <filesystem>
#include <string>

namespace gnomon {

/// Where this process writes `path`, a file or a folder, until it is whole: a hidden name beside it with the number of the
/// process. What processes that are gone have left there under the same name is removed first.
std::filesystem::path part_of(const std::filesystem::path& path);

/// The file that is replaced by writing to `path`, which a person named: what a link leads to. Throws Error where that exists
/// and is no regular file: a device, a pipe or a folder is not replaced.
std::filesystem::path replaced_file(const std::filesystem::path& path);

/// Whether a regular file is there, and no link to one.
bool is_plain_file(const std::filesystem::path& path);

/// Before writing in a cache or the folder of a run: a link there is removed, never followed. Throws Error where something else
/// than a regular file is there.
void make_way(const std::filesystem::path& path);

/// Removes what processes that are gone were writing in this folder.
void remove_left_over_parts(const std::filesystem::path& folder);

/// Removes the folders PREFIX-PROCESS, with or without a rest after a dot, of processes that are gone.
void remove_left_over_folders(const std::filesystem::path& parent, const std::string& prefix);

}  // namespace gnomon
