// Draws frames by Filament for adapter.py, which asks for them as gnomon_renderer.h says.
#include <filamat/MaterialBuilder.h>
#include <filament/Camera.h>
#include <filament/Engine.h>
#include <filament/IndexBuffer.h>
#include <filament/LightManager.h>
#include <filament/Material.h>
#include <filament/MaterialInstance.h>
#include <filament/RenderTarget.h>
#include <filament/RenderableManager.h>
#include <filament/Renderer.h>
#include <filament/Scene.h>
#include <filament/SwapChain.h>
#include <filament/Texture.h>
#include <filament/VertexBuffer.h>
#include <filament/View.h>
#include <filament/Viewport.h>
#include <geometry/SurfaceOrientation.h>
#include <utils/EntityManager.h>

#include <array>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <numeric>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#undef assert_invariant  // a macro of Filament, and a function of nlohmann's JSON
#include "gnomon_renderer.h"

namespace {

using namespace filament;
using math::float3, math::short4;

float3 vector(const Json& json) { return {json.at(0).get<float>(), json.at(1).get<float>(), json.at(2).get<float>()}; }

template <class T>
std::vector<T> numbers(const std::string& name, std::size_t count) {
  std::vector<T> read(count);
  std::ifstream file(name, std::ios::binary);
  if (!file.read(reinterpret_cast<char*>(read.data()), std::streamsize(count * sizeof(T))))
    throw std::runtime_error("cannot read " + name);
  return read;
}

/// Bytes that Filament copies later, on its own thread, and gives back.
template <class T, class Descriptor>
Descriptor handed_over(std::vector<T> bytes) {
  auto* const kept = new std::vector<T>(std::move(bytes));
  return {kept->data(), kept->size() * sizeof(T),
          [](void*, std::size_t, void* user) { delete static_cast<std::vector<T>*>(user); }, kept};
}

/// What a user of Filament sets at a light; splits lie between near and far, in m from the eye.
LightManager::ShadowOptions shadow_options(const Json& json, float near, float far) {
  LightManager::ShadowOptions options;
  options.mapSize = std::stoul(json.at("map_size").get<std::string>());
  options.shadowCascades = json.at("splits");
  options.stable = json.at("stable");
  options.constantBias = json.at("depth_bias");
  options.polygonOffsetSlope = json.at("slope_bias");
  options.shadowNearHint = json.at("near_hint");
  options.shadowFarHint = json.at("far_hint");
  LightManager::ShadowCascades::computePracticalSplits(options.cascadeSplitPositions, options.shadowCascades, near, far,
                                                       json.at("split_lambda"));
  return options;
}

/// White meshes and the one light, and the frames of them.
class Frames {
 public:
  Json hello(const Json&) {
    engine_ = Engine::create(Engine::Backend::OPENGL);
    if (!engine_) throw std::runtime_error("Filament opens no OpenGL context");
    chain_ = engine_->createSwapChain(1, 1);
    renderer_ = engine_->createRenderer();
    scene_ = engine_->createScene();
    view_ = engine_->createView();
    eye_ = utils::EntityManager::get().create();
    camera_ = engine_->createCamera(eye_);
    camera_->setExposure(1);
    view_->setScene(scene_);
    view_->setCamera(camera_);
    view_->setPostProcessingEnabled(false);  // of brightness as it is
    renderer_->setClearOptions({.clearColor = {0, 0, 0, 0}, .clear = true});
    white_ = white();
    return {{"version", ENGINE_VERSION}};
  }

  /// Takes a file of the corners of all triangles and one of the normals there, and how many corners each mesh has.
  Json load(const Json& request) {
    forget_meshes();
    std::size_t corners = 0;
    for (const Json& mesh : request.at("meshes")) corners += mesh.at("corners").get<std::size_t>();
    const auto positions = numbers<float3>(request.at("position"), corners),
               normals = numbers<float3>(request.at("normal"), corners);
    std::size_t first = 0;
    for (const Json& mesh : request.at("meshes")) {
      const std::size_t count = mesh.at("corners");
      add({positions.data() + first, positions.data() + first + count}, normals.data() + first, mesh.at("casts"),
          mesh.at("receives"));
      first += count;
    }
    return Json::object();
  }

  Json relight(const Json& request) {
    light_ = request.at("light");
    settings_ = nullptr;
    return Json::object();
  }

