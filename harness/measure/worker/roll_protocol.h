#pragma once
#include "measure/worker/protocol.h"

// What is asked of techniques and scenes before any of them is opened.

namespace gnomon {

/// Loads a plugin and says what it has, by data sheets alone.
struct LoadRequest {
  static constexpr const char* verb = "load";
  std::string plugin = {};
  struct Reply {
    std::optional<std::string> refused = {};  ///< why it cannot be loaded
    std::vector<Json> techniques, scenes;     ///< sheet_json
    std::optional<Json> facts = {};           ///< PluginFacts
  };
};
void for_each_field(MaybeConst<LoadRequest> auto& request, const auto& use) { use("plugin", request.plugin); }
void for_each_field(MaybeConst<LoadRequest::Reply> auto& reply, const auto& use) {
  use("refused", reply.refused);
  use("techniques", reply.techniques);
  use("scenes", reply.scenes);
  use("facts", reply.facts);
}

/// Makes an object of a technique, or of a scene, and says what it is.
struct DescribeRequest {
  static constexpr const char* verb = "describe";
  std::optional<std::string> technique, scene;
  struct Reply {
    Json object;  ///< object_json
  };
};
void for_each_field(MaybeConst<DescribeRequest> auto& request, const auto& use) {
  use("technique", request.technique);
  use("scene", request.scene);
}
void for_each_field(MaybeConst<DescribeRequest::Reply> auto& reply, const auto& use) { use("object", reply.object); }

struct KnownLightsRequest {
  static constexpr const char* verb = "known_lights";
  std::string technique = {};
  struct Reply {
    std::vector<std::string> lights = {};
  };
};
void for_each_field(MaybeConst<KnownLightsRequest> auto& request, const auto& use) { use("technique", request.technique); }
void for_each_field(MaybeConst<KnownLightsRequest::Reply> auto& reply, const auto& use) { use("lights", reply.lights); }

struct MakeSceneRequest {
  static constexpr const char* verb = "make_scene";
  std::string scene, settings, out;  ///< out: a file for scene_bytes
  using Reply = Done;
};
void for_each_field(MaybeConst<MakeSceneRequest> auto& request, const auto& use) {
  use("scene", request.scene);
  use("settings", request.settings);
  use("out", request.out);
}

/// What a technique says of every light of a scene under its first view.
struct SupportsRequest {
  static constexpr const char* verb = "supports";
  std::string scene, technique, settings;
  struct Reply {
    std::vector<SupportReply> lights = {};
  };
};
void for_each_field(MaybeConst<SupportsRequest> auto& request, const auto& use) {
  use("scene", request.scene);
  use("technique", request.technique);
  use("settings", request.settings);
}
void for_each_field(MaybeConst<SupportsRequest::Reply> auto& reply, const auto& use) { use("lights", reply.lights); }

}  // namespace gnomon
