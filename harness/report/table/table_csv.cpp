// The CSV table of a run that may be larger than memory.
#include "analysis/in_order.h"
#include "report/table/layout.h"

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

}  // namespace

void write_csv(const std::filesystem::path& dir, const TableOptions& options,
               const std::function<void(const std::string&)>& write) {
  // One record of each kind that has columns of its own.
  std::vector<Record> kinds;
  std::map<std::string, std::size_t> known;
  std::vector<std::size_t> kind_of_line;
  RecordLines lines(dir, [&](const Record& record) {
    Record part = columns_part(record);
    const auto [found, is_new] = known.try_emplace(words(part), kinds.size());
    if (is_new) kinds.push_back(std::move(part));
    kind_of_line.push_back(found->second);
  });
  std::vector<std::size_t> order;  // of the kinds in the table
  for (const std::size_t line : lines.order()) add_once(order, kind_of_line[line]);
  std::vector<Record> kinds_in_order;
  for (const std::size_t kind : order) kinds_in_order.push_back(std::move(kinds[kind]));
  std::vector<Column> columns = all_columns(kinds_in_order);
  if (!options.columns.empty()) columns = select(columns, options.columns);
  std::erase_if(columns, [](const Column& column) { return column.audience == Audience::people; });
  write(csv_heads(columns));
  for (const std::size_t line : lines.order()) write(csv_line(row_of(lines.read(line), columns).cells));
}

}  // namespace gnomon
