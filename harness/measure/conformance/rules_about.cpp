// The data sheet of a technique: texts, parameters, support.
#include <algorithm>
#include <cctype>
#include <cmath>
#include <set>

#include "measure/cause/own_causes.h"
#include "measure/conformance/judgement.h"
#include "measure/scene/load.h"

namespace gnomon::conformance {
namespace {

/// The row of an ObjectParameter's object has a dot between its names: "of.count".
bool is_row_name(std::string_view name) {
  const std::size_t dot = name.find('.');
  return is_plain_name(name.substr(0, dot)) && (dot == name.npos || is_row_name(name.substr(dot + 1)));
}

bool is_sentence(std::string_view text) {
  return !text.empty() && text.back() == '.' && !std::islower(static_cast<unsigned char>(text.front()));
}

void data_sheet(Trial& trial) {
  const TechniqueEntry& entry = trial.entry();
  trial.expect(is_plain_name(entry.id), fmt::format("the id {} is no plain name", entry.id));
  const About& about = entry.about;
  trial.expect(!about.title.empty(), "the title is empty");
  trial.expect(!about.source.empty(), "the source is empty");
  for (const auto& [what, text] : {std::pair("summary", about.summary), {"error", about.error}, {"fails", about.fails}})
    trial.expect(is_sentence(text), fmt::format("{} is no sentence: '{}'", what, text));
  for (const OwnCause& cause : about.causes)
    trial.expect(is_sentence(cause.sentence), fmt::format("cause {} has no sentence: '{}'", cause.id, cause.sentence));
  check_own_causes(std::span(&entry, 1));
  const auto made = entry.make();
  trial.expect(made->id() == entry.id, fmt::format("its object has the id {}, not {}", made->id(), entry.id));
}

// A technique that refuses everything would pass every rule about answers.
void supports_a_light(Trial& trial) {
  for (const char* reference : {"sphere_over_plane:segments=24", "box_city:count=12"}) {
    trial.at(reference);
    trial.expect(!trial.supported_lights(generated_scene(reference)).empty(), "it supports no light at all");
  }
}

void check_layers(Trial& trial, const Technique& technique) {
  std::set<std::string> names;
  for (const DebugLayer& layer : technique.debug_layers()) {
    trial.expect(is_plain_name(layer.name), fmt::format("the debug layer's name '{}' is no plain name", layer.name));
    trial.expect(names.insert(layer.name).second, fmt::format("debug layer {} is there twice", layer.name));
    trial.expect(layer.name != "mask" && layer.name != "error" && layer.name != "shaded",
                 fmt::format("debug layer {} has the name of a picture that every technique has", layer.name));
    trial.expect(is_sentence(layer.sentence), fmt::format("debug layer {} has no sentence: '{}'", layer.name, layer.sentence));
    std::set<std::string> swatches;
    for (const Swatch& swatch : layer.legend) {
      trial.expect(!swatch.name.empty() && swatches.insert(swatch.name).second,
                   fmt::format("debug layer {}: swatch '{}' has no name or that of another", layer.name, swatch.name));
      for (int c = 0; c < 3; ++c)
        trial.expect(swatch.color[c] >= 0 && swatch.color[c] <= 1,
                     fmt::format("debug layer {}: the color of {} is outside 0 .. 1", layer.name, swatch.name));
    }
  }
}

void parameters_and_layers(Trial& trial) {
  const auto technique = trial.entry().make();
  std::set<std::string> names;
  for (const Parameter* p : technique->parameters()) {
    const std::string name(p->name());
    trial.expect(is_row_name(name), fmt::format("the parameter's name '{}' is no plain name", name));
    trial.expect(names.insert(name).second, fmt::format("parameter {} is there twice", name));
    trial.expect(is_sentence(p->sentence()), fmt::format("parameter {} has no sentence: '{}'", name, p->sentence()));
    trial.expect(!p->allowed().empty(), fmt::format("parameter {} does not say what is allowed", name));
    trial.expect(p->text() == p->default_text(),
                 fmt::format("parameter {} begins with {}, not with its default {}", name, p->text(), p->default_text()));
    trial.expect(p->probes().size() >= 2, fmt::format("parameter {} has fewer than two probes", name));
    trial.expect(&technique->parameter(name) == p, fmt::format("parameter {} is not found by its name", name));
    trial.expect(p->spoils() != Stage::update,
                 fmt::format("parameter {} spoils update; allowed are setup, build, relight and resolve", name));
  }
  check_layers(trial, *technique);
  trial.expect(technique->settings().empty(), fmt::format("a fresh object has the settings '{}'", technique->settings()));
}

void check_refusals(Trial& trial, Parameter& p) {
  for (const char* value : {"nonsense", "1e300", "-1e300"}) {
    try {
      p.set(value);
      trial.found(fmt::format("parameter {} took {}", p.name(), value));
    } catch (const Error& error) {
      const std::string wanted = fmt::format("{}.{} = {} is outside {}", trial.entry().id, p.name(), value, p.allowed());
      trial.expect(std::string_view(error.what()).find(wanted) != std::string_view::npos,
                   fmt::format("it is refused with '{}', which does not hold '{}'", error.what(), wanted));
    }
    trial.expect(p.text() == p.default_text(), fmt::format("parameter {} changed by a value that it refused", p.name()));
  }
}

void parameter_values(Trial& trial) {
  const auto technique = trial.entry().make();
  for (Parameter* p : technique->parameters()) {
    std::vector<std::string> values = p->probes();
    values.push_back(p->default_text());
    for (const std::string& value : values) {
      p->set(value);
      trial.expect(p->text() == value, fmt::format("parameter {} set to {} is {}", p->name(), value, p->text()));
      p->set(p->text());
      trial.expect(p->text() == value, fmt::format("parameter {} set to its own text {} is {}", p->name(), value, p->text()));
    }
    check_refusals(trial, *p);
  }
  try {
    technique->apply("no_such_parameter=1");
    trial.found("it took the setting no_such_parameter=1");
  } catch (const Error&) {
  }
}

// For every kind of light, area lights included, a fresh object returns full support or a reason.
void support_answered(Trial& trial) {
  for (const char* reference : {"sphere_over_plane:segments=16", "box_city:count=12", "single_triangle"}) {
    const Scene scene = generated_scene(reference);
    trial.at(reference);
    for (const Light& light : lights_of_all_kinds(scene)) {
      trial.at(light);
      const Support support = trial.support(scene, light);
      const std::string_view kind = name(support.kind());
      trial.expect(support.why().empty() == (support.kind() == Support::Kind::full),
                   fmt::format("the support is {} with the reason '{}'", kind, support.why()));
      const Support again = trial.support(scene, light);
      trial.expect(support.kind() == again.kind() && support.why() == again.why(),
                   fmt::format("the support is {} ('{}') at the first call and {} ('{}') at the second", kind, support.why(),
                               name(again.kind()), again.why()));
    }
  }
}

/// An exact technique is wrong nowhere, one that promises a share keeps it, any other is far better than no shadows.
void judge_holes(Trial& trial, World& w, const GBuffer& gbuffer, const Light& light, const Technique& technique,
                 const std::vector<float>& mask) {
  const Tally found = tally(mask, w.reference(gbuffer, light, trial.entry().about.estimates), technique);
  trial.expect(found.dark >= 100, fmt::format("{} dark pixels that it covers: too few to judge by", found.dark));
  const auto promised = trial.support(w.scene, light).most_wrong();
  const std::size_t most = trial.entry().about.promise == Promise::exact ? 0
                           : promised ? static_cast<std::size_t>(*promised * static_cast<double>(found.tested))
                                      : found.dark / 4;
  if (found.wrong > most)
    trial.found(fmt::format("{} of {} tested pixels are wrong, {} without shadows; at most {} may be", found.wrong,
                            found.tested, found.dark, most),
                found.first_wrong, gbuffer);
}

/// What is approximate has said why.
void judge_cards(Trial& trial, World& w, const GBuffer& gbuffer, const Light& light, const Technique& technique,
                 const std::vector<float>& mask) {
  if (trial.support(w.scene, light).kind() == Support::Kind::approximate) return;
  judge_glass(trial, light, technique, mask, w.reference(gbuffer, light, trial.entry().about.estimates), gbuffer, 50);
}

/// A scene that has a feature, and what is expected of a technique that handles it.
struct FeatureTrial {
  Feature feature;
  Scene (*scene)();
  void (*judge)(Trial&, World&, const GBuffer&, const Light&, const Technique&, const std::vector<float>&);
};
constexpr FeatureTrial feature_trials[] = {{Feature::alpha_masks, checkered_card, judge_holes},
                                           {Feature::transmission, glass_cards, judge_cards}};

void one_feature(Trial& trial, const FeatureTrial& of) {
  const About& about = trial.entry().about;
  const auto w = trial.world(of.scene());
  trial.at(w->scene.name);
  if (std::ranges::find(about.handles, of.feature) == about.handles.end()) {
    for (const Light& light : lights_of_all_kinds(w->scene)) {
      trial.at(light);
      const Support support = trial.support(w->scene, light);
      trial.expect(!support && support.why().find(name(of.feature)) != std::string::npos,
                   fmt::format("it does not handle {}, and its support is {} ('{}')", name(of.feature), name(support.kind()),
                               support.why()));
    }
    return;
  }
  const GBuffer gbuffer = w->gbuffer(w->scene.views[0], 160, 90);
  const std::vector<Light> lights = trial.supported_lights(w->scene);
  // Lights with area only for a technique that supports no other: their penumbrae are narrower than a texel of the mask.
  const bool is_soft = std::ranges::all_of(lights, has_area);
  for (const Light& light : lights) {
    if (has_area(light) && !is_soft) continue;
    trial.at(light);
    const auto technique = trial.set_up();
    const std::vector<float> mask = trial.answer(*technique, w->scene, light, gbuffer);
    trial.expect_mask(mask, w->scene, gbuffer, light);
    if (!is_sanitized && about.role != Role::baseline) of.judge(trial, *w, gbuffer, light, *technique, mask);
  }
}

// Before it runs, so that a technique made before a feature is never silently wrong on a scene that has it.
void features(Trial& trial) {
  for (const FeatureTrial& of : feature_trials) one_feature(trial, of);
}

}  // namespace

std::vector<Rule> about_rules() {
  return {
      Rule("data_sheet", data_sheet, {},
           "Its id is a plain name; title and source are there; summary, error and fails are sentences.",
           "Fill in the About: a sentence begins with no small letter and ends with a period. The id is the stem of the "
           "file.",
           "Fill in title, source, summary, error and fails of the description: a sentence begins with no small "
           "letter and ends with a period. The id is the stem of the file."),
      Rule("supports_a_light", supports_a_light, {}, "It supports at least one kind of light in each of two simple scenes.",
           "Look at what supports() answers for a point light; one that refuses everything cannot be checked further.",
           "Look at the keys lights and handles, and at what the program answers to supports for a point light; one "
           "that refuses everything cannot be checked further."),
      Rule("support_answered", support_answered, {.has_context = false},
           "For every kind of light it answers whether it supports it: before anything runs, without OpenGL, and the same "
           "each time. Everything but full support has a reason.",
           "A fresh object answers supports(): compute the answer from scene, light and view alone, and never from what a "
           "stage has made. Give Support::unsupported and Support::approximate a reason.",
           "The process that answers supports runs no stage: compute the answer from scene, light and view alone. "
           "Give approximate and unsupported a why."),
      Rule("parameters_and_layers", parameters_and_layers, {},
           "Every parameter and debug layer has a plain name of its own and a sentence. No layer is named mask, error or "
           "shaded. Colors of legends lie in 0 .. 1. A fresh object has its defaults.",
           "Mend the row of the parameter or the entry of debug_layers() that is named. Constructors set nothing.",
           "Mend the [[parameter]] of the description that is named."),
      Rule("parameter_values", parameter_values, {},
           "Parameters take every value that they allow and refuse others with what, which value and what is allowed.",
           "Use Number, Choice and Flag of gnomon/param.h, which do so; a parameter of your own has to throw Error as they "
           "do.",
           "Mend value, min, max or choices of the [[parameter]] that is named."),
      Rule("features", features, {},
           "A scene whose casters have holes is unsupported, unless the data sheet states that it handles alpha_masks; one "
           "whose casters let a part of the light through, unless it states transmission. Then an exact technique is wrong "
           "at no tested pixel of such a scene; a sampled one keeps its promise, or has less than a quarter of the error of "
           "a mask without shadows.",
           "Look up every triangle that blocks a ray, or that is drawn, in its mask: is_solid_at "
           "(gnomon/kit/geometry/holes.h) finds the texel, and transmission_at what it lets through; Crossings "
           "(gnomon/kit/geometry/crossings.h) multiplies. A technique that does not leaves handles empty.",
           "Look up every triangle that blocks a ray in its alpha mask and its transmission: docs/protocol.md says "
           "how they are written. A program that does not leaves the key handles out.")};
}

}  // namespace gnomon::conformance
