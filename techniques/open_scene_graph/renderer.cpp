// Draws frames by OpenSceneGraph for adapter.py, which asks for them as gnomon_renderer.h says.
#include <algorithm>
#include <array>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <osg/Geometry>
#include <osg/LightModel>
#include <osg/LightSource>
#include <osg/Material>
#include <osg/PolygonOffset>
#include <osg/Program>
#include <osg/Texture2D>
#include <osg/Version>
#include <osgViewer/Viewer>
#include <stdexcept>
#include <utility>

#include "gnomon_renderer.h"
#include "shadows.h"

namespace {

constexpr unsigned seen_mask = 1, casting_mask = 2;

osg::Vec3d vector(const Json& json) { return {json.at(0), json.at(1), json.at(2)}; }

std::ifstream opened(const std::string& name) {
  std::ifstream file(name, std::ios::binary);
  if (!file) throw std::runtime_error("cannot read " + name);
  return file;
}

/// The next numbers of a file.
template <class Array>
osg::ref_ptr<Array> next(std::ifstream& file, std::size_t count) {
  osg::ref_ptr<Array> numbers = new Array(count);
  if (count > 0 && !file.read(reinterpret_cast<char*>(&numbers->front()), numbers->getTotalDataSize()))
    throw std::runtime_error("a file of geometry ends early");
  return numbers;
}

ShadowSettings shadow_settings(const Json& json) {
  return {.kind = json.at("shadows"),
          .map_size = json.at("map_size"),
          .slope_bias = json.at("slope_bias"),
          .depth_bias = json.at("depth_bias"),
          .light_margin = json.at("light_margin"),
          .splits = json.at("splits"),
          .has_filter = json.at("filter"),
          .maps_per_light = json.at("maps_per_light"),
          .is_perspective = json.at("projection") == "perspective"};
}

/// White meshes, the light that shines and the one that shadows follow.
class World {
 public:
  World() {
    osg::ref_ptr<osg::Material> white = new osg::Material;
    white->setDiffuse(osg::Material::FRONT_AND_BACK, osg::Vec4(1, 1, 1, 1));
    white->setAmbient(osg::Material::FRONT_AND_BACK, osg::Vec4(0, 0, 0, 1));
    osg::ref_ptr<osg::LightModel> no_ambient = new osg::LightModel;
    no_ambient->setAmbientIntensity(osg::Vec4(0, 0, 0, 1));
    osg::StateSet* const state = root->getOrCreateStateSet();
    state->setAttribute(white);
    state->setAttribute(no_ambient);
    state->setMode(GL_LIGHTING, osg::StateAttribute::ON);
    state->setMode(GL_LIGHT0, osg::StateAttribute::ON);
    shadowless_->addShader(new osg::Shader(osg::Shader::FRAGMENT, "void main() { gl_FragColor = gl_Color; }"));
    // The first shines on all sides: engines light vertices, between which a cone would be lost. The second is never switched
    // on.
    shining_->setLightNum(0);
    aiming->setLightNum(1);
    for (osg::Light* const light : {shining_.get(), aiming.get()}) {
      light->setAmbient(osg::Vec4(0, 0, 0, 1));
      light->setDiffuse(osg::Vec4(1, 1, 1, 1));
      light->setSpecular(osg::Vec4(0, 0, 0, 1));
      osg::ref_ptr<osg::LightSource> source = new osg::LightSource;
      source->setLight(light);
      source->setCullingActive(false);
      root->addChild(source);
    }
  }

  /// The next mesh of two files, of positions and of triangles.
  void add(const Json& mesh, std::ifstream& positions, std::ifstream& triangles) {
    const std::size_t vertices = mesh.at("vertices"), corners = 3 * mesh.at("triangles").get<std::size_t>();
    osg::ref_ptr<osg::Geometry> made = new osg::Geometry;
    made->setUseDisplayList(false);
    made->setUseVertexBufferObjects(true);
    made->setVertexArray(next<osg::Vec3Array>(positions, vertices));
    const osg::ref_ptr<osg::UIntArray> index = next<osg::UIntArray>(triangles, corners);
    for (unsigned& corner : *index) corner -= mesh.at("first_vertex").get<unsigned>();
    if (corners > 0) made->addPrimitiveSet(new osg::DrawElementsUInt(GL_TRIANGLES, index->begin(), index->end()));
    const bool casts = mesh.at("casts");
    made->setNodeMask(casts ? seen_mask | casting_mask : seen_mask);
    has_casters |= casts && corners > 0;
    osg::StateSet* const state = made->getOrCreateStateSet();
    if (!mesh.at("receives")) state->setAttribute(shadowless_);
    if (!mesh.at("is_closed")) {
      // Against shadows that cull the faces turned to the light and draw the others nearer: an open mesh has no others.
      state->setMode(GL_CULL_FACE, osg::StateAttribute::OFF | osg::StateAttribute::PROTECTED);
      state->setAttribute(open_offset_, osg::StateAttribute::ON | osg::StateAttribute::PROTECTED);
    }
    meshes_.push_back(made);
    root->addChild(made);
  }

