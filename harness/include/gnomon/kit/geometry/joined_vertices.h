#pragma once
#include <gnomon/scene.h>

#include <span>
#include <vector>

namespace gnomon {

/// For each vertex of a scene, counted mesh after mesh, the first one that is at its place in every pose of the scene's motion.
///
/// Vertices of meshes that stand still are joined where their positions are equal, across meshes. Vertices of meshes with a rig
/// are joined where nothing can part them: their rigs have the same node, skin and placement, and the vertices have the same
/// base position, moves by morph targets, joints and weights, all exactly. They then have the same bits in every pose. A vertex
/// with a rig and one without are never joined, wherever they are.
///
/// `positions` are those of all vertices. Vertices that are not `wanted` are left alone.
std::vector<std::uint32_t> join_vertices(const Scene& scene, std::span<const glm::vec3> positions,
                                         std::span<const std::uint8_t> wanted);

}  // namespace gnomon
