#include "measure/run/unfinished.h"

#include "measure/part_file.h"
#include "measure/scene/blob.h"

namespace gnomon {

namespace fs = std::filesystem;

namespace {

constexpr const char* effort_key = "effort";

Json effort_of(const Suite& suite) {
  return json_object({{"processes", suite.processes},
                      {"repetitions", suite.repetitions},
                      {"warmups", suite.warmups},
                      {"interval", suite.interval},
                      {"pictures", static_cast<int>(suite.pictures)},
                      {"reference_error", suite.target.error},
                      {"reference_rays", suite.target.cap},
                      {"truth", name(suite.truth)},
                      {"truth_over", name(suite.truth_over)}});
}

/// Whether all that a row's record has before it runs is in another one, but for what differs from start to start.
bool has_context(const Json& then, const Json& now) {
  for (const auto& [key, value] : now.items()) {
    if (key == "load_average" || key == "started") continue;
    if (!then.contains(key) || then[key] != value) return false;
  }
  return true;
}

}  // namespace

UnfinishedRows::UnfinishedRows(const fs::path& out, const Suite& suite, const std::set<std::string>& jobs, bool retry_failed)
    : out_(out), file_(out / "unfinished.jsonl"), effort_(effort_of(suite)) {
  if (!is_plain_file(file_)) return;
  try {
    for (Record& record : read_record_file(file_).records)
      if (const std::string job = record.job; jobs.contains(job) && !(retry_failed && record.status == Status::failed))
        waiting_.insert_or_assign(job, std::move(record));
  } catch (const Error&) {  // written by another version, or damaged: its rows begin anew
    waiting_.clear();
  }
}

void UnfinishedRows::go_on(PendingRow& row) {
  const auto found = waiting_.find(row.job.hash);
  if (found == waiting_.end()) return;
  Record then = std::move(found->second);
  waiting_.erase(found);
  const auto is_there = [this](const std::string& picture) { return fs::exists(out_ / picture); };
  const bool is_as_now = then.context.value(effort_key, Json()) == effort_ && has_context(then.context, row.record.context) &&
                         std::ranges::all_of(pictures(then), is_there);
  const std::size_t processes = then.times(Stage::resolve).size();
  const bool is_ok = then.status == Status::ok;
  if (!is_as_now || (is_ok && processes == 0)) return;
  then.context.erase(effort_key);
  then.suite = row.record.suite;
  then.label = row.record.label;
  then.place = row.record.place;
  row.record = std::move(then);
  row.over = !is_ok;
  row.processes = static_cast<int>(processes);
}

void UnfinishedRows::write(std::span<const PendingRow> batch) {
  std::string lines;
  const auto add = [&](Record record) {
    record.context[effort_key] = effort_;
    lines += record_line(record);
  };
  for (const PendingRow& row : batch) add(row.record);
  for (const auto& [job, record] : waiting_) lines += record_line(record);
  if (!lines.empty()) return write_file(file_, lines, Durable::yes);
  std::error_code ignored;
  fs::remove(file_, ignored);
}

}  // namespace gnomon