  /// Takes a light and the file of the normals of all vertices, which point to it.
  void relight(const Json& light, std::ifstream& normals) {
    for (const auto& mesh : meshes_)
      mesh->setNormalArray(next<osg::Vec3Array>(normals, mesh->getVertexArray()->getNumElements()),
                           osg::Array::BIND_PER_VERTEX);
    const bool is_directional = light.at("kind") == "directional";
    const osg::Vec3d aim = vector(light.at("aim"));
    const osg::Vec4 position = is_directional ? osg::Vec4(-aim, 0) : osg::Vec4(vector(light.at("position")), 1);
    for (osg::Light* const each : {shining_.get(), aiming.get()}) {
      each->setPosition(position);
      each->setDirection(aim);
    }
    aiming->setSpotCutoff(light.at("cutoff_degrees"));
  }

  void set_bias(const ShadowSettings& settings) {
    open_offset_->setFactor(settings.slope_bias);
    open_offset_->setUnits(settings.depth_bias);
  }

  const osg::ref_ptr<osg::Group> root = new osg::Group;
  const osg::ref_ptr<osg::Light> aiming = new osg::Light;
  bool has_casters = false;

 private:
  const osg::ref_ptr<osg::Light> shining_ = new osg::Light;
  const osg::ref_ptr<osg::Program> shadowless_ = new osg::Program;
  const osg::ref_ptr<osg::PolygonOffset> open_offset_ = new osg::PolygonOffset;
  std::vector<osg::ref_ptr<osg::Geometry>> meshes_;
};

class Renderer {
 public:
  /// Opens the context: a pbuffer of one pixel, since frames are drawn to textures.
  Json hello(const Json&) {
    osg::ref_ptr<osg::GraphicsContext::Traits> traits = new osg::GraphicsContext::Traits;
    traits->readDISPLAY();
    traits->width = traits->height = 1;
    traits->pbuffer = true;
    context_ = osg::GraphicsContext::createGraphicsContext(traits);
    if (!context_) throw std::runtime_error("OpenSceneGraph opens no pbuffer on display " + traits->displayName());
    viewer_.setThreadingModel(osgViewer::ViewerBase::SingleThreaded);
    viewer_.setReleaseContextAtEndOfFrameHint(false);
    viewer_.setLightingMode(osg::View::NO_LIGHT);
    viewer_.setSceneData(top_);
    picture_->setInternalFormat(GL_RGBA8);
    osg::Camera* const eye = viewer_.getCamera();
    eye->setGraphicsContext(context_);
    eye->setRenderTargetImplementation(osg::Camera::FRAME_BUFFER_OBJECT);
    eye->setClearColor(osg::Vec4(0, 0, 0, 0));
    eye->setComputeNearFarMode(osg::CullSettings::DO_NOT_COMPUTE_NEAR_FAR);
    eye->setCullingMode(osg::CullSettings::VIEW_FRUSTUM_CULLING);
    if (!context_->realize() || !context_->makeCurrent()) throw std::runtime_error("OpenSceneGraph opens no OpenGL context");
    glGetIntegerv(GL_MAX_TEXTURE_SIZE, &largest_);
    return {{"version", osgGetVersion()}};
  }

  Json load(const Json& request) {
    std::ifstream positions = opened(request.at("position")), triangles = opened(request.at("triangle"));
    forget_shadows();
    world_ = std::make_unique<World>();
    for (const Json& mesh : request.at("meshes")) world_->add(mesh, positions, triangles);
    return Json::object();
  }

