#pragma once
#include <gnomon/scene.h>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace gnomon {

/// 128-bit content hash as 32 hex digits.
std::string content_hash(std::span<const std::byte> bytes);
std::string content_hash(const std::string& text);

/// A scene as bytes, with everything that a technique or the scoring can see; equal scenes give equal bytes.
std::vector<std::byte> scene_bytes(const Scene& scene);
/// What a record knows the scene by that lights of these names lit: the hash of everything that can be seen or lit. It leaves
/// out what the loader said of the file (notes, dropped triangles), and the other lights with area, so that a scene which gains
/// such a light keeps its records.
std::string scene_hash(const Scene& scene, std::span<const std::string> lights);
inline std::string scene_hash(const Scene& scene, const Light& light) { return scene_hash(scene, {&light.name, 1}); }
/// The inverse of scene_bytes. Throws Error on bytes of another layout.
Scene scene_from_bytes(std::span<const std::byte> bytes);

/// A file mapped read-only; its address is aligned to a page.
class MappedFile {
 public:
  /// Throws Error when the file cannot be mapped.
  static std::shared_ptr<const MappedFile> open(const std::filesystem::path& path);
  /// The same bytes in memory of our own: who shortens the file later does not end this process.
  static std::shared_ptr<const MappedFile> copy(const std::filesystem::path& path);
  ~MappedFile();
  std::span<const std::byte> bytes() const { return bytes_; }

 private:
  std::span<const std::byte> bytes_;
};

/// Writes a whole file under a temporary name, then renames it: nobody ever sees half of it. Makes the parent folders. A
/// link in its place is replaced, not followed: replaced_file (part_file.h) follows one that somebody named.
/// Throws Error that says what, where and why (a full disk, an unwritable folder); nothing is left behind then.
/// A durable file is on the disk before it gets its name.
enum class Durable { no, yes };
void write_file(const std::filesystem::path& path, std::span<const std::byte> bytes, Durable durable = Durable::no);
void write_file(const std::filesystem::path& path, const std::string& text, Durable durable = Durable::no);
/// Sees that the names in the folder of `path` are on the disk as they are now. Not every disk can: then nothing happens.
void sync_folder_of(const std::filesystem::path& path);

}  // namespace gnomon
