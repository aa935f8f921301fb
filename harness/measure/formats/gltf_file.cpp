// Source: Khronos, glTF 2.0 specification (ISO/IEC 12113:2022).
#include "measure/formats/gltf_file.h"

#include <algorithm>

#include "measure/counted.h"
#include "measure/formats/readers.h"
#include "measure/formats/text_lines.h"

namespace gnomon::importing {
namespace {

namespace fs = std::filesystem;

/// What a file may require: extensions that are read, and those that change materials and textures alone. So do all whose names
/// begin with `material_family`.
constexpr std::string_view known_extensions[] = {"KHR_lights_punctual",   "KHR_mesh_quantization", "EXT_mesh_gpu_instancing",
                                                 "KHR_texture_transform", "KHR_texture_basisu",    "EXT_texture_webp",
                                                 "EXT_texture_avif",      "MSFT_texture_dds",      "KHR_node_visibility",
                                                 "KHR_techniques_webgl",  "KHR_animation_pointer", "KHR_xmp",
                                                 "KHR_xmp_json_ld"};
constexpr std::string_view material_family = "KHR_materials_";

}  // namespace

std::string from_base64(const std::string& where, std::string_view text) {
  std::string bytes;
  bytes.reserve(text.size() / 4 * 3);
  std::uint32_t bits = 0, held = 0;
  while (text.ends_with('=')) text.remove_suffix(1);
  for (const char c : text) {
    const int value = c >= 'A' && c <= 'Z'                 ? c - 'A'
                      : c >= 'a' && c <= 'z'               ? c - 'a' + 26
                      : c >= '0' && c <= '9'               ? c - '0' + 52
                      : c == '+' || c == '-'               ? 62
                      : c == '/' || c == '_'               ? 63
                      : c == ' ' || c == '\n' || c == '\r' ? -2
                                                           : -1;
    if (value == -2) continue;
    if (value < 0) throw Error("{}: byte {:#04x} of its data is no base64", where, static_cast<unsigned char>(c));
    bits = bits << 6 | static_cast<std::uint32_t>(value);
    held += 6;
    if (held >= 8) bytes.push_back(static_cast<char>(bits >> (held -= 8)));
  }
  return bytes;
}

std::string percent_decoded(std::string_view uri) {
  std::string text;
  const auto digit = [](char c) {
    return c >= '0' && c <= '9' ? c - '0' : c >= 'a' && c <= 'f' ? c - 'a' + 10 : c >= 'A' && c <= 'F' ? c - 'A' + 10 : -1;
  };
  for (std::size_t i = 0; i < uri.size(); ++i) {
    const bool is_coded = uri[i] == '%' && i + 2 < uri.size() && digit(uri[i + 1]) >= 0 && digit(uri[i + 2]) >= 0;
    text.push_back(is_coded ? static_cast<char>(16 * digit(uri[i + 1]) + digit(uri[i + 2])) : uri[i]);
    if (is_coded) i += 2;
  }
  return text;
}

std::optional<std::string> bytes_in_address(const std::string& where, std::string_view uri) {
  if (!same_word(uri.substr(0, 5), "data:")) return {};
  const std::size_t comma = uri.find(',');
  if (comma == uri.npos || !uri.substr(0, comma).ends_with(";base64")) throw Error("{} holds data that are not base64", where);
  return from_base64(where, percent_decoded(uri.substr(comma + 1)));
}

fs::path file_beside(const fs::path& file, const std::string& uri) {
  std::error_code code;
  const fs::path path = file.parent_path() / percent_decoded(uri), raw = file.parent_path() / uri;
  return !fs::exists(path, code) && fs::exists(raw, code) ? raw : path;
}

GltfFile::GltfFile(const fs::path& file, const ReadFile& read) : name_(file.string()) {
  open(file, read);
  if (!is_version_1_) check_version();
  if (is_version_1_) return;
  check_extensions();
  read_buffers(file, read);
}

/// GLB: "glTF", version, length; then chunks of a length, a name and so many bytes.
void GltfFile::open(const fs::path& file, const ReadFile& read) {
  const std::string bytes = read(file);
  if (!bytes.starts_with("glTF")) {
    if (lower(file.extension().string()) == ".glb") throw Error("{}: has no GLB header", name_);
    json_ = parse_json(std::string(without_byte_order_mark(name_, bytes)), "extras");
    return;
  }
  if (bytes.size() < 20) throw Error("{}: is {} bytes long; a GLB has at least 20", name_, bytes.size());
  if (word_at(bytes, 4) < 2) return void(is_version_1_ = true);
  if (word_at(bytes, 4) > 2) throw Error("{}: is GLB of version {}; 2 is read", name_, word_at(bytes, 4));
  const std::size_t size = word_at(bytes, 8);
  if (bytes.size() < size) throw Error("{}: is {} bytes long but declares {}; it is truncated", name_, bytes.size(), size);
  if (bytes.size() > size) notes_.push_back(counted(bytes.size() - size, "byte{s} after its end {is|are} left out"));
  std::size_t unknown = 0;
  for (std::size_t at = 12, chunk = 0; at + 8 <= size; ++chunk) {
    const std::size_t length = word_at(bytes, at);
    if (length > size - at - 8)
      throw Error("{}: chunk {} of {} bytes ends after the file; it is truncated", name_, chunk, length);
    const std::string_view rest = std::string_view(bytes).substr(at + 4), kind = rest.substr(0, 4),
                           body = rest.substr(4, length);
    if (chunk == 0 && kind != "JSON") throw Error("{}: its first chunk is not JSON", name_);
    if (chunk == 0) {
      json_ = parse_json(std::string(body), "extras");
    } else if (kind == std::string_view("BIN\0", 4) && !has_binary_) {
      binary_ = body;
      has_binary_ = true;
    } else {
      ++unknown;
    }
    at += 8 + length;
  }
  if (unknown > 0) notes_.push_back(counted(unknown, "chunk{s} of another kind than JSON and BIN {is|are} left out"));
}

void GltfFile::check_version() {
  if (!json_.is_object()) throw Error("{}: is not sound glTF: its JSON is no object", name_);
  // Version 1 need not name its version, and has objects where 2 has lists.
  const bool has_objects = object_in(json_, "nodes");
  const Json* asset = object_in(json_, "asset");
  if (!asset && has_objects) return void(is_version_1_ = true);
  if (!asset) throw Error("{}: has no 'asset' with a version; glTF 2.0 is read", name_);
  const std::string version = asset->contains("version") ? plain_text(asset->at("version")) : "",
                    least = text(*asset, "minVersion");
  is_version_1_ = version.starts_with("1.") || version == "1" || (version.empty() && has_objects);
  if (!is_version_1_ && !version.starts_with("2.") && version != "2")
    throw Error("{}: is glTF of version '{}'; 2.0 is read", name_, version);
  if (!least.empty() && least != "2.0") throw Error("{}: needs a reader of glTF {} (minVersion); 2.0 is read", name_, least);
}

void GltfFile::check_extensions() const {
  for (const Json& required : json_.value("extensionsRequired", Json::array())) {
    const std::string extension = plain_text(required);
    if (std::ranges::find(known_extensions, extension) == std::end(known_extensions) && !extension.starts_with(material_family))
      throw Error("{}: requires the extension '{}', which is not read; those that are: {}", name_, extension,
                  joined(known_extensions));
  }
}

void GltfFile::read_buffers(const fs::path& file, const ReadFile& read) {
  for (std::size_t b = 0; b < count("buffers"); ++b) {
    const std::string where = fmt::format("buffer {}", b);
    const Json& buffer = item("buffers", b);
    const std::string uri = text(buffer, "uri");
    const std::size_t size = index(buffer, where, "byteLength").value_or(0);
    std::string& bytes = buffers_.emplace_back();
    if (auto data = bytes_in_address(fmt::format("{}: {}", name_, where), uri)) {
      bytes = std::move(*data);
    } else if (!uri.empty()) {
      std::error_code code;
      const fs::path path = file_beside(file, uri);
      if (!fs::is_regular_file(path, code))
        throw Error("{}: its buffer {} {}", name_, path.string(),
                    fs::exists(path, code) ? "is no regular file" : "does not exist");
      bytes = read(path);
    } else if (b == 0 && has_binary_) {
      bytes = std::move(binary_);
    } else {
      continue;  // extensions may fill it: an error where it is read
    }
    if (bytes.size() < size)
      throw Error("{}: {} holds {} bytes but declares {}; it is truncated", name_, where, bytes.size(), size);
    bytes.resize(size);
  }
}

std::size_t GltfFile::count(const char* list) const {
  const auto found = json_.find(list);
  if (found == json_.end()) return 0;
  if (!found->is_array()) throw Error("{}: '{}' is no list", name_, list);
  return found->size();
}

const Json& GltfFile::item(const char* list, std::size_t index) const {
  if (index >= count(list)) throw Error("{}: names item {} of '{}', which has {}", name_, index, list, count(list));
  const Json& item = json_.at(list).at(index);
  if (!item.is_object()) throw Error("{}: item {} of '{}' is no object", name_, index, list);
  return item;
}

const Json* GltfFile::extension_of(const Json& owner, const char* extension) const {
  const Json* all = object_in(owner, "extensions");
  return all ? object_in(*all, extension) : nullptr;
}

std::optional<std::size_t> GltfFile::index(const Json& owner, const std::string& where, const char* key) const {
  const auto found = owner.find(key);
  if (found == owner.end()) return {};
  if (!found->is_number_unsigned())
    throw Error("{}: {}: {} = {} is not a whole number, 0 or more", name_, where, key, json_text(*found));
  return found->get<std::size_t>();
}

std::vector<double> GltfFile::numbers(const Json& owner, const std::string& where, const char* key, std::size_t size) const {
  const auto found = owner.find(key);
  if (found == owner.end()) return {};
  std::vector<double> values;
  const auto is_number = [](const Json& value) { return value.is_number(); };
  if (!found->is_array() || !std::ranges::all_of(*found, is_number) || (size > 0 && found->size() != size))
    throw Error("{}: {}: {} = {:.60} is no list of {}numbers", name_, where, key, json_text(*found),
                size > 0 ? fmt::format("{} ", size) : "");
  for (const Json& value : *found) values.push_back(value.get<double>());
  return values;
}

double GltfFile::number(const Json& owner, const std::string& where, const char* key, double otherwise) const {
  const auto found = owner.find(key);
  if (found == owner.end()) return otherwise;
  if (!found->is_number()) throw Error("{}: {}: {} = {} is no number", name_, where, key, json_text(*found));
  return found->get<double>();
}

std::string GltfFile::text(const Json& owner, const char* key) const {
  const auto found = owner.find(key);
  return found == owner.end() || !found->is_string() ? "" : found->get<std::string>();
}

}  // namespace gnomon::importing
