// A record with every field, for the tests of records.
#pragma once

#include <string>

#include "measure/record/record.h"

namespace record_example {

inline gnomon::Record example(const std::string& job = "00ff") {
  using namespace gnomon;
  Record r;
  r.job = job;
  r.suite = "quick";
  r.scene = "soup:ground=false";
  r.light = "point";
  r.light_kind = "point";
  r.view = "main";
  r.technique = "shadow_map";
  r.settings = "resolution=256";
  r.label = "small map";
  r.parameters = {{"resolution", 256}, {"filter", "nearest"}};
  r.width = 640;
  r.height = 480;
  r.truth = Truth::mesh;
  r.path = "camera_slide";
  r.place = 17;
  r.status = Status::ok;
  r.support = Support::Kind::approximate;
  r.reason = "one face of the cube";
  r.times(Stage::setup) = {{12.5}, {13}};
  r.times(Stage::resolve) = {{0.1, 0.2, 0.30000000000000004}, {1e-3, 2, 3}};
  r.device_times(Stage::resolve) = {{0.05, 0.1, 0.15}};
  r.harness_times(Stage::build) = {{2.5}, {3.5}};
  r.iterations = {{"resolve", 7}};
  r.stop = "target";
  r.counts = {{"texels", 65536, "texel"}};
  r.bytes = 262144;
  r.peak_bytes = 8589934592;  // beyond 32 bits
  Record::FloorTimes& floor = r.floor.emplace();
  floor.pass = "depth_draw";
  floor.ms = {{0.5, 0.25}, {0.75}};
  floor.device_ms = {{0.125}};
  r.gl = GlInputs{.input_bytes = 1000, .upload_ms = 0.25, .geometry_bytes = 36, .loose_bytes = 0};
  r.classes = {{"B", 10}, {"T", 307190}};
  r.metrics[Truth::mesh] = {{"wrong_rate", 1.0 / 3}, {"displacement_mean", std::nullopt}};
  r.metrics[Truth::shape] = {{"wrong_rate", 0.0}};
  r.causes = {{"acne", 3}, {"crack", 0}, {"off_screen", 2}};
  r.own_causes = {{"off_screen", "What casts the shadow is out of the picture.", {252, 0, 132}}};
  r.frames = {{"wrong_rate", {0.5, std::nullopt, 1.0 / 3}}};
  r.mask = "masks/00ff.exr";
  Record::LightFacts& light = r.lights.emplace_back();
  light.name = light.kind = "point";
  light.support = Support::Kind::approximate;
  light.classes = r.classes;
  light.metrics = r.metrics[Truth::mesh];
  light.causes = r.causes;
  r.scene_facts = Record::SceneFacts{.meshes = 2, .triangles = 12, .closed = true};
  r.notes = {"framing camera"};
  r.context = {{"processor", "an abacus"}, {"threads", 2}};
  r.seconds = 1.5;
  return r;
}

}  // namespace record_example
