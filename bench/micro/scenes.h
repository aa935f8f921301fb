#pragma once
#include <benchmark/benchmark.h>
#include <gnomon/kit/geometry/shapes.h>
#include <gnomon/kit/rays/gbuffer_maker.h>
#include <gnomon/registry.h>

#include <map>

#include "measure/scene/load.h"

// Scenes, pictures and techniques that several benchmarks measure.

namespace gnomon {

/// Loaded at the first request. Returns null, and skips the case with what to do, where the scene's files are not here.
inline const Scene* loaded(benchmark::State& state, const std::string& reference) {
  static std::map<std::string, Scene> scenes;
  try {
    if (!scenes.contains(reference)) scenes.emplace(reference, load_scene(reference));
    return &scenes.at(reference);
  } catch (const SceneNotFetched& error) {
    state.SkipWithError(error.what());
    return nullptr;
  }
}

/// A sphere that stands on a ground as a mesh of about segments^2 triangles, without its exact shape.
inline Scene ball_over_ground(const std::string& name, float radius, int segments) {
  Mesh ball = tessellate(Sphere{{0, 1.5f, 0}, radius}, segments, "ball");
  ball.shape.reset();
  Scene scene;
  scene.name = name;
  scene.meshes = {tessellate(ground_plane(6), default_segments, "ground"), std::move(ball)};
  scene.lights = {{.name = "point", .kind = PointLight{{-4, 6, 3}}}};
  scene.views = {{.eye = {1, 4, 7}, .target = {0, 1, 0}}};
  return scene;
}

inline GBuffer seen(const Scene& scene, const View& view, int width, int height, Truth truth = Truth::mesh) {
  return make_gbuffer(scene, RayScene(scene, truth, RayScene::Which::seen), view, width, height, truth);
}

/// Set up and built.
inline std::unique_ptr<Technique> made(const std::string& id, const std::string& settings, const Scene& scene) {
  auto technique = registry().technique(id).make();
  technique->apply(settings);
  technique->setup();
  technique->build(scene);
  return technique;
}

/// Ready to resolve.
inline std::unique_ptr<Technique> made(const std::string& id, const std::string& settings, const Scene& scene,
                                       const Light& light) {
  auto technique = made(id, settings, scene);
  technique->relight(light);
  return technique;
}

}  // namespace gnomon
