// The child's side of an import: assimp reads the file, the nodes are walked in double, what they hold goes down the pipe.
// Whatever goes wrong here, corrupted memory included, stays here.
#include <assimp/DefaultIOSystem.h>
#include <assimp/config.h>
#include <assimp/scene.h>
#include <sys/resource.h>
#include <unistd.h>

#include <assimp/DefaultLogger.hpp>
#include <assimp/Importer.hpp>
#include <assimp/LogStream.hpp>
#include <cerrno>
#include <filesystem>
#include <fstream>
#include <new>

#include "measure/scene/import.h"

namespace gnomon {
namespace {

using namespace importing;

/// A runaway import ends here, before it takes the machine with it. What it may take grows with the files that it opens:
/// processor time, and memory up to three quarters of what there is. A process that waits, and computes nothing, ends after ten
/// times as long.
class Limits {
 public:
  Limits() { set(); }
  void add_file(std::uint64_t size) {
    bytes_ += size;
    set();
  }
  std::uint64_t megabytes() const { return memory() >> 20; }

 private:
  std::uint64_t memory() const {
    const auto pages = static_cast<std::uint64_t>(sysconf(_SC_PHYS_PAGES));
    return std::min(least_import_memory + import_memory_factor * bytes_,
                    pages * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE)) / 4 * 3);
  }
  void set() const {
    const auto seconds = least_import_seconds + static_cast<unsigned>(import_seconds_per_megabyte * (bytes_ >> 20));
    const rlimit time{used_seconds() + seconds, RLIM_INFINITY};
    setrlimit(RLIMIT_CPU, &time);
    alarm(10 * seconds);
#ifndef __SANITIZE_ADDRESS__  // its shadow memory alone would be over any limit
    const rlimit data{held_ + memory(), RLIM_INFINITY};
    setrlimit(RLIMIT_DATA, &data);
#endif
  }
  /// Of this process, which may be a fork of one that has worked before.
  static rlim_t used_seconds() {
    rusage used{};
    getrusage(RUSAGE_SELF, &used);
    return static_cast<rlim_t>(used.ru_utime.tv_sec + used.ru_stime.tv_sec + 1);
  }
  static std::uint64_t held() {
    std::uint64_t pages = 0;
    std::ifstream statm("/proc/self/statm");
    for (int field = 0; field < 6; ++field) statm >> pages;  // the sixth: data and stack
    return pages * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
  }
  const std::uint64_t held_ = held();
  std::uint64_t bytes_ = 0;
};

/// Files that an import names are files: a pipe, or a device, may never end.
class RegularFiles : public Assimp::DefaultIOSystem {
 public:
  explicit RegularFiles(Limits& limits) : limits_(limits) {}
  bool Exists(const char* name) const override {
    std::error_code code;
    return std::filesystem::is_regular_file(name, code);
  }
  Assimp::IOStream* Open(const char* name, const char* mode) override {
    std::error_code code;
    const std::uintmax_t size = Exists(name) ? std::filesystem::file_size(name, code) : 0;
    if (size == 0 || code) return nullptr;
    limits_.add_file(size);
    return DefaultIOSystem::Open(name, mode);
  }

 private:
  Limits& limits_;
};

/// Writes the answer into the pipe; a parent that is gone ends the child by SIGPIPE.
void send(const ImportedFile& answer, int fd) {
  FieldWriter writer;
  visit_file(writer, answer);
  for (std::span<const std::byte> rest = writer.bytes; !rest.empty();) {
    const ssize_t count = write(fd, rest.data(), rest.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) _exit(3);
    rest = rest.subspan(static_cast<std::size_t>(count));
  }
}

/// Assimp repairs some damage without a word but for its log (an index out of range is replaced): keep what is about indices.
class Complaints : public Assimp::LogStream {
 public:
  explicit Complaints(ImportedFile& answer) : answer_(answer) {}
  void write(const char* message) override {
    const std::string_view words = message;
    const auto speaks_of = [&](std::string_view what) { return words.find(what) != words.npos; };
    const bool is_error = words.starts_with("Error");
    if ((is_error && speaks_of("range")) || speaks_of("ertex index") || speaks_of("ndex overflow in MDL"))
      answer_.complaints.emplace_back(message);
  }

 private:
  ImportedFile& answer_;
};

glm::dmat4 widened(const aiMatrix4x4& m) {
  glm::dmat4 wide;
  for (unsigned row = 0; row < 4; ++row)
    for (unsigned column = 0; column < 4; ++column) wide[column][row] = m[row][column];
  return wide;
}

glm::dmat4 world_from_node(const aiNode* node) {
  glm::dmat4 matrix(1);
  for (; node; node = node->mParent) matrix = widened(node->mTransformation) * matrix;
  return matrix;
}

void read_material(const aiScene& scene, unsigned index, ImportedMesh& raw) {
  if (index >= scene.mNumMaterials) return;
  const aiMaterial& material = *scene.mMaterials[index];
  aiString name;
  aiColor4D color;
  // What importers make up for files without materials has this name, or none.
  const bool invented = material.Get(AI_MATKEY_NAME, name) != AI_SUCCESS || name == aiString(AI_DEFAULT_MATERIAL_NAME);
  raw.has_color = !invented && aiGetMaterialColor(&material, AI_MATKEY_COLOR_DIFFUSE, &color) == AI_SUCCESS;
  if (raw.has_color) raw.color = {color.r, color.g, color.b};
  float opacity = 1;
  raw.is_transparent = material.Get(AI_MATKEY_OPACITY, opacity) == AI_SUCCESS && opacity < 1;
  raw.has_texture = material.GetTextureCount(aiTextureType_DIFFUSE) + material.GetTextureCount(aiTextureType_OPACITY) > 0;
}

