#pragma once
// An exact technique against the exact oracle: what it owes an answer, and where it answers otherwise.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <map>

#include "exact_techniques.h"
#include "questions.h"

namespace gnomon::exact_oracle {

/// What the oracle says of a picture. Scene, light and picture must outlive it.
class Answers {
 public:
  Answers(const Scene& scene, const Light& light, const GBuffer& gbuffer)
      : scene_(&scene), light_(homogeneous(light)), gbuffer_(&gbuffer), exact_(scene), answers_(gbuffer.size()) {
    limit_ = questions::unasked * extent(scene, light, gbuffer.view);
    ExactTally tally;
    for (std::size_t i = 0; i < answers_.size(); ++i)
      if (gnomon::faces_light(scene, gbuffer, light, i)) answers_[i] = exact_.occluded(receiver(i), light_, tally);
  }
  std::size_t size() const { return answers_.size(); }
  bool faces_light(std::size_t i) const { return answers_[i].has_value(); }
  /// Of a pixel that faces the light.
  const ExactAnswer& operator[](std::size_t i) const { return *answers_[i]; }
  /// What the mask must say: lit, where a pixel does not face the light.
  float visibility(std::size_t i) const { return answers_[i] && answers_[i]->blocked ? 0 : 1; }

  bool is_owed(Owes owes, std::size_t i) const {
    if (!answers_[i] || owes == Owes::all) return true;
    if (answers_[i]->degenerate || owes == Owes::proper) return !answers_[i]->degenerate;
    if (!(exact_.edge_margin(receiver(i), light_, limit_).clearance > limit_)) return false;
    if (!receiver(i).has_triangle()) return true;
    const Triangle own = scene_->meshes[receiver(i).mesh].corners(receiver(i).triangle);
    return questions::distance(receiver(i).point, own) < 100 * limit_ &&
           !questions::touches_another(*scene_, receiver(i), limit_);
  }

  /// Whether a triangle, counted over the scene, meets the way to the light.
  bool is_on_way(std::size_t i, std::uint64_t number) const {
    std::size_t m = 0;
    while (number >= scene_->meshes[m].triangles.size()) number -= scene_->meshes[m++].triangles.size();
    return crosses({receiver(i).point, light_}, scene_->meshes[m].corners(number)) != Crossing::none;
  }

  std::string place(std::size_t i) const {
    const Receiver at = receiver(i);
    return fmt::format("pixel {} of mesh {}, triangle {} at {}, {}, {} should be {}{}", i, at.mesh, gbuffer_->triangle[i],
                       at.point.x, at.point.y, at.point.z, visibility(i) == 0 ? "dark" : "lit",
                       answers_[i] && answers_[i]->degenerate ? ", by an edge" : "");
  }

 private:
  Receiver receiver(std::size_t i) const { return receiver_at(*scene_, *gbuffer_, i); }

  const Scene* scene_;
  glm::dvec4 light_;
  const GBuffer* gbuffer_;
  ExactScene exact_;
  double limit_;
  std::vector<std::optional<ExactAnswer>> answers_;
};

/// Pixels that face the light, each once, whatever the settings; wrong ones and counts over all settings.
struct Agreement {
  int dark = 0, lit = 0, degenerate = 0;
  int wrong = 0, excused = 0;  ///< answered otherwise than by the oracle; excused, where nothing is owed
  std::map<std::string, double> counts;
  std::map<std::string, int> runs_that_count;  ///< more than zero

  void add(const Answers& answers) {
    for (std::size_t i = 0; i < answers.size(); ++i) {
      if (!answers.faces_light(i)) continue;
      ++(answers[i].blocked ? dark : lit);
      degenerate += answers[i].degenerate;
    }
  }
  void add(const Counts& more) {
    for (const Count& count : more) {
      counts[count.name] += count.value;
      runs_that_count[count.name] += count.value > 0;
    }
  }
  std::string text() const {
    return fmt::format("{} dark, {} lit, {} of the dark by edges or vertices alone, {} excused", dark, lit, degenerate,
                       excused);
  }
};

class ExactOracle : public testing::TestWithParam<ExactTechnique> {
 protected:
  static inline const std::vector<std::string> defaults{""};

  static small_world::Run run(const std::string& settings, const Scene& scene, const Light& light, const GBuffer& gbuffer) {
    return small_world::run(GetParam().roll, settings, scene, light, gbuffer);
  }

  /// Calls the oracle once, and the technique in each of the settings.
  static void compare(std::span<const std::string> settings, const Scene& scene, const Light& light, const GBuffer& gbuffer,
                      Agreement& sum) {
    const Answers answers(scene, light, gbuffer);
    sum.add(answers);
    for (const std::string& each : settings) {
      SCOPED_TRACE("settings '" + each + "'");
      const auto done = run(each, scene, light, gbuffer);
      for (std::size_t i = 0; i < answers.size(); ++i) {
        if (done.mask[i] == answers.visibility(i)) continue;
        if (!answers.is_owed(GetParam().owes, i)) {
          ++sum.excused;
        } else if (sum.wrong++ == 0) {
          ADD_FAILURE() << answers.place(i);
        }
      }
      if (GetParam().names_casters) expect_casters_named(done, answers);
      sum.add(done.technique->counts());
    }
  }

  static void expect_agreement(const Agreement& sum, int least_dark, int least_lit) {
    EXPECT_EQ(sum.wrong, 0);
    EXPECT_GT(sum.dark, least_dark);
    EXPECT_GT(sum.lit, least_lit);
    EXPECT_LE(sum.excused, (sum.dark + sum.lit) / 50);
    RecordProperty("points", sum.text());
  }

 private:
  static void expect_casters_named(const small_world::Run& done, const Answers& answers) {
    for (std::size_t i = 0; i < answers.size(); ++i) {
      const auto why = done.technique->explain(i);
      ASSERT_EQ(why.has_value(), answers.faces_light(i)) << answers.place(i);
      if (!why) continue;
      ASSERT_TRUE(why->covered);
      ASSERT_EQ(why->element.has_value(), done.mask[i] == 0) << answers.place(i);
      ASSERT_TRUE(!why->element || answers.is_on_way(i, *why->element) || !answers.is_owed(GetParam().owes, i))
          << "triangle " << *why->element << " shades nothing, " << answers.place(i);
    }
  }
};

}  // namespace gnomon::exact_oracle
