// Records, masks, and what the program and its workers write for each other.
#include <gnomon/kit/pictures/surface_detail.h>

#include "fuzz.h"
#include "measure/cause/causes.h"
#include "measure/picture/detail_export.h"
#include "measure/picture/picture.h"
#include "measure/record/record.h"
#include "measure/scene/base_scene.h"
#include "measure/scene/blob.h"
#include "measure/scene/import.h"
#include "measure/scene/load.h"
#include "measure/scene/posed_scene.h"
#include "measure/worker/worker_client.h"
#include "run_words.h"

namespace fuzz {

using namespace gnomon;
namespace fs = std::filesystem;

namespace {

Scene small_scene() {
  Scene scene = load_scene("single_triangle");
  scene.meshes.resize(1);
  return scene;
}

Scene masked_scene() {
  Scene scene = small_scene();
  Mesh& mesh = scene.meshes[0];
  const std::vector<std::uint8_t> alpha = {0, 255, 90, 255, 0, 130};
  mesh.alpha_mask = std::make_shared<const AlphaMask>(3, 2, alpha, 0.9f, 0.5f, AlphaMask::Wrap::mirror, AlphaMask::Wrap::clamp);
  mesh.uv.resize(mesh.positions.size(), glm::vec2(0.25f, 1.5f));
  return scene;
}

/// One triangle with a skin and a morph target, and a track of each kind.
Scene moving_scene() {
  Scene scene = small_scene();
  const std::size_t count = scene.meshes[0].positions.size();
  Motion motion;
  motion.nodes.resize(3);
  motion.nodes[0].weights = {0};
  motion.nodes[2].parent = 1;
  motion.skins = {{{1, 2}, {glm::dmat4(1), glm::dmat4(1)}}};
  using Property = Track::Property;
  motion.animations = {{"go",
                        {{0, Property::weights, Track::Interpolation::linear, {0, 1}, {0, 1}},
                         {1, Property::translation, Track::Interpolation::step, {0, 1}, {0, 0, 0, 1, 0, 0}},
                         {2, Property::rotation, Track::Interpolation::linear, {0, 1}, {0, 0, 0, 1, 0, 1, 0, 0}},
                         {2, Property::scale, Track::Interpolation::cubic, {0}, {0, 0, 0, 1, 1, 1, 0, 0, 0}}}}};
  Rig rig{
      .node = 0, .skin = 0, .placement = {}, .base = {}, .targets = {}, .joints_per_vertex = 2, .joints = {}, .weights = {}};
  for (const glm::vec3& p : scene.meshes[0].positions) rig.base.emplace_back(p);
  rig.targets.assign(count, glm::dvec3(0, 1, 0));
  for (std::size_t v = 0; v < count; ++v) {
    rig.joints.insert(rig.joints.end(), {0, 1});
    rig.weights.insert(rig.weights.end(), {0.25, 0.75});
  }
  motion.rigs.push_back(std::move(rig));
  scene.motion = std::make_shared<const Motion>(std::move(motion));
  return scene;
}

/// Follows each of its animations, as a row does.
void go_along(Scene& scene) {
  PosedScene posed(scene);
  for (std::size_t a = 0; scene.motion && a < scene.motion->animations.size(); ++a)
    for (const double seconds : {0.0, 0.5}) {
      posed.go_to(RowPose{.animation = scene.motion->animations[a].name, .seconds = seconds, .frame_rate = 2, .frames = 2});
      posed.take_changes();
    }
  posed.go_to(std::nullopt);
}

/// What a worker hears that follows an animation: `open` is its first line.
std::string requests_along(const std::string& open) {
  Scene scene = moving_scene();
  PosedScene posed(scene);
  std::string lines = open + "\n";
  for (const double seconds : {0.0, 0.5}) {
    const RowPose at{.animation = "go", .seconds = seconds, .frame_rate = 2, .frames = 2};
    posed.go_to(at);
    const GoRequest go{.gbuffer = "small.gbuffer",
                       .width = 4,
                       .height = 4,
                       .truth = Truth::mesh,
                       .lights = {0},
                       .pose = WantedPose{at, posed.hash()}};
    lines += json_text(request_json(go)) + "\n";
    lines += json_text(request_json(TimeRequest{.stage = Stage::update})) + "\n";
    lines += json_text(request_json(MaskRequest{.mask = "w.mask"})) + "\n";
  }
  return lines;
}

std::string small_answer() {
  importing::MeshFile file;
  importing::ImportedMesh& mesh = file.meshes.emplace_back();
  mesh.name = "m";
  mesh.has_color = true;
  mesh.places = {glm::dmat4(1)};
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};
  mesh.add_triangle(0, 1, 2);
  mesh.add_face(std::array{0u, 1u, 3u, 2u});
  file.cameras.push_back({.name = "eye", .eye = {0, 0, 5}, .fov_y = 0.7});
  file.lights.push_back({.name = "sun", .kind = importing::ImportedLightKind::directional});
  file.lights.push_back(
      {.name = "spot", .kind = importing::ImportedLightKind::spot, .position = {0, 5, 0}, .inner = 0.2, .outer = 0.4});
  FieldWriter writer;
  importing::visit_file(writer, std::as_const(file));
  return text_of(writer.bytes);
}

/// A strip with a skin, a morph target and a mesh that turns.
std::string moving_answer() {
  importing::MeshFile file;
  file.motion.nodes.resize(3);
  file.motion.nodes[0].weights = {0.5};
  file.motion.nodes[2].parent = 1;
  file.motion.skins.push_back({.joints = {1, 2}, .inverse_bind = {glm::dmat4(1), glm::dmat4(1)}});
  const auto track = [](std::uint32_t node, Track::Property property, std::vector<double> values) {
    return Track{.node = node, .property = property, .times = {0, 1}, .values = std::move(values)};
  };
  file.motion.animations.push_back(
      {.name = "bend",
       .tracks = {track(0, Track::Property::weights, {0, 1}), track(1, Track::Property::rotation, {0, 0, 0, 1, 0, 0.6, 0, 0.8}),
                  track(2, Track::Property::translation, {0, 0, 0, 0, 1, 0})}});
  for (const bool has_skin : {true, false}) {
    importing::ImportedMesh& mesh = file.meshes.emplace_back();
    mesh.name = has_skin ? "strip" : "sheet";
    mesh.places = {glm::dmat4(1)};
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh.add_triangle(0, 1, 2);
    mesh.nodes = {has_skin ? 0u : 2u};
    if (!has_skin) continue;
    mesh.skin = 0;
    mesh.targets = {{0, 0, 1}, {0, 0, 0}, {0, 0, 2}};
    mesh.joints_per_vertex = 2;
    mesh.joints = {0, 1, 0, 1, 1, 0};
    mesh.weights = {0.25, 0.75, 1, 0, 1, 0};
  }
  FieldWriter writer;
  importing::visit_file(writer, std::as_const(file));
  return text_of(writer.bytes);
}

std::string small_explanations() {
  Explanation why;
  why.taps = {Tap{.origin = {0, 5, 0}, .direction = {0, -1, 0}, .weight = 0.5, .stored = 2}};
  why.shifted = glm::dvec3(1, 2, 3);
  why.element = 7;
  return text_of(explanation_bytes(std::vector<std::optional<Explanation>>{why, std::nullopt, Explanation{}}));
}

std::string small_detail() {
  return text_of(detail_bytes(
      {.corners = {{0, 0, 0}, {1, 0, 0}, {0, 0, 1}, {1, 0, 1}}, .polygons = {{0, 0, true, 0, 3}, {0, 0, false, 1, 3}}}));
}

}  // namespace

