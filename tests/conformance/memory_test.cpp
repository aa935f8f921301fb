// Whether a technique holds as many bytes as it says.
#include <gnomon/kit/shapes.h>
#include <malloc.h>
#include <unistd.h>

#include <chrono>
#include <fstream>

#include "stage.h"

#if defined(__SANITIZE_ADDRESS__)
constexpr bool memory_is_instrumented = true;
#else
constexpr bool memory_is_instrumented = false;
#endif

namespace conformance {
namespace {

class Memory : public Every {};
INSTANTIATE_TEST_SUITE_P(technique, Memory, testing::ValuesIn(technique_ids()), id_of);

constexpr double MiB = 1 << 20;

/// Resident memory of this process, without what the allocator keeps of freed memory.
double resident_bytes() {
  malloc_trim(0);
  std::ifstream statm("/proc/self/statm");
  double size = 0, resident = 0;
  statm >> size >> resident;
  return resident * static_cast<double>(sysconf(_SC_PAGESIZE));
}

/// A sphere of segments^2 triangles over a ground.
Scene ball(int segments) {
  Scene scene = load_scene("sphere_over_plane:segments=4");
  scene.meshes[1] = tessellate(*scene.meshes[1].shape, segments, "sphere");
  return scene;
}

// From 6 thousand triangles to 400 thousand, until it takes half a second or holds 64 MiB. Both figures may be off by 8 MiB:
// arenas, drivers and libraries keep memory of their own.
TEST_P(Memory, reported_bytes_are_within_a_factor_of_two_of_the_growth_in_resident_memory) {
  if (memory_is_instrumented) GTEST_SKIP() << "the sanitizer multiplies memory";
  if (uses_gl() && !process_context().info().is_software) GTEST_SKIP() << "textures lie in the memory of the device";
  {
    const auto warm = world(ball(16));  // threads, shaders and libraries come up
    const GBuffer gbuffer = warm->gbuffer(warm->scene.views[0], 320, 180);
    for (const Light& light : supported_lights(warm->scene)) fresh_answer(warm->scene, light, gbuffer);
  }
  for (const int segments : {80, 160, 320, 640}) {
    const auto w = world(ball(segments));
    const GBuffer gbuffer = w->gbuffer(w->scene.views[0], 320, 180);
    const std::vector<Light> lights = supported_lights(w->scene);
    if (lights.empty()) GTEST_SKIP() << "supports no light of the scene";
    const auto technique = set_up();
    if (uses_gl()) {  // the inputs are not the technique's
      scene_buffers(w->scene);
      gbuffer_textures(gbuffer, w->scene);
      depth_stencil(w->scene, gbuffer);
    }
    VisibilityMask mask(gbuffer.width, gbuffer.height);
    if (uses_gl()) glClearTexImage(mask.texture(), 0, GL_RED, GL_FLOAT, nullptr), glFinish();
    const double before = resident_bytes();
    const auto start = std::chrono::steady_clock::now();
    technique->build(w->scene);
    technique->relight(lights[0]);
    technique->resolve(gbuffer, mask);
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    const double growth = resident_bytes() - before;
    double bytes = 0;
    for (const Count& count : technique->counts())
      if (count.name == "bytes") bytes = count.value;
    const std::string figures = fmt::format("{} triangles, {}: {:.1f} MiB reported, resident memory grew by {:.1f} MiB",
                                            w->scene.triangle_count(), title(lights[0]), bytes / MiB, growth / MiB);
    EXPECT_LE(growth, 2 * bytes + 8 * MiB) << figures;
    EXPECT_LE(bytes, 2 * growth + 8 * MiB) << figures;
    RecordProperty(fmt::format("triangles_{}", w->scene.triangle_count()), figures);
    if (seconds.count() > 0.5 || bytes > 64 * MiB) break;
  }
}

}  // namespace
}  // namespace conformance
