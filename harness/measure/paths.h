#pragma once
#include <filesystem>
#include <string>

namespace gnomon {

/// Folder that holds scenes/ and bench/suites/: $GNOMON_ROOT, else the nearest folder above the program that has both, else
/// the installed share/gnomon. Throws Error when there is none.
std::filesystem::path data_root();
/// The same; empty where there is none.
std::filesystem::path find_data_root();

/// Folder for what can be made again: $GNOMON_CACHE, else the tree's cache/ where that can be written, else, and for an
/// installed program, the user's cache folder. Fetched scenes lie in `scenes/ID/` below it.
std::filesystem::path cache_root();

/// Whether there is such a folder and it is another user's: its files are read, nothing is written to it.
bool is_of_another_user(const std::filesystem::path& folder);

/// The command that fetches scenes, as a person writes it: the tree's script, or what is installed beside the program.
std::string fetch_command();

/// Makes a folder with its parents. Throws Error that starts with `what`.
void make_folder(const std::filesystem::path& folder, const std::string& what = "folder");

/// The running program's own file.
std::filesystem::path program_path();

}  // namespace gnomon