Outcome read_records_of_run(const fs::path& file, const std::string& bytes) {
  const fs::path run = file.parent_path() / "run";
  fs::create_directories(run);
  fs::rename(file, records_file(run));
  const RecordFile contents = read_record_file(records_file(run));
  static const std::vector<std::vector<std::string>> uses = {{"table"},
                                                             {"table", "--format", "csv"},
                                                             {"table", "--format", "tex"},
                                                             {"table", "--format", "json"},
                                                             {"table", "--format", "md"},
                                                             {"analyze", "front"},
                                                             {"analyze", "best", "--times", "1,10"},
                                                             {"analyze", "rank"},
                                                             {"analyze", "map"},
                                                             {"analyze", "growth"},
                                                             {"analyze", "sweep"},
                                                             {"analyze", "motion"},
                                                             {"compare"},
                                                             {"report", "--no-pictures"},
                                                             {"figure", "front", "--script"},
                                                             {"figure", "bars", "--script"}};
  std::vector<std::string> words = uses[std::hash<std::string>()(bytes) % uses.size()];
  words.insert(words.begin() + 1, run.string());
  if (words[0] == "compare") words.push_back(run.string());
  run_words(std::move(words));
  return contents.records.empty() ? Outcome::refused : Outcome::accepted;
}

Outcome read_words(const fs::path&, const std::string& bytes) {
  std::vector<std::string> words;
  for (std::size_t at = 0, end = 0; end != bytes.npos; at = end + 1) {
    end = bytes.find('\n', at);
    words.push_back(bytes.substr(at, end - at));
    words.back().resize(std::min(words.back().find('\0'), words.back().size()));
  }
  // Nothing may run or be written: what does neither is called as it is, the rest with a word that no command takes.
  if (words[0] == "run")
    words.insert(words.begin() + 1, "--dry-run");
  else if (words[0] != "list" && words[0] != "describe")
    words.insert(words.begin() + 1, "--no-command-takes-this");  // at the end it could be an option's value
  return run_words(std::move(words));
}

