#pragma once
#include <filesystem>
#include <string>
#include <utility>

namespace gnomon {

/// A folder for temporary files: it is removed, with all that is in it, at the end of its owner's life.
class ScratchFolder {
 public:
  /// A folder of this name, which nothing else uses; its parents are made too. These throw Error when there can be none.
  static ScratchFolder at(const std::filesystem::path& path);
  /// A fresh folder PREFIX-PROCESS.XXXXXX in `parent`, made with its parents. What killed processes left there is removed.
  static ScratchFolder in(const std::filesystem::path& parent, const std::string& prefix);
  /// A fresh folder in the folder for temporary files.
  static ScratchFolder temporary(const std::string& prefix);
  /// The folder PREFIX-PROCESS of this process: in memory where that is possible, else in the folder for temporary files. What
  /// processes that were killed have left there under this prefix is removed first.
  static ScratchFolder in_memory(const std::string& prefix);

  ScratchFolder(ScratchFolder&& other) noexcept : path_(std::exchange(other.path_, {})) {}
  ScratchFolder& operator=(ScratchFolder&&) = delete;
  ~ScratchFolder();

  const std::filesystem::path& path() const { return path_; }

 private:
  explicit ScratchFolder(std::filesystem::path made) : path_(std::move(made)) {}

  std::filesystem::path path_;
};

}  // namespace gnomon
