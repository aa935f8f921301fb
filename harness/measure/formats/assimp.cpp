// All formats that have no reader of their own, by assimp. Its losses are unknown, and the notes of the file say so.
#include <assimp/DefaultIOSystem.h>
#include <assimp/MemoryIOWrapper.h>
#include <assimp/config.h>
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/DefaultLogger.hpp>
#include <assimp/Importer.hpp>
#include <assimp/LogStream.hpp>
#include <glm/gtc/type_ptr.hpp>
#include <new>

#include "measure/formats/readers.h"
#include "measure/formats/text_lines.h"

namespace gnomon::importing {
namespace {

namespace fs = std::filesystem;

/// Opens regular files alone: a pipe or a device may never end.
class RegularFiles : public Assimp::DefaultIOSystem {
 public:
  explicit RegularFiles(const ReadFile& read) : read_(read) {}
  bool Exists(const char* name) const override {
    std::error_code code;
    return fs::is_regular_file(name, code);
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

/// Keeps the first complaint about indices: assimp repairs some damage, such as an index out of range, and reports it in its
/// log alone.
class Complaints : public Assimp::LogStream {
 public:
  explicit Complaints(std::string& first) : first_(first) {}
  void write(const char* message) override {
    const std::string_view words = message;
    const auto speaks_of = [&](std::string_view what) { return words.find(what) != words.npos; };
    const bool is_out_of_range = words.starts_with("Error") && speaks_of("range");
    if (first_.empty() && (is_out_of_range || speaks_of("ertex index") || speaks_of("ndex overflow in MDL"))) first_ = message;
  }

 private:
  std::string& first_;
};

/// Assimp stores rows one after the other.
glm::dmat4 widened(const aiMatrix4x4& m) { return glm::dmat4(glm::transpose(glm::make_mat4(&m.a1))); }

void read_material(const aiScene& scene, unsigned index, ImportedMesh& raw) {
  if (index >= scene.mNumMaterials) return;
  const aiMaterial& material = *scene.mMaterials[index];
  aiString name;
  aiColor4D color;
  // Importers invent a material of this name, or of none, for files without materials.
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

/// Chunks of a 3DS file: an id of 16 bits, a length of 32 bits that includes these six bytes, then the contents.
class Chunks {
 public:
  Chunks(const fs::path& file, std::string_view bytes) : file_(file), rest_(bytes) {}

  /// Whether there is one more; throws Error where it is longer than its container.
  bool next() {
    if (rest_.size() < header) return false;
    id_ = word_at(rest_, 0) & 0xffff;
    const std::size_t size = word_at(rest_, 2);
    if (size < header || size > rest_.size())
      throw Error("{}: chunk {:#x} of {} bytes lies in {} bytes; it is damaged", file_.string(), id_, size, rest_.size());
    body_ = rest_.substr(header, size - header);
    rest_.remove_prefix(size);
    return true;
  }
  std::uint32_t id() const { return id_; }
  std::string_view body() const { return body_; }
  Chunks inner() const { return {file_, body_}; }
  /// Of a list that follows a count of 16 bits.
  std::size_t count(std::size_t item_size) const {
    const std::size_t items = word_at(body_, 0) & 0xffff;
    if (body_.size() < 2 || items * item_size > body_.size() - 2)
      throw Error("{}: chunk {:#x} declares {} items in {} bytes; it is truncated", file_.string(), id_, items, body_.size());
    return items;
  }

 private:
  static constexpr std::size_t header = 6;
  const fs::path& file_;
  std::string_view rest_, body_;
  std::uint32_t id_ = 0;
};

/// A list of faces may precede that of the vertices.
void check_mesh(const std::string& where, Chunks chunks) {
  std::size_t vertex_count = 0, face_count = 0;
  std::string_view faces;
  while (chunks.next()) {
    if (chunks.id() == 0x4110) vertex_count = chunks.count(12);
    if (chunks.id() == 0x4120) {
      face_count = chunks.count(8);
      faces = chunks.body().substr(2);
    }
  }
  for (std::size_t f = 0; f < face_count; ++f)
    for (std::size_t k = 0; k < 3; ++k) need_vertex(where, f, word_at(faces, 8 * f + 2 * k) & 0xffff, vertex_count);
}

void check_3ds(const fs::path& file, std::string_view bytes) {
  if (bytes.size() < word_at(bytes, 2))  // the outermost chunk is the file
    throw Error("{}: is {} bytes long but declares {}; it is truncated", file.string(), bytes.size(), word_at(bytes, 2));
  Chunks top(file, bytes);
  if (!top.next() || top.id() != 0x4d4d) return;  // the importer refuses it
  for (Chunks main = top.inner(); main.next();) {
    if (main.id() != 0x3d3d) continue;
    for (Chunks editor = main.inner(); editor.next();) {
      if (editor.id() != 0x4000) continue;
      const std::size_t name = std::min(editor.body().find('\0'), editor.body().size());
      const std::string where = fmt::format("{}: mesh '{}'", file.string(), editor.body().substr(0, name));
      for (Chunks object(file, editor.body().substr(std::min(name + 1, editor.body().size()))); object.next();)
        if (object.id() == 0x4100) check_mesh(where, object.inner());
    }
  }
}

/// Finds damage that assimp does not see. Throws Error where a 3DS file is shorter than it declares or a face names a vertex
/// that is not there, and where an IFC file has no end: importers fill what is missing with what they read last, and mend
/// indices in silence.
void check_foreign(const fs::path& file, const ReadFile& read) {
  const std::string extension = lower(file.extension().string());
  if (extension == ".3ds") check_3ds(file, read(file));
  if (extension == ".ifc" && read(file).rfind("END-ISO-10303-21;") == std::string::npos)
    throw Error("{}: does not end in END-ISO-10303-21; it is truncated", file.string());
}

}  // namespace

MeshFile read_by_assimp(const fs::path& file, const ReadFile& read) {
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
              "{light or camera is|lights and cameras are} left out: of this format it is not known what {it means|they mean}");
  return answer;
}

}  // namespace gnomon::importing
