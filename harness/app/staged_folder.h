#pragma once
#include <filesystem>

namespace gnomon::app {

/// Files that appear in their folder at once: all are written to `path` first, a hidden folder on the same disk, and renamed
/// when they are whole.
class StagedFolder {
 public:
  /// For the files of a folder that may not be there yet; staged beside it. Throws Error when it cannot be made.
  static StagedFolder beside(const std::filesystem::path& out);
  /// For one file and what goes with it; staged in its folder, which is made. Throws Error when that cannot be written.
  static StagedFolder for_file(const std::filesystem::path& file);
  ~StagedFolder();
  StagedFolder(const StagedFolder&) = delete;

  /// Throws Error when a file cannot be renamed.
  void publish() const;

  const std::filesystem::path path;

 private:
  StagedFolder(const std::filesystem::path& target, bool is_file);

  const std::filesystem::path out_;
};

}  // namespace gnomon::app
