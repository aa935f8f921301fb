#pragma once
#include <osg/Light>
#include <osgShadow/LightSpacePerspectiveShadowMap>
#include <osgShadow/MinimalShadowMap>
#include <osgShadow/ParallelSplitShadowMap>
#include <osgShadow/ShadowMap>
#include <osgShadow/ShadowedScene>
#include <osgShadow/StandardShadowMap>
#include <osgShadow/ViewDependentShadowMap>
#include <stdexcept>
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

inline const osg::Vec2 black_shadows(0, 1);  // share of the light in shadow, and what is added out of it

/// StandardShadowMap and what derives from it have no setter for their bias.
template <class ShadowMap>
struct Standard final : ShadowMap {
  Standard(const ShadowSettings& settings, osg::Light* light) {
    this->_polygonOffsetFactor = settings.slope_bias;
    this->_polygonOffsetUnits = settings.depth_bias;
    this->setTextureSize(osg::Vec2s(settings.map_size, settings.map_size));
    this->setLight(light);
    if constexpr (std::is_base_of_v<osgShadow::MinimalShadowMap, ShadowMap>) this->setMinLightMargin(settings.light_margin);
  }
};

/// Nor has ViewDependentShadowMap, which makes its bias with its shaders.
struct ViewDependent final : osgShadow::ViewDependentShadowMap {
  explicit ViewDependent(const ShadowSettings& settings) : settings_(settings) {}
  void createShaders() override {
    ViewDependentShadowMap::createShaders();
    _polygonOffset->setFactor(settings_.slope_bias);
    _polygonOffset->setUnits(settings_.depth_bias);
  }

 private:
  ShadowSettings settings_;
};

inline osg::ref_ptr<osgShadow::ShadowTechnique> shadow_map(const ShadowSettings& settings, osg::Light* light) {
  osg::ref_ptr<osgShadow::ShadowMap> made = new osgShadow::ShadowMap;
  made->setTextureSize(osg::Vec2s(settings.map_size, settings.map_size));
  made->setPolygonOffset(osg::Vec2(settings.slope_bias, settings.depth_bias));
  made->setAmbientBias(black_shadows);
  made->setLight(light);
  return made;
}

inline osg::ref_ptr<osgShadow::ShadowTechnique> parallel_split(const ShadowSettings& settings, osg::Light* light) {
  osg::ref_ptr<osgShadow::ParallelSplitShadowMap> made = new osgShadow::ParallelSplitShadowMap(nullptr, settings.splits);
  made->setTextureResolution(settings.map_size);
  made->setPolygonOffset(osg::Vec2(settings.slope_bias, settings.depth_bias));
  made->setMinNearDistanceForSplits(settings.light_margin);
  made->setAmbientBias(black_shadows);
  made->enableShadowGLSLFiltering(settings.has_filter);
  made->setUserLight(light);
  return made;
}

inline osg::ref_ptr<osgShadow::ShadowTechnique> technique(const ShadowSettings& settings, osg::Light* light) {
  using namespace osgShadow;
  if (settings.kind == "shadow_map") return shadow_map(settings, light);
  if (settings.kind == "standard") return new Standard<StandardShadowMap>(settings, light);
  if (settings.kind == "minimal") return new Standard<MinimalShadowMap>(settings, light);
  if (settings.kind == "light_space_perspective") return new Standard<LightSpacePerspectiveShadowMapVB>(settings, light);
  if (settings.kind == "view_dependent") return new ViewDependent(settings);
  if (settings.kind == "parallel_split") return parallel_split(settings, light);
  throw std::runtime_error("there are no shadows " + settings.kind);
}

/// A scene without meshes yet, whose shadows are black and follow `light`; what lacks `casting_mask` in its node mask casts
/// none. Throws std::runtime_error on a kind that there is not.
inline osg::ref_ptr<osgShadow::ShadowedScene> shadowed_scene(const ShadowSettings& settings, osg::Light* light,
                                                             unsigned casting_mask) {
  osg::ref_ptr<osgShadow::ShadowedScene> scene = new osgShadow::ShadowedScene;
  osgShadow::ShadowSettings* const common = scene->getShadowSettings();
  common->setCastsShadowTraversalMask(casting_mask);
  common->setLightNum(light->getLightNum());
  common->setTextureSize(osg::Vec2s(settings.map_size, settings.map_size));
  common->setNumShadowMapsPerLight(settings.maps_per_light);
  common->setShadowMapProjectionHint(settings.is_perspective ? osgShadow::ShadowSettings::PERSPECTIVE_SHADOW_MAP
                                                             : osgShadow::ShadowSettings::ORTHOGRAPHIC_SHADOW_MAP);
  scene->setShadowTechnique(technique(settings, light).get());
  return scene;
}
