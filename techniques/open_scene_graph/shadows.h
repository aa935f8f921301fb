#pragma once
#include <osg/Light>
#include <osgShadow/ShadowedScene>
#include <string>

/// What a user of OpenSceneGraph sets at its shadows, in its own units.
struct ShadowSettings {
  std::string kind;             ///< shadow_map, standard, minimal, light_space_perspective, view_dependent, parallel_split
  int map_size = 0;             ///< texels along each side
  float slope_bias = 0;         ///< factor of glPolygonOffset
  float depth_bias = 0;         ///< units of glPolygonOffset
  float light_margin = 0;       ///< m to the light from what is seen, where casters count, too
  int splits = 0;               ///< maps of parallel_split
  bool has_filter = false;      ///< of parallel_split
  int maps_per_light = 0;       ///< of view_dependent
  bool is_perspective = false;  ///< whether view_dependent warps the maps of directional lights

  bool operator==(const ShadowSettings&) const = default;
};

/// A scene without meshes yet, whose shadows are black and follow `light`; what lacks `casting_mask` in its node mask casts
/// none. Throws std::runtime_error on a kind that there is not.
osg::ref_ptr<osgShadow::ShadowedScene> shadowed_scene(const ShadowSettings& settings, osg::Light* light, unsigned casting_mask);