  /// Draws a frame, answers the milliseconds that it took and writes its red, a float a pixel from the upper left.
  Json frame(const Json& request) {
    const unsigned width = request.at("width"), height = request.at("height");
    const float near = request.at("near"), far = request.at("far");
    const Json& settings = request.at("settings");
    const bool has_shadows = request.at("shadows");
    resize(width, height);
    shine(settings, near, far);
    view_->setShadowingEnabled(has_shadows);
    view_->setShadowType(settings.at("filter") == "vsm" ? View::ShadowType::VSM : View::ShadowType::PCF);
    view_->setDynamicLightingOptions(near, far);  // spots shine on all that is seen
    camera_->setProjection(request.at("fov_y_degrees"), request.at("aspect"), near, far);
    camera_->lookAt(vector(request.at("eye")), vector(request.at("target")), vector(request.at("up")));
    if (!std::exchange(is_warm_.at(has_shadows), true)) draw(1, 1);  // the first compiles programs and fills buffers
    const auto start = std::chrono::steady_clock::now();
    draw(1, 1);
    const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - start;
    write(draw(width, height), request.at("picture"));
    return {{"ms", took.count()}};
  }

 private:
  struct Mesh {
    VertexBuffer* vertices;
    IndexBuffer* index;
    utils::Entity entity;
  };

  MaterialInstance* white() {
    filamat::MaterialBuilder::init();
    filamat::MaterialBuilder builder;
    builder.name("white")
        .shading(filamat::MaterialBuilder::Shading::LIT)
        .doubleSided(true)
        .specularAmbientOcclusion(filamat::MaterialBuilder::SpecularAmbientOcclusion::NONE)
        .material(
            "void material(inout MaterialInputs material) { prepareMaterial(material); material.baseColor = vec4(1.0); "
            "material.roughness = 1.0; material.reflectance = 0.0; }")
        .platform(filamat::MaterialBuilder::Platform::DESKTOP)
        .targetApi(filamat::MaterialBuilder::TargetApi::OPENGL);
    const filamat::Package made = builder.build(engine_->getJobSystem());
    filamat::MaterialBuilder::shutdown();
    if (!made.isValid()) throw std::runtime_error("Filament makes no material");
    return Material::Builder().package(made.getData(), made.getSize()).build(*engine_)->getDefaultInstance();
  }

  void add(std::vector<float3> positions, const float3* normals, bool casts, bool receives) {
    if (positions.empty()) return;
    const std::size_t count = positions.size();
    float3 low = positions[0], high = low;
    for (const float3& p : positions) {
      low = min(low, p);
      high = max(high, p);
    }
    const auto orientation = geometry::SurfaceOrientation::Builder().vertexCount(count).normals(normals).build();
    std::vector<short4> tangents(count);
    orientation->getQuats(tangents.data(), count);
    std::vector<std::uint32_t> index(count);
    std::iota(index.begin(), index.end(), 0);
    Mesh mesh;
    mesh.vertices = VertexBuffer::Builder()
                        .vertexCount(count)
                        .bufferCount(2)
                        .attribute(VertexAttribute::POSITION, 0, VertexBuffer::AttributeType::FLOAT3)
                        .attribute(VertexAttribute::TANGENTS, 1, VertexBuffer::AttributeType::SHORT4)
                        .normalized(VertexAttribute::TANGENTS)
                        .build(*engine_);
    mesh.vertices->setBufferAt(*engine_, 0, handed_over<float3, VertexBuffer::BufferDescriptor>(std::move(positions)));
    mesh.vertices->setBufferAt(*engine_, 1, handed_over<short4, VertexBuffer::BufferDescriptor>(std::move(tangents)));
    mesh.index = IndexBuffer::Builder().indexCount(count).bufferType(IndexBuffer::IndexType::UINT).build(*engine_);
    mesh.index->setBuffer(*engine_, handed_over<std::uint32_t, IndexBuffer::BufferDescriptor>(std::move(index)));
    mesh.entity = utils::EntityManager::get().create();
    RenderableManager::Builder(1)
        .boundingBox(Box().set(low, high))
        .material(0, white_)
        .geometry(0, RenderableManager::PrimitiveType::TRIANGLES, mesh.vertices, mesh.index)
        .castShadows(casts)
        .receiveShadows(receives)
        .build(*engine_, mesh.entity);
    scene_->addEntity(mesh.entity);
    meshes_.push_back(mesh);
  }

