#include <gnomon/error.h>
#include <gnomon/kit/bases/answer.h>
#include <gnomon/kit/gl/gl.h>
#include <gnomon/kit/rays/gbuffer_maker.h>
#include <gnomon/kit/vulkan/current.h>
#include <gnomon/registry.h>

namespace gnomon {

Answer answer(std::string_view technique, const Scene& scene, const Light& light, const View& view, int width, int height) {
  const std::size_t colon = technique.find(':');
  const TechniqueEntry& entry = registry().technique(technique.substr(0, colon));
  const std::unique_ptr<Technique> object = entry.make();
  if (colon != technique.npos) object->apply(technique.substr(colon + 1));
  if (width < 1 || height < 1) throw Error("a picture of {} x {} pixels has none", width, height);
  if (entry.about.device == Device::opengl) {
    if (!gl_limits()) throw Error("{} draws: make an OpenGL 4.5 core context current and call ask_gl_limits() first", entry.id);
    glClipControl(GL_UPPER_LEFT, GL_ZERO_TO_ONE);
  }
  if (entry.about.device == Device::vulkan && !current_vulkan())
    throw Error("{} works with Vulkan: make a device current first (set_current_vulkan of gnomon/kit/vulkan/vulkan.h)",
                entry.id);
  if (const Support support = support_of(entry.about, *object, scene, light, view); !support)
    throw Error("{} does not support this: {}", entry.id, support.why());
  Answer seen;
  seen.gbuffer =
      make_gbuffer(scene, RayScene(scene, entry.about.sees, RayScene::Which::seen), view, width, height, entry.about.sees);
  VisibilityMask mask(width, height);
  object->setup();
  object->build(scene);
  object->relight(light);
  object->resolve(seen.gbuffer, mask);
  const std::span<const float> pixels = mask.read();
  seen.mask.assign(pixels.begin(), pixels.end());
  return seen;
}

}  // namespace gnomon
