#pragma once
#include <gnomon/plugins.h>

#include "measure/worker/protocol.h"

// Requests about techniques and scenes, before any of them is opened.

namespace gnomon {

/// All but `path`, which the program has.
void for_each_field(MaybeConst<PluginFacts> auto& r, const auto& use) {
  use("file", r.file, "build_type", r.build_type, "flags", r.flags, "compiler", r.compiler);
  use("is_optimized", r.is_optimized);
}

/// Loads a plugin and lists what it contains, by data sheets alone.
struct LoadRequest {
  static constexpr const char* verb = "load";
  std::string plugin = {};
  struct Reply {
    std::optional<std::string> refused = {};  ///< why it cannot be loaded
    std::vector<Json> techniques, scenes;     ///< sheet_json
    std::optional<PluginFacts> facts = {};
  };
};
void for_each_field(MaybeConst<LoadRequest> auto& r, const auto& use) { use("plugin", r.plugin); }
void for_each_field(MaybeConst<LoadRequest::Reply> auto& r, const auto& use) {
  use("refused", r.refused, "techniques", r.techniques, "scenes", r.scenes, "facts", r.facts);
}

/// Makes an object of a technique, or of a scene, and describes it.
struct DescribeRequest {
  static constexpr const char* verb = "describe";
  std::optional<std::string> technique, scene;
  struct Reply {
    Json object;  ///< object_json
  };
};
void for_each_field(MaybeConst<DescribeRequest> auto& r, const auto& use) { use("technique", r.technique, "scene", r.scene); }
void for_each_field(MaybeConst<DescribeRequest::Reply> auto& r, const auto& use) { use("object", r.object); }

struct KnownLightsRequest {
  static constexpr const char* verb = "known_lights";
  std::string technique = {};
  struct Reply {
    std::vector<std::string> lights = {};
  };
};
void for_each_field(MaybeConst<KnownLightsRequest> auto& r, const auto& use) { use("technique", r.technique); }
void for_each_field(MaybeConst<KnownLightsRequest::Reply> auto& r, const auto& use) { use("lights", r.lights); }

struct MakeSceneRequest {
  static constexpr const char* verb = "make_scene";
  std::string scene, settings, out;  ///< out: a file for scene_bytes
  using Reply = Done;
};
void for_each_field(MaybeConst<MakeSceneRequest> auto& r, const auto& use) {
  use("scene", r.scene, "settings", r.settings, "out", r.out);
}

/// A technique's support of every light of a scene under its first view.
struct SupportsRequest {
  static constexpr const char* verb = "supports";
  std::string scene, technique, settings;
  struct Reply {
    std::vector<SupportReply> lights = {};
  };
};
void for_each_field(MaybeConst<SupportsRequest> auto& r, const auto& use) {
  use("scene", r.scene, "technique", r.technique, "settings", r.settings);
}
void for_each_field(MaybeConst<SupportsRequest::Reply> auto& r, const auto& use) { use("lights", r.lights); }

}  // namespace gnomon
