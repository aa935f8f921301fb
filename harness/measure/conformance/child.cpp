#include "measure/conformance/child.h"

#include <tbb/global_control.h>

#include <fstream>
#include <iterator>

#include "measure/conformance/world.h"
#include "measure/scratch_folder.h"
#include "measure/worker/worker_server.h"

namespace gnomon::conformance {

namespace {

Json place_json(const Place& place) {
  return json_object({{"scene", place.scene}, {"light", place.light}, {"settings", place.settings}});
}

/// The place that a process wrote there before it ended; empty when it wrote none.
Place place_in(const std::filesystem::path& file) {
  std::ifstream stream(file);
  const Json json = parse_if_json(std::string(std::istreambuf_iterator<char>(stream), {}));
  if (!json.is_object()) return {};
  return {json.value("scene", ""), json.value("light", ""), json.value("settings", "")};
}

}  // namespace

Json verdict_json(const Verdict& verdict) {
  Json findings = Json::array();
  for (const Finding& finding : verdict.findings) {
    Json json = json_object({{"what", finding.what}});
    json.update(place_json(finding.place));
    if (const auto& p = finding.pixel)
      json["pixel"] = json_object({{"x", p->x}, {"y", p->y}, {"width", p->width}, {"height", p->height}});
    findings.push_back(std::move(json));
  }
  return json_object({{"verdict", name(verdict.kind)},
                      {"why", verdict.why},
                      {"finding_count", verdict.finding_count},
                      {"findings", std::move(findings)}});
}

Verdict verdict_of(const Json& json) {
  using Kind = Verdict::Kind;
  Verdict verdict{.why = json.at("why"), .finding_count = json.at("finding_count")};
  for (const Kind kind : {Kind::does_not_apply, Kind::fails})
    if (json.at("verdict") == name(kind)) verdict.kind = kind;
  for (const Json& finding : json.at("findings")) {
    verdict.findings.push_back({finding.at("what"), {finding.at("scene"), finding.at("light"), finding.at("settings")}, {}});
    if (!finding.contains("pixel")) continue;
    const Json& pixel = finding["pixel"];
    verdict.findings.back().pixel = {pixel.at("x"), pixel.at("y"), pixel.at("width"), pixel.at("height")};
  }
  return verdict;
}

Verdict judge_in_child(const Rule& rule, const TechniqueEntry& entry, WorkerOptions options, double timeout_seconds) {
  if (const std::string_view why = why_not_applied(rule, entry.about); !why.empty())
    return {.kind = Verdict::Kind::does_not_apply, .why = std::string(why)};
  const ScratchFolder folder = ScratchFolder::in_memory("gnomon-check");
  const std::filesystem::path place = folder.path() / "place";
  options.command = "check-rule";
  options.keeps_shaders = true;  // times do not matter here
  WorkerProcess child(options);
  try {
    child.send(json_object({{"do", rule.name}, {"technique", entry.id}, {"place", place.string()}}));
    const Json reply = child.receive(timeout_seconds);
    if (reply.contains("cannot_ask")) throw CannotAsk("{}", plain_text(reply["cannot_ask"]));
    return verdict_of(reply);
  } catch (const WorkerFailure& failure) {
    return {.kind = Verdict::Kind::fails,
            .findings = {{fmt::format("it {}", failure.what()), place_in(place), {}}},
            .finding_count = 1};
  }
}

int rule_child_main(int socket, int threads) {
  std::optional<tbb::global_control> limit;
  if (threads > 0) limit.emplace(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
  answer_lines(socket, [](const Json& request) {
    const std::filesystem::path file(request.at("place").get<std::string>());
    const auto moves = [&](const Place& place) { std::ofstream(file) << json_text(place_json(place)); };
    const TechniqueEntry& entry = registry().technique(request.at("technique").get<std::string>());
    try {
      return verdict_json(judge(rule(request.at("do").get<std::string>()), entry, moves));
    } catch (const CannotAsk& error) {
      return json_object({{"cannot_ask", error.what()}});
    }
  });
}

}  // namespace gnomon::conformance
