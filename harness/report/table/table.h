#pragma once
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "measure/record/record.h"

namespace gnomon {

enum class Format { terminal, markdown, csv, latex, json };

/// "md", "csv", "tex", "json", "terminal"; throws Error with the list on anything else.
Format format_named(std::string_view name);

/// Where a table on paper goes: on a page in landscape, across both columns of a page, in one of them.
enum class Paper { landscape, page, column };

/// "landscape", "page", "column"; throws Error with the list on anything else.
Paper paper_named(std::string_view name);

struct TableOptions {
  /// Names or headings of columns in their order. Empty: for people the headline columns, for programs (CSV, JSON) every
  /// column.
  std::vector<std::string> columns = {};
  std::size_t width = 0;     ///< columns of the terminal, where text may wrap; 0: no limit
  std::string caption = {};  ///< of the LaTeX table; a sentence about the records when empty
  std::string label = "tab:gnomon";
  Paper paper = Paper::landscape;
};

/// The comparison table of the records. Terminal, Markdown and LaTeX group rows by scene, light and view, mark the best
/// contender of each group, show unsupported and failed rows with their reason, and say below the table where the numbers
/// come from. CSV and JSON hold plain values, one record a row. Throws Error on an unknown column.
std::string render_table(std::span<const Record> records, Format format, const TableOptions& options = {});

/// The CSV table of a run's folder, in pieces: the same text, but records are read one by one, since those of a long run are
/// larger than memory. Throws Error as `read_records` and `render_table` do, before the first piece.
void write_csv(const std::filesystem::path& dir, const TableOptions& options,
               const std::function<void(const std::string&)>& write);

/// Names and headings of the columns that these records can fill: what `columns` may hold.
std::vector<std::string> column_names(std::span<const Record> records);

}  // namespace gnomon
