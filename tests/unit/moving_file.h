#pragma once
// Answers of the importer about files that move, made by hand.
#include <string>
#include <utility>
#include <vector>

#include "measure/scene/import.h"

namespace gnomon::moving_file {

using namespace importing;

inline void add(const MeshFile& file, Scene& scene, const Placement& placement = {}) {
  FieldWriter writer;
  visit_file(writer, file);
  add_imported("hand.gltf", writer.bytes, placement, scene);
}
inline Scene imported(const MeshFile& file, const Placement& placement = {}) {
  Scene scene;
  add(file, scene, placement);
  return scene;
}

/// A triangle whose corners are 0, x and y, at the node of that number.
inline ImportedMesh triangle(const std::string& name, std::uint32_t node) {
  ImportedMesh mesh;
  mesh.name = name;
  mesh.places = {glm::dmat4(1)};
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.add_triangle(0, 1, 2);
  mesh.nodes = {node};
  return mesh;
}

inline Track track(std::uint32_t node, Track::Property property, std::vector<double> values) {
  return {.node = node, .property = property, .times = {0, 1}, .values = std::move(values)};
}

/// One node, one triangle; animation `walk` moves it by 2 along z in a second.
inline MeshFile walking() {
  MeshFile file;
  file.motion.nodes.resize(1);
  file.motion.animations.push_back({.name = "walk", .tracks = {track(0, Track::Property::translation, {0, 0, 0, 0, 0, 2})}});
  file.meshes.push_back(triangle("walker", 0));
  return file;
}

/// A triangle with a skin of the nodes 1 and 2, and two morph targets, whose weights node 0 carries.
inline MeshFile bending() {
  MeshFile file;
  file.motion.nodes.resize(3);
  file.motion.nodes[0].weights = {0, 0};
  file.motion.nodes[2].parent = 1;
  file.motion.skins.push_back({.joints = {1, 2}, .inverse_bind = {glm::dmat4(1), glm::dmat4(1)}});
  file.motion.animations.push_back({.name = "bend",
                                    .tracks = {track(0, Track::Property::weights, {0, 0, 1, 0}),
                                               track(2, Track::Property::rotation, {0, 0, 0, 1, 0, 0.6, 0, 0.8})}});
  ImportedMesh mesh = triangle("bender", 0);
  mesh.skin = 0;
  mesh.targets = {{0, 0, 1}, {0, 0, 1}, {0, 0, 1}, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}};
  mesh.joints_per_vertex = 2;
  mesh.joints = {0, 1, 0, 1, 0, 1};
  mesh.weights = {1, 0, 0.5, 0.5, 0.5, 0.5};
  file.meshes.push_back(std::move(mesh));
  return file;
}

}  // namespace gnomon::moving_file
