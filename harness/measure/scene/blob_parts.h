#pragma once
// Private to the bytes of scenes: the parts that not every scene has. Masks and transmissions are made of their parts when they
// are read, so that no damaged one comes to be.
#include <gnomon/scene.h>

#include <cstdint>
#include <vector>

namespace gnomon::scene_parts {

/// A mesh with an alpha mask: both by their indices.
struct Masked {
  std::uint32_t mesh = 0, mask = 0;
  std::vector<glm::vec2> uv;
};
/// The alpha masks of a scene, each once, in the order of the meshes that have them.
struct Masks {
  std::vector<AlphaMask::Parts> masks;
  std::vector<Masked> meshes;
};

void visit_masks(auto& io, auto& all) {
  io.list(all.masks, [](auto& sub, auto& mask) {
    sub(mask.width, mask.height, mask.wrap_u, mask.wrap_v, mask.factor, mask.cutoff, mask.bits, mask.alpha);
  });
  io.list(all.meshes, [](auto& sub, auto& one) { sub(one.mesh, one.mask, one.uv); });
}

Masks masks_of(const Scene& scene);
/// Throws Error on masks that are none or fit no mesh.
void put_masks(Masks all, Scene& scene);

/// A transmission; Transmission itself has no empty state to read into.
struct TransmissionParts {
  std::int32_t width = 0, height = 0, channels = 0;
  AlphaMask::Wrap wrap_u = AlphaMask::Wrap::repeat, wrap_v = AlphaMask::Wrap::repeat;
  std::vector<float> values;
};
/// A mesh that lets light through: both by their indices. `uv` are with the alpha mask where it has one, too.
struct Transmitting {
  std::uint32_t mesh = 0, transmission = 0;
  std::vector<glm::vec2> uv;
};
/// The transmissions of a scene, each once, in the order of the meshes that have them, and the meshes that are not seen.
struct GlassParts {
  std::vector<TransmissionParts> transmissions;
  std::vector<Transmitting> meshes;
  std::vector<std::uint32_t> unseen;
  bool empty() const { return meshes.empty() && unseen.empty(); }
};

void visit_glass(auto& io, auto& all) {
  io.list(all.transmissions,
          [](auto& sub, auto& one) { sub(one.width, one.height, one.channels, one.wrap_u, one.wrap_v, one.values); });
  io.list(all.meshes, [](auto& sub, auto& one) { sub(one.mesh, one.transmission, one.uv); });
  io(all.unseen);
}

GlassParts glass_of(const Scene& scene);
/// Throws Error on transmissions that are none or fit no mesh. Masks are there already.
void put_glass(GlassParts all, Scene& scene);

}  // namespace gnomon::scene_parts
