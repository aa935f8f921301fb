#include "measure/scene/toml_masks.h"

namespace gnomon {

MaskChoice read_masks(const Table& table, const DescribedFile& file_of) {
  MaskChoice masks;
  masks.are_used = table.flag("masks", true);
  for (const std::string_view key : mask_keys)
    if (!masks.are_used && table.has(key))
      table.refuse("masks", "false", fmt::format("allowed beside {}: without masks all meshes are solid", key));
  if (table.has("mask")) masks.image = file_of(table.text("mask"));
  if (table.has("cutoff")) {
    const double cutoff = table.number("cutoff");
    if (cutoff < 0 || cutoff > 1) table.refuse("cutoff", cutoff, "within 0 .. 1");
    masks.cutoff = cutoff;
  }
  masks.scale = table.integer("mask_scale", 1, 1, AlphaMask::most_texels);
  return masks;
}

void add_mask(const Table& table, const DescribedFile& file_of, Scene& scene, Mesh& plane) {
  const MaskChoice masks = read_masks(table, file_of);
  for (const std::string_view key : mask_keys)
    if (!masks.image && table.has(key)) table.refuse(key, "a number", "allowed without a mask");
  if (!masks.image) return;
  constexpr double usual_cutoff = 0.5;
  std::shared_ptr<const AlphaMask> mask;
  try {
    mask = read_alpha_mask(*masks.image, masks.cutoff.value_or(usual_cutoff), masks.scale, scene);
  } catch (const Error& error) {
    throw Error("{} (named in {})", error.what(), table.where("mask"));
  }
  if (mask->coverage() == 1) {
    scene.notes.push_back(fmt::format("{}: its mask {} has no hole; it is solid", plane.name, table.text("mask")));
    return;
  }
  plane.alpha_mask = std::move(mask);
  plane.uv = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};  // the corners are -u -v, +u -v, +u +v, -u +v
}

}  // namespace gnomon
