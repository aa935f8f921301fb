#pragma once
#include <gnomon/gbuffer.h>

#include <map>

#include "measure/exchange/scene_files.h"
#include "measure/json.h"
#include "measure/program/description.h"
#include "measure/scratch_folder.h"

namespace gnomon {

/// Where the files between a worker and its program lie: a folder that the worker's owner removes. Without it, a folder of the
/// technique's own.
inline constexpr const char* program_folder_variable = "GNOMON_PROGRAM_FOLDER";

/// Hashes of named arrays, and one of all of them.
struct ArrayHashes {
  explicit ArrayHashes(const Arrays& arrays);
  std::map<std::string, std::uint64_t> by_name;
  std::uint64_t of_all = 0;
};

/// Named arrays as files: of a scene whose vertices moved only `position` is written again.
class ArrayFiles {
 public:
  /// As write_arrays, for those whose numbers are other ones than those that their files hold.
  Json write(const std::filesystem::path& folder, const std::string& what, const Arrays& arrays, const ArrayHashes& hashes);

 private:
  struct Written {
    std::uint64_t hash = 0;
    Json facts;
  };
  std::map<std::string, Written> written_;
};

/// What a program reads, as files: each is written anew only where its numbers are other ones than those it holds. A file that
/// is written anew is another file under its name: what still looks at the old one goes on seeing that.
class ProgramInputs {
 public:
  explicit ProgramInputs(const ProgramDescription& description);

  const std::filesystem::path& folder() const { return folder_.path(); }
  /// {"file": FOLDER/scene.json, "gltf": FILE}.
  Json scene(const Scene& scene);
  /// {"width", "height", "arrays", "exr", "truth"}.
  Json gbuffer(const GBuffer& gbuffer);

 private:
  const ProgramDescription& description_;
  ScratchFolder folder_;
  ArrayFiles scene_files_, gbuffer_files_;
  std::optional<std::uint64_t> scene_hash_, gbuffer_hash_;
  std::string scene_text_;  ///< of scene.json
  Json gbuffer_ = json_object();
};

/// The mask that a program writes: raw float32 from the first byte on, or an image.
class ProgramMaskFile {
 public:
  ProgramMaskFile(ProgramMask kind, const std::filesystem::path& folder);

  /// {"file", "format", "shape"}. Of float32 there is a file, of not-a-numbers; of an image there is none.
  Json fresh(int width, int height) const;
  /// Throws Error on a mask of another size, a pixel that was left out, and a value outside 0 .. 1.
  void read(VisibilityMask& mask) const;

 private:
  void read_numbers(std::span<float> pixels) const;
  void read_image(VisibilityMask& mask) const;

  ProgramMask kind_;
  std::filesystem::path file_;
};

}  // namespace gnomon
