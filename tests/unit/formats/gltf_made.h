#pragma once
// Small glTF files that tests build up and read.
#include <gtest/gtest.h>

#include <string>
#include <type_traits>
#include <vector>

#include "measure/formats/mesh_file.h"
#include "measure/json.h"

namespace gnomon::gltf_made {

inline std::string base64(std::string_view bytes) {
  const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t bits = 0;
    const std::size_t left = std::min<std::size_t>(3, bytes.size() - i);
    for (std::size_t k = 0; k < 3; ++k) bits = bits << 8 | (k < left ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k) text += k <= left ? digits[bits >> (18 - 6 * k) & 63] : '=';
  }
  return text;
}

/// A file that is built up: one buffer, one view for each accessor.
struct Gltf {
  Json json = parse_json(R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
    "meshes":[{"primitives":[{"attributes":{}}]}],"accessors":[],"bufferViews":[]})");
  std::string bytes;

  Json& primitive() { return json["meshes"][0]["primitives"][0]; }
  template <class T>
  std::size_t view(const std::vector<T>& values) {
    bytes.resize((bytes.size() + 3) / 4 * 4);
    json["bufferViews"].push_back(
        json_object({{"buffer", 0}, {"byteOffset", bytes.size()}, {"byteLength", values.size() * sizeof(T)}}));
    bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
    return json["bufferViews"].size() - 1;
  }
  template <class T>
  std::size_t accessor(const std::vector<T>& values, const char* type, std::size_t width) {
    const int component = std::is_same_v<T, float>           ? 5126
                          : std::is_same_v<T, std::uint32_t> ? 5125
                          : std::is_same_v<T, std::uint16_t> ? 5123
                          : std::is_same_v<T, std::int16_t>  ? 5122
                          : std::is_same_v<T, std::uint8_t>  ? 5121
                                                             : 5120;
    json["accessors"].push_back(json_object(
        {{"bufferView", view(values)}, {"componentType", component}, {"count", values.size() / width}, {"type", type}}));
    return json["accessors"].size() - 1;
  }
  /// Four corners of the unit square in z = 0: 00, 10, 01, 11.
  void add_square() {
    primitive()["attributes"]["POSITION"] = accessor(std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0}, "VEC3", 3);
  }
  importing::MeshFile read() {
    Json whole = json;
    whole["buffers"] = Json::array(
        {json_object({{"byteLength", bytes.size()}, {"uri", "data:application/octet-stream;base64," + base64(bytes)}})});
    return importing::read_mesh_file("a.gltf", [&](const std::filesystem::path&) { return json_text(whole); });
  }
  std::string error() {
    try {
      read();
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  }
};

inline void expect_words(const std::string& text, const std::vector<std::string>& words) {
  for (const std::string& word : words) EXPECT_NE(text.find(word), std::string::npos) << '"' << word << "\" in: " << text;
}

}  // namespace gnomon::gltf_made
