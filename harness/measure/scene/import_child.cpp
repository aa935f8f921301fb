// The child's side of an import: assimp reads the file, the nodes are walked in double, what they hold goes down the pipe.
// Whatever goes wrong here, corrupted memory included, stays here.
#include <assimp/config.h>
#include <assimp/scene.h>
#include <sys/resource.h>
#include <unistd.h>

#include <assimp/DefaultLogger.hpp>
#include <assimp/Importer.hpp>
#include <assimp/LogStream.hpp>
#include <cerrno>
#include <new>

#include "measure/scene/import.h"

namespace gnomon {
namespace {

using namespace importing;

constexpr unsigned time_limit_seconds = 120;

/// A runaway import ends here, before it takes the machine with it: seconds by alarm, memory at three quarters of what there
/// is.
void limit_self() {
  alarm(time_limit_seconds);
#ifndef __SANITIZE_ADDRESS__  // its shadow memory alone would be over any limit
  const rlim_t bytes = static_cast<rlim_t>(sysconf(_SC_PHYS_PAGES)) * sysconf(_SC_PAGESIZE) / 4 * 3;
  const rlimit limit{bytes, bytes};
  setrlimit(RLIMIT_DATA, &limit);
#endif
}

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

/// Assimp repairs some damage without a word but for its log (an OFF index out of range is replaced): keep those words.
class Complaints : public Assimp::LogStream {
 public:
  explicit Complaints(ImportedFile& answer) : answer_(answer) {}
  void write(const char* message) override { answer_.complaints.emplace_back(message); }

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
  limit_self();
  ImportedFile answer;
  try {
    Assimp::DefaultLogger::create("", Assimp::Logger::NORMAL, 0);
    Assimp::DefaultLogger::get()->attachStream(new Complaints(answer), Assimp::Logger::Err);
    Assimp::Importer importer;
    importer.SetPropertyBool(AI_CONFIG_IMPORT_NO_SKELETON_MESHES, true);
    // No post-processing: some of its steps abort on truncated files, and the parent checks and splits faces itself.
    const aiScene* scene = importer.ReadFile(file, 0);
    if (!scene || !scene->mRootNode) {
      answer.failure = importer.GetErrorString();
    } else {
      add_meshes(*scene, *scene->mRootNode, glm::dmat4(1), answer);
      for (unsigned i = 0; i < scene->mNumCameras; ++i) add_camera(*scene, *scene->mCameras[i], answer);
      for (unsigned i = 0; i < scene->mNumLights; ++i) add_light(*scene, *scene->mLights[i], answer);
    }
    send(answer, out_fd);
  } catch (const std::bad_alloc&) {
    answer.meshes = {};
    answer.failure = "it needs more memory than three quarters of this machine's";
    send(answer, out_fd);
  }
  return 0;
}

}  // namespace gnomon
