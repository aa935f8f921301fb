#pragma once
#include <gnomon/scene.h>

#include <CLI/CLI.hpp>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "measure/run/worker.h"

namespace gnomon::app {

/// What every command may look at: options given before the command.
struct Program {
  CLI::App cli{"Gnomon: shadow techniques side by side, by cost and by error against ray-traced truth", "gnomon"};
  std::vector<std::string> plugins;
  /// Set by the command that was chosen; returns the exit status.
  std::function<int()> chosen;
};

// One function per command, each in command_NAME.cpp: adds its sub-command and sets `chosen` when it is called.
void add_list(Program& program);
void add_describe(Program& program);
void add_render(Program& program);
void add_run(Program& program);
void add_table(Program& program);
void add_compare(Program& program);
void add_merge(Program& program);
void add_report(Program& program);
void add_analyze(Program& program);
void add_figure(Program& program);
void add_certify(Program& program);
void add_docs(Program& program);
void add_score(Program& program);
void add_view(Program& program);
void add_worker(Program& program);  ///< hidden: the processes that `run` and the importer start

/// The whole program. Exit status: 0 done (unsupported rows included), 1 done but something failed, 2 bad usage or input.
int run_program(int argc, char** argv);

/// "shape" or "mesh", the value of --truth. Throws Error.
Truth parse_truth(const std::string& text);

/// Checks the value of --timeout: above 0, at most a day.
CLI::Validator seconds();
/// Of an option that is a name: "" is none.
CLI::Validator not_empty();

/// Check a number; CLI::Range lets NaN pass. The whole text is a finite number from `low` to `high`, or above 0.
CLI::Validator number_in(double low, double high);
CLI::Validator above_zero();

/// Columns of the terminal on stdout; 0, no limit, when there is none.
std::size_t terminal_width();

/// WorkerOptions from --threads and the plugins. Throws Error on more threads than cores.
WorkerOptions worker_options(const Program& program, int threads);

}  // namespace gnomon::app