void add_meshes(const aiScene& scene, const aiNode& node, const glm::dmat4& world_from_parent, ImportedFile& answer) {
  const glm::dmat4 world_from_mesh = world_from_parent * widened(node.mTransformation);
  for (unsigned i = 0; i < node.mNumMeshes; ++i) {
    const aiMesh& mesh = *scene.mMeshes[node.mMeshes[i]];
    ImportedMesh& raw = answer.meshes.emplace_back();
    raw.name = mesh.mName.length > 0 ? mesh.mName.C_Str() : node.mName.C_Str();
    raw.world_from_mesh = world_from_mesh;
    read_material(scene, mesh.mMaterialIndex, raw);
    raw.positions.reserve(mesh.mNumVertices);
    for (unsigned v = 0; v < mesh.mNumVertices; ++v)
      raw.positions.emplace_back(mesh.mVertices[v].x, mesh.mVertices[v].y, mesh.mVertices[v].z);
    raw.corner_counts.reserve(mesh.mNumFaces);
    raw.corners.reserve(std::size_t{3} * mesh.mNumFaces);
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
      const aiFace& face = mesh.mFaces[f];
      raw.corner_counts.push_back(face.mNumIndices);
      raw.corners.insert(raw.corners.end(), face.mIndices, face.mIndices + face.mNumIndices);
    }
  }
  for (unsigned i = 0; i < node.mNumChildren; ++i) add_meshes(scene, *node.mChildren[i], world_from_mesh, answer);
}

// Cameras and lights are given as glTF means them, the only format whose ones are used: at the origin of their node, along its
// -z, half-angles for cones. Assimp's own position and direction are no help: it adds the node's translation to the camera a
// second time.
constexpr glm::dvec3 forward_node{0, 0, -1}, up_node{0, 1, 0};

void add_camera(const aiScene& scene, const aiCamera& camera, ImportedFile& answer) {
  const glm::dmat4 matrix = world_from_node(scene.mRootNode->FindNode(camera.mName));
  // Assimp 5.2 keeps yfov times the aspect ratio under the name of a horizontal angle; yfov itself where no ratio is given.
  const double aspect = camera.mAspect > 0 ? camera.mAspect : 1;
  answer.cameras.push_back({.name = camera.mName.C_Str(),
                            .eye = glm::dvec3(matrix[3]),
                            .forward = glm::dmat3(matrix) * forward_node,
                            .up = glm::dmat3(matrix) * up_node,
                            .fov_y = camera.mHorizontalFOV / aspect});
}

void add_light(const aiScene& scene, const aiLight& light, ImportedFile& answer) {
  const auto kind = [&] {
    switch (light.mType) {
      case aiLightSource_POINT:
        return ImportedLightKind::point;
      case aiLightSource_SPOT:
        return ImportedLightKind::spot;
      case aiLightSource_DIRECTIONAL:
        return ImportedLightKind::directional;
      default:
        return ImportedLightKind::other;
    }
  }();
  const glm::dmat4 matrix = world_from_node(scene.mRootNode->FindNode(light.mName));
  answer.lights.push_back({.name = light.mName.C_Str(),
                           .kind = kind,
                           .position = glm::dvec3(matrix[3]),
                           .direction = glm::dmat3(matrix) * forward_node,
                           .inner = light.mAngleInnerCone,
                           .outer = light.mAngleOuterCone});
}

}  // namespace

int import_child_main(const std::string& file, int out_fd) {
  Limits limits;
  ImportedFile answer;
  try {
    Assimp::DefaultLogger::create("", Assimp::Logger::NORMAL, 0);
    Assimp::DefaultLogger::get()->attachStream(new Complaints(answer), Assimp::Logger::Err | Assimp::Logger::Warn);
    Assimp::Importer importer;
    importer.SetIOHandler(new RegularFiles(limits));
    importer.SetPropertyBool(AI_CONFIG_IMPORT_NO_SKELETON_MESHES, true);
    // No post-processing: some of its steps abort on truncated files, and the parent checks and splits faces itself.
    const aiScene* scene = importer.ReadFile(file, 0);
    if (!scene || !scene->mRootNode) {
      answer.failure = importer.GetErrorString();
      if (answer.failure.find("bad_alloc") != std::string::npos) throw std::bad_alloc();
    } else {
      add_meshes(*scene, *scene->mRootNode, glm::dmat4(1), answer);
      for (unsigned i = 0; i < scene->mNumCameras; ++i) add_camera(*scene, *scene->mCameras[i], answer);
      for (unsigned i = 0; i < scene->mNumLights; ++i) add_light(*scene, *scene->mLights[i], answer);
    }
    send(answer, out_fd);
  } catch (const std::bad_alloc&) {
    answer.meshes = {};
    answer.failure = fmt::format("it needs more memory than the {} MiB that a file of its size may take", limits.megabytes());
    send(answer, out_fd);
  }
  return 0;
}

}  // namespace gnomon
