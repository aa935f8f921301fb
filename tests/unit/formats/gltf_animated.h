#pragma once
// glTF files with animations, for tests.
#include "formats/gltf_made.h"

namespace gnomon::gltf_made {

/// A file with the unit square and one animation without channels.
struct Animated : Gltf {
  Animated() {
    add_square();
    primitive()["mode"] = 5;
    json["animations"] = parse_json(R"([{"channels":[],"samplers":[]}])");
  }
  Json& sampler(std::size_t index = 0) { return json["animations"][0]["samplers"][index]; }
  Json& channel(std::size_t index = 0) { return json["animations"][0]["channels"][index]; }
  /// Adds a channel with a sampler of its own to an animation.
  template <class T>
  void add(int node, const char* path, const std::vector<float>& times, const std::vector<T>& values, const char* interpolation,
           std::size_t animation = 0) {
    const std::string name = path;
    const std::size_t width = name == "rotation" ? 4 : name == "weights" ? 1 : 3;
    const char* const type = width == 4 ? "VEC4" : width == 3 ? "VEC3" : "SCALAR";
    Json& owner = json["animations"][animation];
    Json made = json_object({{"input", accessor(times, "SCALAR", 1)}, {"output", accessor(values, type, width)}});
    made["interpolation"] = interpolation;
    Json target = json_object({{"node", node}, {"path", path}});
    owner["channels"].push_back(json_object({{"sampler", owner["samplers"].size()}, {"target", target}}));
    owner["samplers"].push_back(made);
  }
  /// Node 0 goes from 0 to 1 along x within a second.
  void add_step() { add(0, "translation", {0, 1}, std::vector<float>{0, 0, 0, 1, 0, 0}, "LINEAR"); }
  /// A morph target that lifts each corner by its number, and 8 more.
  void add_target() {
    const std::size_t target = accessor(std::vector<float>{0, 0, 8, 0, 0, 9, 0, 0, 10, 0, 0, 11}, "VEC3", 3);
    if (!primitive().contains("targets")) primitive()["targets"] = Json::array();
    primitive()["targets"].push_back(json_object({{"POSITION", target}}));
  }
  /// Joints and weights of the four corners.
  void add_set(int set, const std::vector<std::uint8_t>& joints, const std::vector<float>& weights) {
    primitive()["attributes"][fmt::format("JOINTS_{}", set)] = accessor(joints, "VEC4", 4);
    primitive()["attributes"][fmt::format("WEIGHTS_{}", set)] = accessor(weights, "VEC4", 4);
  }
};

/// A mesh with a skin of the nodes 1 and 2; the second moves.
inline Animated skinned() {
  Animated file;
  file.json["nodes"] = parse_json(R"([{"mesh":0,"skin":0},{"translation":[10,0,0],"children":[2]},{"translation":[0,10,0]}])");
  file.json["scenes"][0]["nodes"] = parse_json("[0,1]");
  file.json["skins"] = parse_json(R"([{"joints":[2,1]}])");
  file.add_set(0, {0, 0, 9, 9, 1, 0, 0, 0, 0, 1, 0, 0, 1, 0, 0, 0}, {1, 0, 0, 0, 1, 0, 0, 0, .5, .5, 0, 0, 1, 0, 0, 0});
  file.add(2, "scale", {0, 2}, std::vector<float>{1, 1, 1, 2, 2, 2}, "LINEAR");
  return file;
}

}  // namespace gnomon::gltf_made
