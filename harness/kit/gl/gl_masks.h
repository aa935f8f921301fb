#pragma once
#include <gnomon/kit/gl/gl.h>

namespace gnomon {

/// The masks of a scene, each once, in the order of their first meshes: as attribute 3 counts them.
std::vector<const AlphaMask*> masks_in(const Scene& scene);
/// Words of facts that each of them has at the start of a buffer for shaders, one after the other (gl_caster_programs.cpp).
inline constexpr std::size_t mask_facts_words = 8;
/// Bytes of the alpha masks of a scene, as shaders read them.
std::size_t mask_bytes(const Scene& scene);
/// The same of its transmissions.
std::size_t transmission_bytes(const Scene& scene);
/// Adds the alpha masks and the transmissions of a scene and its places in them to its buffers. Nothing where no mesh has one.
void upload_masks(const Scene& scene, SceneBuffers& buffers);

}  // namespace gnomon
