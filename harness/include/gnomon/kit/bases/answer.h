#pragma once
#include <gnomon/gbuffer.h>

#include <string_view>
#include <vector>

namespace gnomon {

/// What a technique says of one light in one view.
struct Answer {
  GBuffer gbuffer;          ///< what the eye sees: surfaces as the technique works on them (About::sees)
  std::vector<float> mask;  ///< of each pixel: 1 lit, 0 umbra, between penumbra; row-major, (0, 0) top left
};

/// From a scene to a mask, all stages once:
///   add_built_in(registry());  // gnomon/built_in.h
///   const Answer seen = answer("svbsp", scene, scene.lights[0], scene.views[0]);
/// `technique` is an id in this process's registry, with settings behind it as on the command line:
/// "shadow_map:resolution=2048,filter=pcf". Throws Error when there is none of that id, where it does not support scene, light
/// or view, and of one that draws when no OpenGL 4.5 core context is current of which `ask_gl_limits`
/// (gnomon/kit/gl/gl_limits.h) was called; clip control is set here. Likewise without a Vulkan device, where one needs that.
Answer answer(std::string_view technique, const Scene& scene, const Light& light, const View& view, int width = 640,
              int height = 360);

}  // namespace gnomon
