// The CSV table of a run that may be larger than memory.
#include <map>

#include "report/table/layout.h"
#include "report/table/table.h"

namespace gnomon {

namespace {

/// What the list of columns depends on: parameters, counts and causes of its own that a record has.
Record columns_part(const Record& record) {
  Record part;
  part.parameters = record.parameters;
  part.counts = record.counts;
  part.own_causes = record.own_causes;
  return part;
}

std::string words(const Record& part) {
  std::string text;
  for (const auto& [name, value] : part.parameters.items()) text += fmt::format("p {} {}\n", name, value.is_number());
  for (const Count& count : part.counts) text += fmt::format("c {} {}\n", count.name, count.unit);
  for (const Record::OwnCauseFacts& cause : part.own_causes) text += fmt::format("o {} {}\n", cause.name, cause.sentence);
  return text;
}

/// One record of each kind that has columns of its own, in the order of the table.
class Kinds {
 public:
  void add(const Record& record) {
    Record part = columns_part(record);
    const auto [found, is_new] = known_.try_emplace(words(part), parts_.size());
    if (is_new) parts_.push_back(std::move(part));
    of_line_.push_back(found->second);
  }

  std::vector<Record> in_order(std::span<const std::size_t> lines) const {
    std::vector<Record> result;
    std::vector<bool> is_there(parts_.size());
    for (const std::size_t line : lines) {
      if (is_there[of_line_[line]]) continue;
      is_there[of_line_[line]] = true;
      result.push_back(parts_[of_line_[line]]);
    }
    return result;
  }

 private:
  std::map<std::string, std::size_t> known_;
  std::vector<Record> parts_;
  std::vector<std::size_t> of_line_;
};

}  // namespace

void write_csv(const std::filesystem::path& dir, const TableOptions& options,
               const std::function<void(const std::string&)>& write) {
  Kinds kinds;
  RecordLines lines(dir, [&](const Record& record) { kinds.add(record); });
  std::vector<Column> columns = all_columns(kinds.in_order(lines.order()));
  if (!options.columns.empty()) columns = select(columns, options.columns);
  std::erase_if(columns, [](const Column& column) { return column.audience == Audience::people; });
  write(csv_heads(columns));
  for (const std::size_t line : lines.order()) write(csv_line(row_of(lines.read(line), columns).cells));
}

}  // namespace gnomon
