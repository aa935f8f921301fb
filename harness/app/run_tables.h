#pragma once
#include <filesystem>
#include <span>

#include "measure/record/record.h"

namespace gnomon::app {

/// The tables of a run's folder: table.md, table.csv, table.tex and table.json beside its records. None for no records.
void write_tables(const std::filesystem::path& folder, std::span<const Record> records);

/// What a folder of a run holds, for the terminal.
void print_contents(const std::filesystem::path& folder);

/// "80 rows: 78 ok, 2 unsupported, 0 failed".
std::string count_text(std::span<const Record> records);

}  // namespace gnomon::app
