#include "measure/scene/blob_parts.h"

#include <gnomon/error.h>

#include <map>
#include <span>

#include "measure/scene/base_scene.h"

namespace gnomon::scene_parts {
namespace {

/// Throws Error unless each vertex of a mesh has a sound place in a picture.
void check_places(std::span<const glm::vec2> uv, std::uint32_t number, const Mesh& mesh) {
  if (uv.size() != mesh.positions.size())
    throw Error("scene bytes have {} uv for the {} vertices of mesh {} ({})", uv.size(), mesh.positions.size(), number,
                mesh.name);
  for (std::size_t v = 0; v < uv.size(); ++v)
    if (!is_sound_uv(uv[v]))
      throw Error("scene bytes have uv = ({}, {}), which is not within {} .. {}, for vertex {} of mesh {} ({})", uv[v].x,
                  uv[v].y, -largest_uv, largest_uv, v, number, mesh.name);
}

}  // namespace

Masks masks_of(const Scene& scene) {
  Masks all;
  std::map<const AlphaMask*, std::uint32_t> known;  // never walked through: addresses have no order that repeats
  for (std::uint32_t m = 0; m < scene.meshes.size(); ++m) {
    const Mesh& mesh = scene.meshes[m];
    if (!mesh.alpha_mask) continue;
    const AlphaMask& mask = *mesh.alpha_mask;
    const auto [found, is_new] = known.try_emplace(&mask, static_cast<std::uint32_t>(all.masks.size()));
    if (is_new)
      all.masks.push_back({mask.width(),
                           mask.height(),
                           mask.wrap_u(),
                           mask.wrap_v(),
                           mask.factor(),
                           mask.cutoff(),
                           {mask.bits().begin(), mask.bits().end()},
                           {mask.alpha().begin(), mask.alpha().end()}});
    all.meshes.push_back({m, found->second, mesh.uv});
  }
  return all;
}

void put_masks(Masks all, Scene& scene) {
  std::vector<std::shared_ptr<const AlphaMask>> masks;
  for (AlphaMask::Parts& parts : all.masks) masks.push_back(std::make_shared<const AlphaMask>(std::move(parts)));
  for (Masked& one : all.meshes) {
    if (one.mesh >= scene.meshes.size())
      throw Error("scene bytes have an alpha mask for mesh {} of {}", one.mesh, scene.meshes.size());
    Mesh& mesh = scene.meshes[one.mesh];
    if (mesh.alpha_mask) throw Error("scene bytes have two alpha masks for mesh {} ({})", one.mesh, mesh.name);
    if (one.mask >= masks.size())
      throw Error("scene bytes have alpha mask {} of {} for mesh {} ({})", one.mask, masks.size(), one.mesh, mesh.name);
    check_places(one.uv, one.mesh, mesh);
    if (mesh.has_curved_shape())
      throw Error("scene bytes have an alpha mask for mesh {} ({}), whose shape is curved", one.mesh, mesh.name);
    mesh.alpha_mask = masks[one.mask];
    mesh.uv = std::move(one.uv);
  }
}

GlassParts glass_of(const Scene& scene) {
  GlassParts all;
  std::map<const Transmission*, std::uint32_t> known;  // never walked through, as above
  for (std::uint32_t m = 0; m < scene.meshes.size(); ++m) {
    const Mesh& mesh = scene.meshes[m];
    if (!mesh.seen) all.unseen.push_back(m);
    if (!mesh.transmission) continue;
    const Transmission& one = *mesh.transmission;
    const auto [found, is_new] = known.try_emplace(&one, static_cast<std::uint32_t>(all.transmissions.size()));
    if (is_new)
      all.transmissions.push_back(
          {one.width(), one.height(), one.channels(), one.wrap_u(), one.wrap_v(), {one.values().begin(), one.values().end()}});
    all.meshes.push_back({m, found->second, mesh.alpha_mask ? std::vector<glm::vec2>() : mesh.uv});
  }
  return all;
}

void put_glass(GlassParts all, Scene& scene) {
  std::vector<std::shared_ptr<const Transmission>> transmissions;
  for (TransmissionParts& one : all.transmissions)
    transmissions.push_back(std::make_shared<const Transmission>(one.width, one.height, one.channels, std::move(one.values),
                                                                 one.wrap_u, one.wrap_v));
  for (Transmitting& one : all.meshes) {
    if (one.mesh >= scene.meshes.size())
      throw Error("scene bytes have a transmission for mesh {} of {}", one.mesh, scene.meshes.size());
    Mesh& mesh = scene.meshes[one.mesh];
    if (mesh.transmission) throw Error("scene bytes have two transmissions for mesh {} ({})", one.mesh, mesh.name);
    if (one.transmission >= transmissions.size())
      throw Error("scene bytes have transmission {} of {} for mesh {} ({})", one.transmission, transmissions.size(), one.mesh,
                  mesh.name);
    if (mesh.has_curved_shape())
      throw Error("scene bytes have a transmission for mesh {} ({}), whose shape is curved", one.mesh, mesh.name);
    if (mesh.alpha_mask && !one.uv.empty())
      throw Error("scene bytes have uv for both mask and transmission of mesh {} ({})", one.mesh, mesh.name);
    mesh.transmission = transmissions[one.transmission];
    if (mesh.alpha_mask) continue;
    if (mesh.needs_uv() || !one.uv.empty()) check_places(one.uv, one.mesh, mesh);
    mesh.uv = std::move(one.uv);
  }
  for (const std::uint32_t m : all.unseen) {
    if (m >= scene.meshes.size()) throw Error("scene bytes say that mesh {} of {} is not seen", m, scene.meshes.size());
    if (!scene.meshes[m].seen) throw Error("scene bytes say twice that mesh {} ({}) is not seen", m, scene.meshes[m].name);
    scene.meshes[m].seen = false;
  }
}

}  // namespace gnomon::scene_parts
