// Every vector of tests/data/hole_vectors.json, which tests/witness/make_hole_vectors computes a second time in rational
// numbers.
#include <gnomon/kit/geometry/holes.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "masked.h"
#include "places.h"

namespace gnomon::hole_vectors_test {

using nlohmann::json;
using Wrap = AlphaMask::Wrap;

const json& vectors() {
  static const json all = json::parse(std::ifstream(data_file("hole_vectors.json")));
  return all;
}

Wrap wrap_of(const json& item, const char* key) {
  const auto name = item.at(key).get<std::string>();
  return name == "repeat" ? Wrap::repeat : name == "mirror" ? Wrap::mirror : Wrap::clamp;
}

TEST(hole_vectors, bytes_that_are_solid) {
  for (const json& vector : vectors().at("bits")) {
    std::vector<std::uint8_t> bytes(256);
    for (int k = 0; k < 256; ++k) bytes[k] = static_cast<std::uint8_t>(k);
    const AlphaMask mask(256, 1, bytes, vector.at("factor").get<float>(), vector.at("cutoff").get<float>());
    for (int k = 0; k < 256; ++k) EXPECT_EQ(mask.is_solid(k, 0), k >= vector.at("first_solid").get<int>()) << k << vector;
  }
}

TEST(hole_vectors, texels_that_are_wrapped) {
  for (const json& vector : vectors().at("folds"))
    for (const char* name : {"repeat", "mirror", "clamp"}) {
      const Wrap wrap = wrap_of({{"wrap", name}}, "wrap");
      EXPECT_EQ(AlphaMask::wrapped(vector.at("texel").get<int>(), vector.at("size").get<int>(), wrap),
                vector.at(name).get<int>())
          << name << vector;
    }
}

TEST(hole_vectors, masks_made_finer) {
  for (const json& vector : vectors().at("scaled")) {
    const AlphaMask mask(vector.at("width").get<int>(), vector.at("height").get<int>(),
                         vector.at("alpha").get<std::vector<std::uint8_t>>(), 1.0f, 0.5f, wrap_of(vector, "wrap_u"),
                         wrap_of(vector, "wrap_v"), vector.at("scale").get<int>());
    const auto rows = vector.at("rows").get<std::vector<std::string>>();
    ASSERT_EQ(rows.size(), std::size_t(mask.height()));
    for (int y = 0; y < mask.height(); ++y)
      for (int x = 0; x < mask.width(); ++x)
        if (const char texel = rows[y].at(x); texel != '?') {
          EXPECT_EQ(mask.is_solid(x, y), texel == '#') << x << ' ' << y;
        }
  }
}

TEST(hole_vectors, segments_through_texels) {
  std::vector<std::shared_ptr<const AlphaMask>> masks;
  for (const json& item : vectors().at("masks")) {
    const auto rows = item.at("rows").get<std::vector<std::string>>();
    masks.push_back(masked::mask_of({rows.begin(), rows.end()}, wrap_of(item, "wrap_u"), wrap_of(item, "wrap_v")));
  }
  const auto three = [](const json& numbers) {
    return glm::vec3(numbers[0].get<float>(), numbers[1].get<float>(), numbers[2].get<float>());
  };
  for (const json& vector : vectors().at("segments")) {
    Mesh mesh;
    for (const json& corner : vector.at("corners")) mesh.positions.push_back(three(corner));
    for (const json& place : vector.at("uv")) mesh.uv.emplace_back(place[0].get<float>(), place[1].get<float>());
    mesh.triangles = {{0, 1, 2}};
    mesh.alpha_mask = masks.at(vector.at("mask").get<std::size_t>());
    const json& light = vector.at("light");
    const Segment segment{three(vector.at("point")), glm::dvec4(glm::dvec3(three(light)), light[3].get<double>())};
    EXPECT_NE(crosses(segment, mesh.corners(0)), Crossing::none) << vector;
    EXPECT_EQ(is_solid_at(mesh, 0, segment), vector.at("solid").get<bool>()) << vector;
    EXPECT_EQ(mesh.alpha_mask->is_solid_wrapped(vector.at("column").get<int>(), vector.at("row").get<int>()),
              vector.at("solid").get<bool>())
        << vector;
    const TexelPlace place = texel_place(mesh, 0, segment.point, segment.light);
    const glm::dvec3 way = glm::dvec3(segment.light) - segment.light.w * glm::dvec3(segment.point);
    const double rounding = texel_rounding(mesh, 0, way, extent(segment.point));
    EXPECT_LE(std::abs(place.x - vector.at("x").get<double>()), rounding) << vector;
    EXPECT_LE(std::abs(place.y - vector.at("y").get<double>()), rounding) << vector;
  }
}

}  // namespace gnomon::hole_vectors_test
