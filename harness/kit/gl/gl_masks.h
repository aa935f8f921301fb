#pragma once
#include <gnomon/kit/gl/gl.h>

namespace gnomon {

/// Bytes of the alpha masks of a scene, as shaders read them.
std::size_t mask_bytes(const Scene& scene);
/// Adds the alpha masks of a scene and its places in them to its buffers. Nothing where no mesh has one.
void upload_masks(const Scene& scene, SceneBuffers& buffers);

}  // namespace gnomon
