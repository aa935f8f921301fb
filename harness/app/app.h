#pragma once
#include <gnomon/scene.h>

#include <algorithm>
#include <span>

#include "app/command_line.h"
#include "measure/record/record.h"
#include "measure/scene/channels.h"
#include "measure/worker/worker_process.h"

namespace gnomon::app {

/// What every command may read: options given before the command.
struct Program {
  CommandLine line;
  std::vector<std::string> plugins;  ///< as WorkerOptions has them
  std::vector<std::string> words;    ///< that it was called by, the first "gnomon"
};

// One function per command: adds it, its options and its work. Each is in command_NAME.cpp, or with a command of its kind:
// describe and docs with list, merge with run, report with table, figure with analyze.
void add_list(Program& program);
void add_describe(Program& program);
void add_check(Program& program);
void add_render(Program& program);
void add_run(Program& program);
void add_edition(Program& program);
void add_tune(Program& program);
void add_table(Program& program);
void add_compare(Program& program);
void add_merge(Program& program);
void add_report(Program& program);
void add_analyze(Program& program);
void add_figure(Program& program);
void add_export(Program& program);
void add_pack(Program& program);
void add_submission(Program& program);
void add_certify(Program& program);
void add_docs(Program& program);
void add_score(Program& program);
void add_site(Program& program);
void add_cache(Program& program);
void add_view(Program& program);

/// The whole program. Exit status: 0 done (unsupported rows included), 1 done but something failed, 2 bad usage or input.
int run_program(int argc, char** argv);

/// "I/N" with 0 <= I < N, the value of --shard. Throws Error.
std::pair<int, int> parse_shard(const std::string& text);

/// "shape" or "mesh", the value of --truth. Throws Error.
Truth parse_truth(const std::string& text);

/// The tables of a run's folder: table.md, table.csv, table.tex and table.json beside its records. None for no records.
void write_tables(const std::filesystem::path& folder, std::span<const Record> records);

/// runs/NAME-TIME, where no option names a folder.
std::filesystem::path timed_folder(const std::string& name);

/// The name in a list, which is empty where there is none.
inline std::vector<std::string> listed(const std::string& name) {
  return name.empty() ? std::vector<std::string>() : std::vector{name};
}

/// The lights or views of these names; all without names. A light that glass colors is its three channels (split_lights).
template <class Item>
std::vector<const Item*> chosen(const std::vector<Item>& items, const std::vector<std::string>& names) {
  std::vector<const Item*> result;
  for (const Item& item : items)
    if (names.empty() || std::ranges::find(names, item.name) != names.end() ||
        std::ranges::find(names, whole_name(item.name)) != names.end())
      result.push_back(&item);
  return result;
}

/// Items of lights in a scene's order: those of a light's three channels together, every other one by itself. `name_of` an item
/// is the name of its light.
template <class Item, class NameOf>
std::vector<std::vector<Item>> by_whole_light(const std::vector<Item>& items, NameOf name_of) {
  constexpr std::size_t channels = std::size(all_channels);
  std::vector<std::vector<Item>> groups;
  for (auto item = items.begin(); item != items.end(); item += static_cast<std::ptrdiff_t>(groups.back().size())) {
    const auto left = static_cast<std::size_t>(items.end() - item);
    const bool are_channels = left >= channels && whole_name(name_of(*item)) == whole_name(name_of(item[channels - 1]));
    groups.emplace_back(item, item + (are_channels ? channels : 1));
  }
  return groups;
}

/// WorkerOptions from --threads and the plugins. Throws Error on more threads than cores.
WorkerOptions worker_options(const Program& program, int threads);

}  // namespace gnomon::app
