// Prints the shadows that a technique answers in a generated scene as text: lit surfaces are dots, shadows #.
//   answer [TECHNIQUE[:SETTINGS] [SCENE [LIGHT]]]
// By default svbsp, single_triangle and its light `point`. Techniques that draw need an OpenGL context, which this program does
// not make.
// To build it, CMake needs find_package(gnomon) and target_link_libraries(answer gnomon::techniques).
#include <gnomon/built_in.h>
#include <gnomon/error.h>
#include <gnomon/kit/bases/answer.h>

#include <algorithm>
#include <cstdio>

using namespace gnomon;

int main(int argc, char** argv) try {
  add_built_in(registry());
  const std::string_view technique = argc > 1 ? argv[1] : "svbsp", name = argc > 2 ? argv[2] : "single_triangle",
                         light_name = argc > 3 ? argv[3] : "point";
  const SceneEntry* const entry = registry().find_scene(name);
  if (!entry) throw Error("there is no generated scene {}", name);
  const Scene scene = entry->make()->make();
  const auto light = std::ranges::find(scene.lights, light_name, &Light::name);
  if (light == scene.lights.end()) throw Error("{} has no light {}", name, light_name);

  constexpr int width = 72, height = 36;
  const Answer seen = answer(technique, scene, *light, scene.views.front(), width, height);

  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const std::size_t i = static_cast<std::size_t>(y) * width + x;
      std::putchar(seen.gbuffer.is_background(i) ? ' ' : "#*+-."[static_cast<int>(seen.mask[i] * 4)]);
    }
    std::putchar('\n');
  }
} catch (const std::exception& error) {
  std::fprintf(stderr, "answer: %s\n", error.what());
  return 2;
}
