// The exact techniques against each other and against the reference, over random scenes, degenerate ones included.
//
// GNOMON_PIXELS=10000000 tests about that many pixels instead of the few of every day, and says what was seen; GNOMON_SEED=1
// makes other scenes.
#include <fmt/format.h>
#include <gnomon/kit/rays/rays.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdlib>

#include "degenerate_scenes.h"
#include "measure/frame/classify.h"

namespace gnomon::exact_agreement_test {

using questions::Case;
using questions::Question;

/// What a technique owes an answer.
enum class Owes {
  all,
  proper,  ///< not where the way to the light goes exactly through an edge or a vertex, and through nothing else
  clear  ///< nor within its own epsilon, where float32 cannot decide (class U), where a caster is all but edge-on, or where all
         ///< that blocks the light lies between the point and its own triangle
};

/// Whether rounding put the point behind its own triangle, as the light sees it, that triangle or a caster in its plane lies on
/// the way to the light, and so does nothing that is nearer to the light than this plane by more than epsilon.
bool is_behind_own_alone(const Case& c, const Question& question) {
  const glm::dvec4 light = homogeneous(c.light);
  const Receiver receiver = receiver_at(c.scene, c.picture.gbuffer, question.pixel);
  const Triangle own = c.scene.meshes[receiver.mesh].corners(receiver.triangle);
  const int of_light = orient3d_sign(own.points[0], own.points[1], own.points[2], light);
  if (orient3d_sign(own.points[0], own.points[1], own.points[2], receiver.point) != -of_light) return false;
  const glm::dvec3 from(receiver.point), way = to_light(light, from),
                                         up = static_cast<double>(of_light) * glm::normalize(own.normal());
  bool is_behind = false;
  for (const Mesh& mesh : c.scene.meshes)
    for (std::uint32_t t = 0; mesh.casts && t < mesh.triangles.size(); ++t) {
      const Triangle caster = mesh.corners(t);
      if (crosses({receiver.point, light}, caster) == Crossing::none) continue;
      if (receiver.is_coplanar(c.scene, caster.points)) {
        is_behind = true;
        continue;
      }
      const glm::dvec3 normal = caster.normal();
      const glm::dvec3 met = from + glm::dot(normal, glm::dvec3(caster.points[0]) - from) / glm::dot(normal, way) * way;
      if (glm::dot(up, met - glm::dvec3(own.points[0])) > 1e-10 * c.extent) return false;
    }
  return is_behind;
}

struct Contender {
  const char* id;
  Owes owes;
  std::unique_ptr<Technique> technique = {};
  std::string first_wrong = {};
  std::size_t asked = 0, wrong = 0, excused = 0, excused_wrong = 0;

  bool is_owed(const Case& c, const Question& question, PixelClass pixel_class, bool has_edge_on) const {
    if (owes != Owes::clear) return owes == Owes::all || !question.degenerate;
    return question.clear && pixel_class != PixelClass::U && !has_edge_on &&
           !(question.blocked && is_behind_own_alone(c, question));
  }
};

std::vector<Contender> contenders() {
  std::vector<Contender> all;
  const auto add = [&](const char* id, Owes owes) {
    all.push_back({.id = id, .owes = owes, .technique = registry().technique(id).make()});
    all.back().technique->setup();
  };
  for (const char* id : {"exact_rays", "alias_free_map", "shadow_volume_tree"}) add(id, Owes::all);
  for (const char* id : {"crow_counting", "two_pass_object"}) add(id, Owes::proper);
  add("svbsp", Owes::clear);
  return all;
}

/// Whether the light is within rounding of the plane of a caster.
bool has_edge_on(const Case& c) {
  const glm::dvec4 light = homogeneous(c.light);
  for (const Mesh& mesh : c.scene.meshes)
    for (std::uint32_t t = 0; mesh.casts && t < mesh.triangles.size(); ++t) {
      const Triangle caster = mesh.corners(t);
      const double scale = light.w != 0 ? c.extent : glm::length(glm::dvec3(light));
      if (std::abs(glm::dot(glm::normalize(caster.normal()), to_light(light, caster.points[0]))) < 1e-6 * scale) return true;
    }
  return false;
}

std::string place(const Case& c, int round, const Question& question) {
  const GBuffer& g = c.picture.gbuffer;
  const glm::vec3 p = g.position(question.pixel);
  const glm::dvec4 l = homogeneous(c.light);
  return fmt::format("round {}, extent {} m, {} light {} {} {}: mesh {}, triangle {} at {} {} {} should be {}{}", round,
                     c.extent, kind_name(c.light), l.x, l.y, l.z, g.mesh[question.pixel], g.triangle[question.pixel], p.x, p.y,
                     p.z, question.blocked ? "dark" : "lit", question.degenerate ? " by an edge" : "");
}

void compare(const Case& c, int round, std::span<const PixelClass> classes, Contender& contender) {
  Technique& technique = *contender.technique;
  ASSERT_TRUE(technique.supports(c.scene, c.light, c.picture.gbuffer.view));
  technique.build(c.scene);
  technique.relight(c.light);
  VisibilityMask mask(c.picture.gbuffer.width, c.picture.gbuffer.height);
  technique.resolve(c.picture.gbuffer, mask);
  const auto pixels = mask.read();
  const bool is_edge_on = has_edge_on(c);
  for (const Question& question : c.questions) {
    const bool is_wrong = (pixels[question.pixel] == 0) != question.blocked;
    if (!contender.is_owed(c, question, classes[question.pixel], is_edge_on)) {
      ++contender.excused;
      contender.excused_wrong += is_wrong;
      continue;
    }
    ++contender.asked;
    if (is_wrong && contender.wrong++ == 0) contender.first_wrong = place(c, round, question);
  }
}

/// Differences of the reference from the oracle by class.
struct Differences {
  std::array<std::size_t, 6> pixels = {}, wrong = {};

