#pragma once
// Private to the importer: the child that reads a mesh file, and the helpers of both sides.
#include <gnomon/scene.h>

#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "measure/formats/mesh_file.h"
#include "measure/scene/fields.h"
#include "measure/scene/load.h"

namespace gnomon::importing {

// What the child may take, beside what its parent had: processor time, and memory. So many pixels of an image count as a byte.
inline constexpr unsigned least_import_seconds = 10, import_seconds_per_megabyte = 10;
inline constexpr std::uint64_t least_import_memory = 400 << 20, import_memory_factor = 256;  ///< bytes, for each byte of a file
inline constexpr std::uint64_t pixels_per_byte = 16;

/// Set to 1 for a child that reads texture coordinates of all meshes, not of those alone whose materials need them; of an image
/// file the colors, not the brightness as alpha.
inline constexpr const char* all_variable = "GNOMON_IMPORT_ALL";

/// Runs `body` in a forked child and returns all that it wrote to `out_fd`. Throws Error, opening with `what`, when the child
/// crashes, aborts, exceeds its time or memory, or returns anything but 0.
std::vector<std::byte> output_of_fork(const std::string& what, const std::function<int(int out_fd)>& body);
/// The same for another program: `program import-mesh file 3`, where 3 is the descriptor to write to.
std::vector<std::byte> output_of_program(const std::string& what, const std::filesystem::path& program,
                                         const std::filesystem::path& file, bool with_all = false);
/// What a child answers for a file. `with_all`: as of `all_variable`.
std::vector<std::byte> answer_of_child(const std::filesystem::path& file, bool with_all = false);

/// This file and those that it names, as far as they are there, each once; a child reads them. An image names none. A file that
/// cannot be read to its end gives those up to there: loading it says what is wrong.
std::vector<std::filesystem::path> files_behind(const std::filesystem::path& file);

/// Checks, places and splits what the child answered, and adds it to the scene. Throws Error.
void add_imported(const std::filesystem::path& file, std::span<const std::byte> answer, const Placement& placement,
                  Scene& scene, const MaskChoice& masks = {}, const TransmissionChoice& transmission = {});

/// Replaces an image's bytes by its alpha, and by its colors where `wants_colors` is set; `make_room` gets its size before
/// memory is taken. An image that cannot be decoded has the reason in `failure`.
void decode(MaskImage& image, const std::function<void(std::uint64_t pixels)>& make_room);
/// The alpha of an image file, or its brightness where it has none; `with_colors`, its colors in place of that. A child reads
/// it. Throws Error.
MaskImage read_mask_image(const std::filesystem::path& file, bool with_colors = false);
/// Throws Error where a file is missing, empty, no regular file, or may not be read. `what` it should be: "a mesh file", "an
/// image".
void check_readable(const std::filesystem::path& file, std::string_view what);

/// Appends the triangles of a polygon: a fan where it is convex, ear clipping where it is not. Returns false, and appends a
/// fan, where the polygon is not simple. `corners` index `positions`, in range; fewer than three distinct ones give nothing.
bool triangulate(std::span<const glm::vec3> positions, std::span<const std::uint32_t> corners,
                 std::vector<glm::uvec3>& triangles);

}  // namespace gnomon::importing

namespace gnomon {

/// Body of the program's hidden sub-command `import-mesh FILE FD`: reads the file, sends what it finds to `out_fd`. Returns the
/// exit status. A file that is no mesh file by its name is an image. `with_all`, or the environment's `all_variable`: texture
/// coordinates of all meshes, colors of the image.
int import_child_main(const std::string& file, int out_fd, bool with_all = false);

}  // namespace gnomon
