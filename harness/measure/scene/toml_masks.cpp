#include "measure/scene/toml_masks.h"

namespace gnomon {

namespace {

/// Of a tessellated plane, whose corners are -u -v, +u -v, +u +v, -u +v.
const std::vector<glm::vec2> plane_uv = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};

}  // namespace

MaskChoice read_masks(const Table& table, const DescribedFile& file_of) {
  MaskChoice masks;
  masks.hint = " (masks = false loads it as solid)";
  masks.are_used = table.flag("masks", true);
  for (const std::string_view key : mask_keys)
    if (!masks.are_used && table.has(key))
      table.refuse("masks", "false", fmt::format("allowed beside {}: without masks all meshes are solid", key));
  if (table.has("mask")) masks.image = file_of(table.file_name("mask"));
  if (table.has("cutoff")) masks.cutoff = table.share("cutoff");
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
  plane.uv = plane_uv;
}

TransmissionChoice read_transmission(const Table& table, const DescribedFile& file_of) {
  constexpr std::string_view key = "transmission";
  TransmissionChoice choice;
  choice.hint = " (transmission = false loads it as opaque)";
  if (table.has("seen")) choice.seen = table.flag("seen", false);
  if (table.is_flag(key))
    choice.is_used = table.flag(key, true);
  else if (table.is_text(key))
    choice.image = file_of(table.file_name(key));
  else if (table.has(key))
    choice.everywhere = table.shares(key, "a number of 0 .. 1, three of them, or the name of an image");
  const bool is_opaque = !choice.is_used || choice.everywhere == glm::vec3(0);
  if (is_opaque && choice.seen)
    table.refuse("seen", *choice.seen, "allowed beside a transmission of false or 0: what is opaque is seen");
  return choice;
}

void add_transmission(const Table& table, const DescribedFile& file_of, Scene& scene, Mesh& shape) {
  constexpr std::string_view key = "transmission";
  const TransmissionChoice choice = read_transmission(table, file_of);
  if (!table.has(key)) {
    if (choice.seen) table.refuse("seen", *choice.seen, "allowed without a transmission: what is opaque is seen");
    return;
  }
  if (table.is_flag(key)) table.refuse(key, table.flag(key, true), "a number of 0 .. 1, three of them, or an image of a plane");
  if (choice.image) {
    if (!shape.shape || !std::holds_alternative<Plane>(*shape.shape))
      table.refuse(key, '\'' + table.text(key) + '\'', "allowed: of the shapes, a plane alone may have an image");
    try {
      shape.transmission = read_transmission_image(*choice.image, scene);
    } catch (const Error& error) {
      throw Error("{} (named in {})", error.what(), table.where(key));
    }
  } else {
    shape.transmission = std::make_shared<const Transmission>(*choice.everywhere);
  }
  const bool is_constant = shape.transmission->is_constant();
  if (is_constant && shape.transmission->at(0, 0) == glm::vec3(0)) {
    if (choice.image && choice.seen) table.refuse("seen", *choice.seen, "allowed: its image lets no light through");
    if (choice.image)
      scene.notes.push_back(
          fmt::format("{}: its transmission {} lets no light through; it is opaque", shape.name, table.text(key)));
    shape.transmission.reset();
    return;
  }
  if (is_constant && shape.transmission->at(0, 0) == glm::vec3(1))
    scene.notes.push_back(fmt::format("{}: it lets all light through; it stops none", shape.name));
  if (shape.alpha_mask)
    scene.notes.push_back(fmt::format("{}: it has a mask and a transmission; what is solid of it transmits", shape.name));
  shape.seen = choice.seen.value_or(false);
  if (shape.needs_uv()) shape.uv = plane_uv;
}

}  // namespace gnomon
