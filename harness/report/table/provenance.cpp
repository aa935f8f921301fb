// Where the rows of a table were made.
#include <map>
#include <set>

#include "analysis/in_order.h"
#include "report/table/layout.h"

namespace gnomon {

namespace {

/// "5 processes x 3 repetitions", every combination that occurs in a stage after setup.
std::string repetition_plan(std::span<const Record> records) {
  std::vector<std::string> plans;
  for (const Record& r : records)
    for (const TimedPart part : repeated_parts) {
      const ProcessTimes& times = times_of(r, part);
      std::size_t repetitions = 0;
      for (const std::vector<double>& process : times) repetitions = std::max(repetitions, process.size());
      if (repetitions == 0) continue;
      add_once(plans, fmt::format("{} x {}", times.size(), repetitions));
    }
  return joined(plans, ", ");
}

/// Which programs measured the rows, where it was more than one; rows without a hash of the code count by their commits.
std::string mixed_programs(std::span<const Record> records) {
  std::map<std::string, std::size_t> programs;
  std::map<std::string, std::set<std::string>> sources;  // by technique and settings
  for (const Record& r : records) {
    const std::string build = context_text(r, "build"), commit = context_text(r, "commit");
    if (!build.empty() || !commit.empty()) ++programs[build.empty() ? "commit " + commit : "build " + build];
    if (const std::string source = context_text(r, "technique_source"); !source.empty())
      sources[r.technique + ":" + r.settings].insert(source);
  }
  std::vector<std::string> texts;
  if (programs.size() > 1)
    for (const auto& [program, rows] : programs)
      texts.push_back(fmt::format("{} ({} row{})", program, rows, rows == 1 ? "" : "s"));
  for (const auto& [technique, hashes] : sources)
    if (hashes.size() > 1) texts.push_back(fmt::format("{} sources of {}", hashes.size(), technique));
  return texts.empty() ? "" : fmt::format("rows of several programs may not be comparable: {}", joined(texts, ", "));
}

// A row's own work is at most a thread a core and a helper or two: what an engine in a browser has, with its processes, is 2
// more.
constexpr double own_load = 3;

/// How many rows began beside other work.
std::string busy_rows(std::span<const Record> records) {
  std::size_t busy = 0;
  double most = 0;
  for (const Record& r : records) {
    const auto load = r.context.find("load_average"), cores = r.context.find("cores");
    if (load == r.context.end() || cores == r.context.end() || !load->is_number() || !cores->is_number()) continue;
    if (load->get<double>() <= cores->get<double>() + own_load) continue;
    ++busy;
    most = std::max(most, load->get<double>());
  }
  if (busy == 0) return "";
  return fmt::format("{} row{} began at a load average of up to {:.1f}: other work ran beside, and times are longer for it",
                     busy, busy == 1 ? "" : "s", most);
}

}  // namespace

Remarks provenance(std::span<const Record> records) {
  Remarks lines;
  const auto add = [&](const char* topic, std::string text) {
    lines.emplace_back(topic, text.empty() ? "-" : std::move(text));
  };
  add("renderer", joined(context_values(records, "gl_renderer"), "; "));
  for (const char* key : {"processor", "threads", "version", "commit"}) add(key, joined(context_values(records, key), "; "));
  if (std::string mixed = mixed_programs(records); !mixed.empty()) add("mixed", std::move(mixed));
  if (std::string busy = busy_rows(records); !busy.empty()) add("load", std::move(busy));
  add("processes x repetitions", repetition_plan(records));
  const auto has_kept_shaders = [](const Record& r) {
    return context_text(r, "shaders") == "kept" && !context_text(r, "gl_renderer").empty();
  };
  if (const auto kept = std::ranges::count_if(records, has_kept_shaders); kept > 0)
    add("shaders", fmt::format("kept for {} row{}: their setup compiles none", kept, kept == 1 ? "" : "s"));
  std::vector<std::string> notes;
  for (const Record& r : records)
    for (const std::string& note : r.notes) add_once(notes, fmt::format("{}: {}", r.scene, note));
  for (const std::string& note : notes) add("note", note);
  return lines;
}

}  // namespace gnomon
