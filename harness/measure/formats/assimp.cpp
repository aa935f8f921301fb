// All formats that have no reader of their own, by assimp: which losses it has is not known, and the notes of the file say so.
#include <assimp/DefaultIOSystem.h>
#include <assimp/MemoryIOWrapper.h>
#include <assimp/config.h>
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/DefaultLogger.hpp>
#include <assimp/Importer.hpp>
#include <assimp/LogStream.hpp>
#include <new>

#include "measure/formats/foreign_checks.h"
#include "measure/formats/readers.h"

namespace gnomon::importing {
namespace {

/// Files that an import names are files: a pipe, or a device, may never end.
class RegularFiles : public Assimp::DefaultIOSystem {
 public:
  explicit RegularFiles(const ReadFile& read) : read_(read) {}
  bool Exists(const char* name) const override {
    std::error_code code;
    return std::filesystem::is_regular_file(name, code);
  }
  Assimp::IOStream* Open(const char* name, const char*) override {
    if (!Exists(name)) return nullptr;
    const std::string bytes = read_(name);
    if (bytes.empty()) return nullptr;
    auto* copy = new std::uint8_t[bytes.size()];
    std::ranges::copy(bytes, copy);
    return new Assimp::MemoryIOStream(copy, bytes.size(), true);
  }

 private:
  const ReadFile& read_;
};

/// Assimp repairs some damage without a word but for its log (an index out of range is replaced): keep what is about indices.
class Complaints : public Assimp::LogStream {
 public:
  explicit Complaints(std::string& first) : first_(first) {}
  void write(const char* message) override {
    const std::string_view words = message;
    const auto speaks_of = [&](std::string_view what) { return words.find(what) != words.npos; };
    const bool is_error = words.starts_with("Error");
    if ((is_error && speaks_of("range")) || speaks_of("ertex index") || speaks_of("ndex overflow in MDL"))
      if (first_.empty()) first_ = message;
  }

 private:
  std::string& first_;
};

glm::dmat4 widened(const aiMatrix4x4& m) {
  glm::dmat4 wide;
  for (unsigned row = 0; row < 4; ++row)
    for (unsigned column = 0; column < 4; ++column) wide[static_cast<int>(column)][static_cast<int>(row)] = m[row][column];
  return wide;
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

void add_meshes(const aiScene& scene, const aiNode& node, const glm::dmat4& world_from_parent, MeshFile& answer) {
  const glm::dmat4 world_from_mesh = world_from_parent * widened(node.mTransformation);
  for (unsigned i = 0; i < node.mNumMeshes; ++i) {
    const aiMesh& mesh = *scene.mMeshes[node.mMeshes[i]];
    ImportedMesh& raw = answer.meshes.emplace_back();
    raw.name = mesh.mName.length > 0 ? mesh.mName.C_Str() : node.mName.C_Str();
    raw.places = {world_from_mesh};
    read_material(scene, mesh.mMaterialIndex, raw);
    raw.positions.reserve(mesh.mNumVertices);
    for (unsigned v = 0; v < mesh.mNumVertices; ++v)
      raw.positions.emplace_back(mesh.mVertices[v].x, mesh.mVertices[v].y, mesh.mVertices[v].z);
    raw.corner_counts.reserve(mesh.mNumFaces);
    raw.corners.reserve(std::size_t{3} * mesh.mNumFaces);
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) raw.add_face({mesh.mFaces[f].mIndices, mesh.mFaces[f].mNumIndices});
  }
  for (unsigned i = 0; i < node.mNumChildren; ++i) add_meshes(scene, *node.mChildren[i], world_from_mesh, answer);
}

}  // namespace

MeshFile read_by_assimp(const std::filesystem::path& file, const ReadFile& read) {
  check_foreign(file, read);
  MeshFile answer;
  std::string complaint;
  Assimp::DefaultLogger::create("", Assimp::Logger::NORMAL, 0);
  Assimp::DefaultLogger::get()->attachStream(new Complaints(complaint), Assimp::Logger::Err | Assimp::Logger::Warn);
  Assimp::Importer importer;
  importer.SetIOHandler(new RegularFiles(read));
  importer.SetPropertyBool(AI_CONFIG_IMPORT_NO_SKELETON_MESHES, true);
  // No post-processing: some of its steps abort on truncated files, and the importer checks and splits faces itself.
  const aiScene* scene = importer.ReadFile(file.string(), 0);
  if (!scene || !scene->mRootNode) {
    const std::string why = importer.GetErrorString();
    if (why.find("bad_alloc") != std::string::npos) throw std::bad_alloc();
    throw Error("{}: cannot be read: {}", file.string(), why);
  }
  if (!complaint.empty()) throw Error("{}: {}", file.string(), complaint);
  add_meshes(*scene, *scene->mRootNode, glm::dmat4(1), answer);
  answer.notes.emplace_back("the general importer assimp read it: what it left out or changed is not known");
  answer.note(scene->mNumLights + scene->mNumCameras,
              "lights and cameras are left out: of this format it is not known what they mean");
  return answer;
}

}  // namespace gnomon::importing