  Json relight(const Json& request) {
    std::ifstream normals = opened(request.at("normal"));
    forget_shadows();
    world_->relight(request.at("light"), normals);
    return Json::object();
  }

  /// Draws a frame, answers the milliseconds that it took and writes its red, a byte a pixel from the lower left.
  Json frame(const Json& request) {
    const int width = request.at("width"), height = request.at("height");
    const bool has_shadows = request.at("shadows") && world_->has_casters;  // osgShadow aims at the middle of all casters
    resize(width, height);
    choose(has_shadows, shadow_settings(request.at("settings")));
    osg::Camera* const eye = viewer_.getCamera();
    eye->setViewMatrixAsLookAt(vector(request.at("eye")), vector(request.at("target")), vector(request.at("up")));
    eye->setProjectionMatrixAsPerspective(request.at("fov_y_degrees"), request.at("aspect"), request.at("near"),
                                          request.at("far"));
    if (!std::exchange(is_warm_.at(has_shadows), true)) viewer_.frame();  // the first compiles programs and fills buffers
    glFinish();
    const auto start = std::chrono::steady_clock::now();
    viewer_.frame();
    glFinish();
    const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - start;
    write_picture(request.at("picture"), width, height);
    return {{"ms", took.count()}};
  }

 private:
  void forget_shadows() {
    shadowed_ = nullptr;
    is_warm_ = {};
  }

  void resize(int width, int height) {
    if (picture_->getTextureWidth() == width && picture_->getTextureHeight() == height) return;
    if (std::max(width, height) > largest_)
      throw std::runtime_error("a picture of " + std::to_string(width) + " x " + std::to_string(height) +
                               " pixels is larger than a texture may be: " + std::to_string(largest_));
    is_warm_ = {};
    picture_->setTextureSize(width, height);
    picture_->dirtyTextureObject();
    osg::Camera* const eye = viewer_.getCamera();
    eye->setViewport(0, 0, width, height);
    eye->attach(osg::Camera::COLOR_BUFFER, picture_.get());
    eye->attach(osg::Camera::DEPTH_BUFFER, GL_DEPTH_COMPONENT24);
    eye->dirtyAttachmentMap();
  }

  /// Puts the meshes before the eye, with shadows or without.
  void choose(bool has_shadows, const ShadowSettings& settings) {
    if (has_shadows && (!shadowed_ || settings != settings_)) {
      settings_ = settings;
      world_->set_bias(settings);
      shadowed_ = shadowed_scene(settings, world_->aiming, casting_mask);
      shadowed_->addChild(world_->root);
      is_warm_.at(has_shadows) = false;
    }
    top_->removeChildren(0, top_->getNumChildren());
    top_->addChild(has_shadows ? static_cast<osg::Group*>(shadowed_.get()) : world_->root.get());
  }

  void write_picture(const std::string& name, int width, int height) {
    std::vector<unsigned char> red(std::size_t(width) * height);
    context_->getState()->setActiveTextureUnit(0);
    picture_->getTextureObject(context_->getState()->getContextID())->bind();
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glGetTexImage(GL_TEXTURE_2D, 0, GL_RED, GL_UNSIGNED_BYTE, red.data());
    context_->getState()->haveAppliedTextureAttribute(0, osg::StateAttribute::TEXTURE);
    std::ofstream file(name, std::ios::binary);
    if (!file.write(reinterpret_cast<const char*>(red.data()), std::streamsize(red.size())).flush())
      throw std::runtime_error("cannot write " + name);
  }

  osg::ref_ptr<osg::GraphicsContext> context_;
  osgViewer::Viewer viewer_;
  const osg::ref_ptr<osg::Group> top_ = new osg::Group;
  std::unique_ptr<World> world_;
  const osg::ref_ptr<osg::Texture2D> picture_ = new osg::Texture2D;
  osg::ref_ptr<osgShadow::ShadowedScene> shadowed_;
  ShadowSettings settings_;
  int largest_ = 0;                   // side of a texture
  std::array<bool, 2> is_warm_ = {};  // frames without and with shadows
};

}  // namespace

int main() {
  osg::setNotifyLevel(osg::WARN);
  Renderer renderer;
  std::_Exit(serve(renderer));  // OpenSceneGraph 3.6 may wait for itself where what has looked at shadows is destroyed
}