Outcome read_mask(const fs::path& file, const std::string&) {
  const auto [width, height] = image_files().exr_size(file);
  const std::vector<std::string> channels = image_files().exr_channels(file);
  for (std::size_t c = 0; c < std::min<std::size_t>(channels.size(), 4); ++c)
    image_files().read_exr(file, channels[c], width, height);
  return Outcome::accepted;
}

Outcome read_blob(const fs::path& file, const std::string& bytes) {
  const auto span = std::as_bytes(std::span(bytes));
  if (file.extension() == ".why") {
    explanations_from_bytes(span);
  } else if (file.extension() == ".detail") {
    const Scene scene = small_scene();
    const SurfaceDetail detail = detail_from_bytes(span);
    check_detail(scene, detail);
    detail_obj(scene, detail, {}, "a.mtl");
  } else {
    Scene scene = scene_from_bytes(span);
    finish_scene(scene, file.string());
    go_along(scene);
  }
  return Outcome::accepted;
}

std::vector<Input> written_seeds(const std::string& kind, const fs::path& scratch) {
  if (kind == "answer") return {{0, "small.answer", small_answer()}, {0, "moving.answer", moving_answer()}};
  if (kind == "blob")
    return {{0, "small.scene", text_of(scene_bytes(small_scene()))},
            {0, "masked.scene", text_of(scene_bytes(masked_scene()))},
            {0, "moving.scene", text_of(scene_bytes(moving_scene()))},
            {0, "small.why", small_explanations()},
            {0, "small.detail", small_detail()}};
  if (kind == "requests") {  // what the requests of the seeds name
    write_file(scratch / "small.scene", scene_bytes(small_scene()));
    write_file(scratch / "moving.scene", scene_bytes(moving_scene()));
    write_file(scratch / "small.light_and_view", light_and_view_bytes(small_scene().lights.at(0), small_scene().views.at(0)));
    std::vector<float> pixels(std::size_t{8} * 16, 0.1f);  // of 4x4, all on triangle 0 of mesh 0
    std::fill(pixels.begin() + 16 * 6, pixels.end(), 0.0f);
    write_file(scratch / "small.gbuffer", std::as_bytes(std::span(pixels)));
    const std::vector<std::uint32_t> places = {0, 5, 15};
    write_file(scratch / "small.pixels", std::as_bytes(std::span(places)));
    const OpenRequest open{.scene = "moving.scene", .technique = "embree_rays", .settings = ""};
    return {{0, "along.lines", requests_along(json_text(request_json(open)))}};
  }
  return {};
}

}  // namespace fuzz
