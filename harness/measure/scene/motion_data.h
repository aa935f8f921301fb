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
/// The same of all of a scene's motion, whose animations have plain and unique names, also beside those of its paths, and whose
/// rigs have meshes of their own.
void check_motion(const Scene& scene, const std::string& where);

/// Adds a motion, whose rigs number the scene's meshes, to that of the scene. Names of animations become plain; one that the
/// scene has already ends in _2, _3, and on.
void append_motion(Motion more, Scene& scene);

/// Merges triangles of masked meshes and of glass that move and lie on others where they are now, with the same places in the
/// image; notes how many. Others were merged when they were read.
void merge_duplicates(Scene& scene);

/// Drops triangles without area, and measures the facts of all meshes. In a mesh that an animation moves, a triangle may lack
/// area in the file's pose alone: there those go that repeat a vertex, and those that have none before all motion, either, and
/// that neither skin nor morph target could spread. The facts of such a mesh are those of its rig's base positions, so that
/// they are the same in all poses; its `degenerate_count` is that of triangles that are dropped.
void finish_meshes(Scene& scene);

/// Whether any triangle has an area where the meshes are now.
bool has_geometry_at_rest(const Scene& scene);

/// Drops meshes without triangles, and their rigs; the other rigs follow their meshes.
void drop_empty_meshes(Scene& scene);

}  // namespace gnomon
