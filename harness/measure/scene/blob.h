#pragma once
#include <gnomon/scene.h>

#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace gnomon {

/// 128-bit content hash as 32 hex digits.
std::string content_hash(std::span<const std::byte> bytes);
std::string content_hash(const std::string& text);

/// A scene as bytes, with everything that a technique or the scoring can see; equal scenes give equal bytes. An alpha mask or a
/// transmission that meshes share is stored once. Positions are those of the present pose, motion is with them.
std::vector<std::byte> scene_bytes(const Scene& scene);
/// The identity in records of a scene that lights of these names lit: the hash of everything that can be seen or lit. It leaves
/// out what the loader noted about the file (notes, dropped triangles) and all other lights with area. Hence a scene that gains
/// such a light keeps its records. It also leaves out how meshes move, unless the row follows an animation. The scene is at
/// rest.
enum class WithMotion { no, yes };
std::string scene_hash(const Scene& scene, std::span<const std::string> lights, WithMotion with_motion = WithMotion::no);
inline std::string scene_hash(const Scene& scene, const Light& light, WithMotion with_motion = WithMotion::no) {
  return scene_hash(scene, {&light.name, 1}, with_motion);
}
/// The inverse of scene_bytes. Throws Error on bytes of another layout, on alpha masks and transmissions that are none or
/// fit no mesh, on paths that are none and on motion that check_motion refuses.
Scene scene_from_bytes(std::span<const std::byte> bytes);

/// A file mapped read-only; its address is aligned to a page.
class MappedFile {
 public:
  /// Throws Error when the file cannot be mapped.
  static std::shared_ptr<const MappedFile> open(const std::filesystem::path& path);
  /// The same bytes in memory of this process, which then survives that the file is shortened.
  static std::shared_ptr<const MappedFile> copy(const std::filesystem::path& path);
  ~MappedFile();
  std::span<const std::byte> bytes() const { return bytes_; }

 private:
  std::span<const std::byte> bytes_;
};

/// Writes a whole file under a temporary name, then renames it: it is never visible in part. Makes the parent folders. A
/// link in its place is replaced, not followed: replaced_file (part_file.h) follows one that a person named.
/// Throws Error with the file and the reason (a full disk, an unwritable folder), and leaves no file.
/// A durable file is on the disk before it gets its name.
enum class Durable { no, yes };
void write_file(const std::filesystem::path& path, std::span<const std::byte> bytes, Durable durable = Durable::no);
void write_file(const std::filesystem::path& path, const std::string& text, Durable durable = Durable::no);
/// Writes the present names in the folder of `path` to the disk. Does nothing where the disk cannot do so.
void sync_folder_of(const std::filesystem::path& path);

}  // namespace gnomon