  /// Returns the classes.
  std::vector<PixelClass> add(const Case& c, int round) {
    const GBuffer& g = c.picture.gbuffer;
    const RayScene casters(c.scene, Truth::mesh, RayScene::Which::casters);
    std::vector<float> reference(g.size());
    trace_shadows(casters, c.scene, g, c.light, reference);
    const std::vector<PixelClass> classes = classify(c.scene, casters, g, c.light, reference, {});
    for (const Question& question : c.questions) {
      const auto k = static_cast<std::size_t>(classes[question.pixel]);
      ++pixels[k];
      if (is_lit(reference[question.pixel]) != question.blocked) continue;
      if (wrong[k]++ < 10 && classes[question.pixel] == PixelClass::T) ADD_FAILURE() << "T, " << place(c, round, question);
    }
    return classes;
  }
};

TEST(ExactTechniques, agree_with_each_other_and_differ_from_the_reference_in_class_u_alone) {
  const char* wanted = std::getenv("GNOMON_PIXELS");
  const std::size_t least = wanted ? std::strtoull(wanted, nullptr, 10) : 400'000;
  const char* seed = std::getenv("GNOMON_SEED");
  Random random(seed ? std::strtoull(seed, nullptr, 10) : 77);
  std::vector<Contender> all = contenders();
  Differences reference;
  std::size_t asked = 0, dark = 0;
  for (int round = 0; asked < least; ++round) {
    const auto c = degenerate_scenes::make(round, random);
    asked += c->questions.size();
    for (const Question& question : c->questions) dark += question.blocked;
    const std::vector<PixelClass> classes = reference.add(*c, round);
    for (Contender& contender : all) compare(*c, round, classes, contender);
  }
  std::string seen = fmt::format("{} pixels, {} dark\n", asked, dark);
  for (const Contender& contender : all) {
    EXPECT_EQ(contender.wrong, 0u) << contender.id << " of " << contender.asked << ", first " << contender.first_wrong;
    seen += fmt::format("{}: {} asked, {} wrong; {} not owed, {} of these answered otherwise\n", contender.id, contender.asked,
                        contender.wrong, contender.excused, contender.excused_wrong);
  }
  for (const PixelClass c : {PixelClass::G, PixelClass::S, PixelClass::U, PixelClass::T}) {
    const auto k = static_cast<std::size_t>(c);
    seen += fmt::format("reference, class {}: {} pixels, {} wrong\n", class_infos()[k].letter, reference.pixels[k],
                        reference.wrong[k]);
  }
  EXPECT_EQ(reference.wrong[static_cast<std::size_t>(PixelClass::T)], 0u);
  EXPECT_GT(dark, asked / 5);
  EXPECT_GT(asked - dark, asked / 5);
  if (wanted) fmt::print("{}", seen);
  RecordProperty("seen", seen);
}

}  // namespace gnomon::exact_agreement_test