  void forget_meshes() {
    for (const Mesh& mesh : meshes_) {
      scene_->remove(mesh.entity);
      engine_->destroy(mesh.entity);
      engine_->destroy(mesh.vertices);
      engine_->destroy(mesh.index);
      utils::EntityManager::get().destroy(mesh.entity);
    }
    meshes_.clear();
    is_warm_ = {};
  }

  /// Lights the scene, if settings or what is seen of it are others than at the last call.
  void shine(const Json& settings, float near, float far) {
    const Json all = {settings, near, far};
    if (all == settings_) return;
    if (lamp_) {
      scene_->remove(lamp_);
      engine_->destroy(lamp_);
    } else {
      lamp_ = utils::EntityManager::get().create();
    }
    const bool is_spot = light_.at("kind") == "spot";
    LightManager::Builder builder(is_spot ? LightManager::Type::SPOT : LightManager::Type::DIRECTIONAL);
    builder.direction(vector(light_.at("direction"))).castShadows(true);
    if (is_spot) {
      const float angle = light_.at("angle"), reach = light_.at("reach");
      builder.position(vector(light_.at("position")))
          .falloff(reach)
          .spotLightCone(angle, angle)
          .intensityCandela(reach * reach);
    } else {
      builder.intensity(1);
    }
    if (builder.build(*engine_, lamp_) != LightManager::Builder::Success) throw std::runtime_error("Filament makes no light");
    LightManager& lights = engine_->getLightManager();
    lights.setShadowOptions(lights.getInstance(lamp_), shadow_options(settings, near, far));  // the builder forgets splits
    scene_->addEntity(lamp_);
    settings_ = all;
    is_warm_ = {};
  }

  void resize(unsigned width, unsigned height) {
    if (target_ && color_->getWidth() == width && color_->getHeight() == height) return;
    if (target_) {
      engine_->destroy(target_);
      engine_->destroy(color_);
      engine_->destroy(depth_);
    }
    const auto texture = [&](Texture::InternalFormat format, Texture::Usage usage) {
      return Texture::Builder().width(width).height(height).levels(1).format(format).usage(usage).build(*engine_);
    };
    color_ = texture(Texture::InternalFormat::RGBA32F, Texture::Usage::COLOR_ATTACHMENT);
    depth_ = texture(Texture::InternalFormat::DEPTH32F, Texture::Usage::DEPTH_ATTACHMENT);
    target_ = RenderTarget::Builder()
                  .texture(RenderTarget::AttachmentPoint::COLOR, color_)
                  .texture(RenderTarget::AttachmentPoint::DEPTH, depth_)
                  .build(*engine_);
    view_->setRenderTarget(target_);
    view_->setViewport({0, 0, width, height});
    is_warm_ = {};
  }

  /// Draws a frame and waits until the pixels of its lower left corner are here, four floats each.
  std::vector<float> draw(unsigned width, unsigned height) {
    std::vector<float> pixels(4 * std::size_t(width) * height);
    renderer_->renderStandaloneView(view_);
    renderer_->readPixels(target_, 0, 0, width, height,
                          {pixels.data(), pixels.size() * sizeof(float), Texture::Format::RGBA, Texture::Type::FLOAT});
    engine_->flushAndWait();
    return pixels;
  }

  static void write(const std::vector<float>& pixels, const std::string& name) {
    std::vector<float> red;
    for (std::size_t k = 0; k < pixels.size(); k += 4) red.push_back(pixels[k]);
    std::ofstream file(name, std::ios::binary);
    if (!file.write(reinterpret_cast<const char*>(red.data()), std::streamsize(red.size() * sizeof(float))).flush())
      throw std::runtime_error("cannot write " + name);
  }

  Engine* engine_ = nullptr;
  SwapChain* chain_ = nullptr;
  Renderer* renderer_ = nullptr;
  Scene* scene_ = nullptr;
  View* view_ = nullptr;
  Camera* camera_ = nullptr;
  MaterialInstance* white_ = nullptr;
  RenderTarget* target_ = nullptr;
  Texture *color_ = nullptr, *depth_ = nullptr;
  utils::Entity eye_, lamp_;
  std::vector<Mesh> meshes_;
  Json light_, settings_;
  std::array<bool, 2> is_warm_ = {};  // frames without and with shadows
};

}  // namespace

int main() {
  Frames frames;
  std::_Exit(serve(frames));  // Filament insists that all is taken down in order
}
