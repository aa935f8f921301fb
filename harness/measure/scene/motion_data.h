#pragma once
// Checks and joins motions, wherever they come from: files, descriptions, generated scenes.
#include <gnomon/scene.h>

#include <string>

namespace gnomon {

/// Throws Error unless nodes, skins and the tracks of animations are as motion.h says: every index in range, parents before
/// children, all numbers finite, times ascending, as many values as keys need, rotations of length 1. The error opens with
/// `where` and names node, skin, or animation, track and key.
void check_motion(const Motion& motion, const std::string& where);
/// The same of a rig of that motion for a mesh with so many vertices.
void check_rig(const Motion& motion, const Rig& rig, std::size_t vertex_count, const std::string& where);
/// The same of all of a scene's motion, whose animations have plain and unique names and whose rigs have meshes of their own.
void check_motion(const Scene& scene, const std::string& where);

/// Adds a motion, whose rigs number the scene's meshes, to that of the scene. Names of animations become plain; one that the
/// scene has already ends in _2, _3, and on.
void append_motion(Motion more, Scene& scene);

/// Merges triangles of masked meshes and of glass that move and lie on others where they are now, with the same places in the
/// image; notes how many. Others were merged when they were read.
void merge_duplicates(Scene& scene);

/// Drops meshes without triangles, and their rigs; the other rigs follow their meshes.
void drop_empty_meshes(Scene& scene);

}  // namespace gnomon
