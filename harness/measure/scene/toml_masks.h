#pragma once
// Private to the reader of described scenes: its keys of alpha masks and of transmission.
#include <functional>

#include "measure/scene/toml_table.h"

namespace gnomon {

/// The file of a name in a description.
using DescribedFile = std::function<std::filesystem::path(const std::string& name)>;

inline constexpr std::string_view mask_keys[] = {"mask", "cutoff", "mask_scale"};

/// The keys `mask`, `cutoff`, `mask_scale` and `masks` of a table. Throws Error, also where `masks` is false beside another.
MaskChoice read_masks(const Table& table, const DescribedFile& file_of);

/// Gives a tessellated plane the mask of its table, if that has one. The image is upright as seen from the side of the normal:
/// u runs along half_u, and the top row is at +half_v. A mask without a hole is left out, with a note.
void add_mask(const Table& table, const DescribedFile& file_of, Scene& scene, Mesh& plane);

/// The keys `transmission` and `seen` of a mesh file's table: true, false, a number, three, or the name of an image. Throws
/// Error, also where `seen` is beside what is opaque.
TransmissionChoice read_transmission(const Table& table, const DescribedFile& file_of);

/// Gives a tessellated shape the transmission of its table, if that has one, and says whether it is seen. A plane alone may
/// have an image, upright as that of a mask.
void add_transmission(const Table& table, const DescribedFile& file_of, Scene& scene, Mesh& shape);

}  // namespace gnomon
