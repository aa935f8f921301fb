// What a side finds out about its answer: counts, layers, explanations, wrong pixels and their causes.
#include <gnomon/registry.h>

#include <algorithm>

#include "app/viewer/several_lights.h"
#include "app/viewer/side_lane.h"
#include "measure/cause/own_causes.h"
#include "measure/score/score.h"

namespace gnomon::viewer {

/// Counting may take a technique as long as its answer, so that it is done at rest only.
void SideLane::count(const std::shared_ptr<const SideAnswer>& answer) {
  const auto counts = std::make_shared<const Counts>(Call(*this, "counts")->answer().counts);
  change([&](SideState& s) {
    s.counts = counts;
    s.counted_answer = answer;
    s.words = support_.why();
  });
}

void SideLane::draw_layer(const std::shared_ptr<const SideAnswer>& answer, const std::string& name) {
  const auto technique = registry().technique(loaded_->technique).make();
  technique->apply(settings_);
  const std::vector<DebugLayer> layers = technique->debug_layers();
  const auto found = std::ranges::find(layers, name, &DebugLayer::name);
  if (found == layers.end()) throw Error("{} has no debug layer {}", loaded_->technique, name);
  auto picture = std::make_shared<LayerPicture>();
  picture->frame = answer->frame;
  picture->answer = answer;
  picture->layer = *found;
  const std::size_t light = answer->frame->chosen();
  // Of several lights, one that the technique does not support casts no shadows: its layer is black.
  if (light_supports_.empty() || light_supports_[light])
    picture->rgb = Call(*this, "layer " + name)->debug_layer(name, light);
  else
    picture->rgb.assign(3 * answer->frame->gbuffer.size(), 0);
  change([&](SideState& s) {
    s.layer = picture;
    s.words = support_.why();
  });
}

void SideLane::explain_picked(const std::shared_ptr<const SideAnswer>& answer, std::optional<std::uint32_t> pixel) {
  std::shared_ptr<const Explanation> explanation;
  std::shared_ptr<const DepthCurve> curve;
  if (pixel && *pixel < answer->mask.size()) {
    const std::uint32_t index[] = {*pixel};
    const std::size_t light = answer->frame->chosen();
    const auto why = Call(*this, "explain")->explain(index, light)[0];
    if (why) explanation = std::make_shared<Explanation>(*why);
    if (auto found = Call(*this, "explain")->depth_curve(*pixel, light))
      curve = std::make_shared<DepthCurve>(std::move(*found));
  }
  change([&](SideState& s) {
    s.explanation = explanation;
    s.depth_curve = curve;
    s.explained = pixel;
    s.explained_answer = answer;
    s.words = support_.why();
  });
}

/// Counts the wrong pixels; their causes come later.
void SideLane::count_wrong(const std::shared_ptr<const SideAnswer>& answer,
                           const std::shared_ptr<const ReferenceState>& reference) {
  auto verdict = std::make_shared<Verdict>();
  verdict->answer = answer;
  verdict->reference = reference;
  const About& about = registry().technique(loaded_->technique).about;
  verdict->estimates = about.estimates;
  verdict->own_causes = own_causes(about);
  const GBuffer& g = answer->frame->gbuffer;
  if (answer->frame->is_together()) verdict->together = put_together(*answer, *reference, verdict->estimates, {});
  const Evidence evidence = verdict->together ? verdict->together->evidence()
                                              : evidence_of(g.width, g.height, answer->mask, *reference, verdict->estimates);
  const Scoring scoring(evidence);
  verdict->errors = scoring.error_counts();
  verdict->error_floor = measure_metric(scoring, "error_floor");
  verdict->constant_error = measure_metric(scoring, "constant_error");
  if (verdict->together) verdict->received_error = measure_metric(scoring, "received_error_rms");
  if (!evidence.channels.empty())
    verdict->errors.error_sum = measure_metric(scoring, "error").value_or(0) * static_cast<double>(verdict->errors.tested);
  change([&](SideState& s) { s.verdict = verdict; });
}

/// Under each light the pixels where the same technique on the meshes agrees with the reference there; empty where it does not
/// support them. The worker is back at `frame` afterwards.
std::vector<std::vector<std::uint8_t>> SideLane::right_on_mesh(const Frame& frame,
                                                               std::span<const std::shared_ptr<const ReferenceState>> lights) {
  std::vector<std::vector<std::uint8_t>> right(lights.size());
  Frame mesh_frame = *lights[0]->on_mesh->frame;
  mesh_frame.light = frame.light;
  mesh_frame.lights = frame.lights;
  if (set_frame(mesh_frame, "causes")) {
    const std::vector<std::vector<float>> masks = split_masks(resolve_mask(false), lights.size());
    for (std::size_t k = 0; k < lights.size(); ++k) {
      const Light& light = frame.all_lights()[k];
      const AnswerKind kind = answer_kind(frame.scene(light), light);
      const std::vector<float>& truth = lights[k]->on_mesh->mask;
      for (std::size_t i = 0; i < masks[k].size(); ++i)
        right[k].push_back(kind == AnswerKind::fraction ? std::abs(masks[k][i] - truth[i]) <= 4 * AreaTarget{}.error
                                                        : !is_wrong(masks[k][i], truth[i], kind));
    }
  }
  set_frame(frame, "causes");
  resolve_mask(false);
  return right;
}

/// Names the cause of every wrong pixel, as `gnomon render` does.
void SideLane::find_causes_of(const std::shared_ptr<const Verdict>& verdict,
                              const std::shared_ptr<const ReferenceState>& truth) {
  std::uint64_t ticket = 0;
  {
    const std::lock_guard lock(board_.mutex);
    if (board_.state.frame != verdict->answer->frame || board_.stop) return;
    ticket = causes_.ticket();
  }
  const Frame& frame = *verdict->answer->frame;
  const std::vector<std::shared_ptr<const ReferenceState>> lights = frame.is_together() ? truth->lights : std::vector{truth};
  std::vector<std::vector<std::uint8_t>> right(lights.size());
  const About& about = registry().technique(loaded_->technique).about;
  if (lights[0]->on_mesh && about.sees == Truth::mesh) right = right_on_mesh(frame, lights);
  std::vector<std::vector<Cause>> causes(lights.size());
  bool has_terms = false;
  const bool is_done = causes_.run(ticket, [&] {
    for (std::size_t k = 0; k < lights.size(); ++k) {
      // A technique that gives parts of its error names causes by them.
      const ErrorParts terms = Call(*this, "causes")->error_terms(share_of(*lights[k], verdict->estimates), k);
      has_terms = has_terms || !terms.causes.empty();
      Reference reference{lights[k]->mask, lights[k]->classes, lights[k]->nearest_caster, lights[k]};
      const Light& light = frame.all_lights()[k];
      reference.kind = answer_kind(frame.scene(light), light);
      reference.error = lights[k]->error;
      reference.irradiance = lights[k]->irradiance;
      reference.irradiance_error = lights[k]->irradiance_error;
      const auto explain = [&](std::span<const std::uint32_t> pixels) { return Call(*this, "explain")->explain(pixels, k); };
      causes[k] = find_causes({frame.scene(light), frame.casters(light), frame.gbuffer, light, reference,
                               verdict->answer->mask_under(k), right[k], explain, verdict->estimates, verdict->own_causes,
                               about.rasterizes});
    }
  });
  if (!is_done) return;
  tells_parts_ = tells_parts_ || has_terms;
  auto complete = std::make_shared<Verdict>(*verdict);
  if (frame.is_together())
    complete->together = put_together(*verdict->answer, *truth, verdict->estimates, causes, verdict->own_causes);
  else
    complete->causes = std::move(causes[0]);
  complete->cause_counts =
      count_causes(frame.is_together() ? complete->together->causes : complete->causes, verdict->own_causes);
  complete->has_causes = true;
  complete->lacks_parts = about.remembers && tells_parts_ && !has_terms;
  complete->reference = truth;
  change([&](SideState& s) {
    if (s.verdict == verdict) s.verdict = complete;
    // Layer and picked pixel were looked at before the parts of the error were known.
    if (has_terms) s.layer = nullptr;
    if (has_terms) s.explained_answer = nullptr;
    s.words = support_.why();
  });
}

}  // namespace gnomon::viewer
