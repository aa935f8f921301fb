#pragma once
// Private to formats: a glTF file's JSON, its buffers, and the numbers that its accessors take from them.
#include <optional>

#include "measure/formats/mesh_file.h"
#include "measure/json.h"

namespace gnomon::importing {

/// Numbers of an accessor, `width` of them for each of `count` elements, normalized where it requires that.
struct Numbers {
  std::size_t count = 0, width = 1;
  std::vector<double> values;
  double at(std::size_t element, std::size_t k = 0) const { return values[element * width + k]; }
  glm::dvec3 vector(std::size_t element) const { return {at(element, 0), at(element, 1), at(element, 2)}; }
};

/// The object or the list of this key; null where there is none, or something else.
inline const Json* object_in(const Json& owner, const char* key) {
  const auto found = owner.find(key);
  return found != owner.end() && found->is_object() ? &*found : nullptr;
}
inline const Json* list_in(const Json& owner, const char* key) {
  const auto found = owner.find(key);
  return found != owner.end() && found->is_array() ? &*found : nullptr;
}
/// The truth value of this key; `otherwise` where there is none.
inline bool flag_in(const Json& owner, const char* key, bool otherwise) {
  const auto found = owner.find(key);
  return found != owner.end() && found->is_boolean() ? found->get<bool>() : otherwise;
}

/// Opens and checks the file: version, required extensions, sizes of buffers. Throws Json::exception on what is no JSON or not
/// of its form, and Error, which names the file and the element, on everything else.
class GltfFile {
 public:
  GltfFile(const std::filesystem::path& file, const ReadFile& read);

  const std::string& name() const { return name_; }
  /// Of version 1, which has another layout; then nothing else is read.
  bool is_version_1() const { return is_version_1_; }
  const std::vector<std::string>& notes() const { return notes_; }

  /// How many items the list of this key has at the top.
  std::size_t count(const char* list) const;
  /// One of them. Throws Error where there is none of this number.
  const Json& item(const char* list, std::size_t index) const;
  /// The object of an extension, of the root or of one of the items; null without it.
  const Json* extension_of(const Json& owner, const char* extension) const;

  /// A whole number, 0 or more, below an owner ("node 3") that may lack it.
  std::optional<std::size_t> index(const Json& owner, const std::string& where, const char* key) const;
  /// The numbers of a list; nothing where there is none. Throws Error unless there are `size` of them (any number for 0).
  std::vector<double> numbers(const Json& owner, const std::string& where, const char* key, std::size_t size) const;
  double number(const Json& owner, const std::string& where, const char* key, double otherwise) const;
  std::string text(const Json& owner, const char* key) const;
  const Json& root() const { return json_; }

  /// The numbers of an accessor that must have this many for each element.
  Numbers read(std::size_t accessor, std::size_t width) const;
  /// Of whole numbers without sign: indices, joints. The largest number of its type goes to `largest`.
  Numbers read_indices(std::size_t accessor, std::size_t width, double& largest) const;
  /// The bytes of a buffer view.
  std::string_view bytes(std::size_t view) const;

 private:
  struct Layout;
  Layout layout(std::size_t accessor, std::size_t width) const;
  std::string_view view(std::size_t index, std::size_t& stride) const;
  void fill(const Layout& layout, std::string_view bytes, std::size_t stride, std::size_t count, double* values) const;
  void read_sparse(const Json& sparse, const Layout& layout, Numbers& numbers) const;
  void open(const std::filesystem::path& file, const ReadFile& read);
  void check_version();
  void check_extensions() const;
  void read_buffers(const std::filesystem::path& file, const ReadFile& read);

  std::string name_;
  bool is_version_1_ = false;
  Json json_;
  std::string binary_;  ///< of a GLB
  bool has_binary_ = false;
  std::vector<std::string> buffers_;
  std::vector<std::string> notes_;
};

/// The bytes of a data URI or of base64 text. Throws Error, opening with `where`.
std::string from_base64(const std::string& where, std::string_view text);
/// "my buf.bin" of "my%20buf.bin".
std::string percent_decoded(std::string_view uri);
/// The bytes of a data URI; nothing where the address is another. Throws Error, opening with `where`.
std::optional<std::string> bytes_in_address(const std::string& where, std::string_view uri);
/// The file that an address names, beside `file`.
std::filesystem::path file_beside(const std::filesystem::path& file, const std::string& uri);

}  // namespace gnomon::importing
