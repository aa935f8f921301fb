#pragma once
#include <filesystem>

namespace gnomon::app {

/// Files that appear in their folder at once: all are written to `path` first, a hidden folder on the same disk, and renamed
/// when they are whole.
class StagedFolder {
 public:
  /// What is to appear: the files of a folder, staged beside it; or a file and what goes with it, staged in its folder.
  enum class Target { folder, file };
  /// Makes the folders that are not there yet. Throws Error when one cannot be made or written.
  explicit StagedFolder(const std::filesystem::path& target, Target kind = Target::folder);
  ~StagedFolder();
  StagedFolder(const StagedFolder&) = delete;

  /// Throws Error when a file cannot be renamed.
  void publish() const;

  const std::filesystem::path path;

 private:
  const std::filesystem::path out_;
};

}  // namespace gnomon::app
