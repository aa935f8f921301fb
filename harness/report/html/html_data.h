#pragma once
#include <span>
#include <string>

#include "measure/record/record.h"
#include "report/table/layout.h"

namespace gnomon {

// What the page shows, as JSON; harness/report/html/web/data.js reads it. docs/report.md is for people who want the numbers:
// they take `gnomon table --format json`.

/// Columns, rows, groups, legends, provenance: everything but pictures. The rows are those of the layout in its order, which
/// must have been laid out with every column.
Json report_data(const Layout& layout, std::span<const Record> records);

/// JSON that may stand inside a script element: no `<` in it, and text that is not UTF-8 mended.
std::string script_text(const Json& json);

/// Text that may stand between tags or in a quoted attribute.
std::string html_text(std::string_view text);

}  // namespace gnomon
