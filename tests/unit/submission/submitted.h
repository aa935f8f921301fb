#pragma once
// An edition of two groups and a submission of one technique's rows, right in all that rules look at.
#include "measure/submission/rules.h"

namespace submitted {
using namespace gnomon;

inline Job place(const std::string& scene, const std::string& light) {
  Job job;
  job.scene = scene;
  job.light = light;
  job.lights = {light};
  job.view = "view";
  job.width = 64;
  job.height = 36;
  return job;
}

inline Contender contender(const std::string& technique, const std::string& settings = "") {
  return {.technique = technique, .settings = settings, .label = {}};
}

struct World {
  Edition edition;
  EditionPlaces places = {{place("fence", "point"), place("fence", "sun")}, {place("fence", "sun"), place("soup", "sun")}};
  Submission submission;

  World() {
    edition.name = "test";
    edition.hash = "0123456789abcdef";
    edition.suite.name = "edition_test";
    edition.suite.processes = 2;
    edition.suite.repetitions = 3;
    edition.suite.groups = {{.scenes = {"fence"}, .lights = {}, .views = {}, .contenders = {contender("shadow_map")}},
                            {.scenes = {"soup"}, .lights = {}, .views = {}, .contenders = {contender("unshadowed")}}};
    edition.training = {"terrain", "bush"};
    edition.metrics = {{"error", 1}};
    edition.techniques["shadow_map"] = {{"resolution", 1024}, {"filter", "nearest"}};
    SubmissionFacts& facts = submission.facts;
    facts.edition = {edition.name, edition.hash};
    facts.name = "machine";
    facts.metrics = edition.metrics;
    facts.system = {{"processor", "an abacus"}, {"cores", 2},        {"memory_bytes", 1e9},
                    {"clock_mhz", nullptr},     {"os", "an os"},     {"kernel", "a kernel"},
                    {"compiler", "g++"},        {"embree", "3.13"},  {"load_average", 0},
                    {"gl_renderer", "a card"},  {"gl_version", "4"}, {"driver", "a driver"}};
    for (const Job& job : places[0]) add(row(job, contender("shadow_map")));
    submission.runs = Json::array({{{"edition", {{"name", edition.name}, {"hash", edition.hash}, {"division", "default"}}},
                                    {"changes", ""},
                                    {"context", {{"commit", "0a1b2c"}}}}});
    facts.techniques = codes_of(submission.records);
  }

  void add(Record record) {
    edition.scenes[scene_key(record)] = "the hash of " + record.scene;
    submission.records.push_back(std::move(record));
  }

  Record row(const Job& place, const Contender& of) const {
    const Job job = with_contender(place, of, edition.suite);
    Record r;
    r.job = job.hash;
    r.suite = edition.suite.name;
    r.scene = job.scene;
    r.light = job.light;
    r.lights.emplace_back().name = job.light;
    r.view = job.view;
    r.width = job.width;
    r.height = job.height;
    r.technique = of.technique;
    r.settings = of.settings;
    r.status = Status::ok;
    r.parameters = {{"resolution", 1024}, {"filter", "nearest"}};
    r.mask = "masks/" + job.hash + ".exr";
    r.metrics[Truth::shape] = {{"error", 0.125}};
    for (const Stage stage : {Stage::relight, Stage::resolve}) {
      r.times(stage) = {{1, 2, 3}, {2, 3, 4}};
      r.iterations[std::string(name(stage))] = 10;
    }
    r.seconds = 0.5;  // of which 2 * 15 ms * 10 are in its repetitions
    r.stop = "fixed";
    r.context = {
        {"commit", "0a1b2c"},       {"build", "b"}, {"technique_source", "s"}, {"scene_hash", "the hash of " + job.scene},
        {"processor", "an abacus"}, {"cores", 2},   {"compiler", "g++"},       {"gl_renderer", "a card"},
        {"gl_version", "4"}};
    return r;
  }

  /// Nothing is known of techniques that are not here.
  RowFaults rows(const SupportsNothing& nothing = [](const Contender&, std::size_t) { return std::nullopt; }) const {
    return row_faults(submission, edition, places, nothing);
  }
};

}  // namespace submitted
