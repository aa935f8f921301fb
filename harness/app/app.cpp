#include "app/app.h"

#include <gnomon/registry.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <thread>

namespace gnomon::app {

namespace {

/// CLI11 reports an unknown command as an unexpected argument; ours says what there is, as everywhere. Empty when the first
/// word is a command.
std::string unknown_command(const CLI::App& cli, int argc, char** argv) {
  std::vector<std::string> names;
  for (const CLI::App* command : cli.get_subcommands({}))
    if (!command->get_name().empty() && !command->get_group().empty()) names.push_back(command->get_name());
  for (int k = 1; k < argc; ++k) {
    const std::string word = argv[k];
    if (word == "--plugin") ++k;
    if (word.starts_with("-") || word == "--plugin") continue;
    if (std::find(names.begin(), names.end(), word) != names.end()) break;
    return fmt::format("there is no command {}; did you mean {}? There are: {}", word, nearest_word(word, names),
                       fmt::join(names, ", "));
  }
  return "";
}

}  // namespace

int run_program(int argc, char** argv) {
  try {
    Program program;
    program.cli.require_subcommand(1);
    program.cli.set_version_flag("--version", GNOMON_VERSION);
    program.cli.add_option("--plugin", program.plugins, "Load techniques from a plugin built with gnomon_add_plugin")
        ->type_name("FILE.so")
        ->expected(1)
        ->trigger_on_parse()
        ->each([](const std::string& path) { load_plugin(path); });
    for (auto* add : {add_list, add_describe, add_render, add_run, add_table, add_certify, add_docs, add_worker}) add(program);
    try {
      program.cli.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
      if (error.get_exit_code() == 0) return program.cli.exit(error);
      const std::string unknown = unknown_command(program.cli, argc, argv);
      fmt::print(stderr, "gnomon: {}\n", unknown.empty() ? error.what() : unknown);
      if (unknown.empty()) fmt::print(stderr, "gnomon --help and gnomon COMMAND --help say what is allowed\n");
      return 2;
    }
    return program.chosen();
  } catch (const Error& error) {
    fmt::print(stderr, "gnomon: {}\n", error.what());
    return 2;
  } catch (const WorkerFailure& failure) {
    fmt::print(stderr, "gnomon: {}\n", failure.what());
    return 1;
  } catch (const std::bad_alloc&) {
    fmt::print(stderr, "gnomon: out of memory\n");
    return 1;
  }
}

std::pair<int, int> parse_size(const std::string& text) {
  const auto refuse = [&] { throw Error("--size {} is not WxH with W and H of 1 .. 16384 pixels", text); };
  int size[2] = {};
  const char *at = text.data(), *end = text.data() + text.size();
  for (int k = 0; k < 2; ++k) {
    const auto [next, code] = std::from_chars(at, end, size[k]);
    if (code != std::errc{} || size[k] < 1 || size[k] > 16384) refuse();
    at = next;
    if (k == 0 && (at == end || *at++ != 'x')) refuse();
  }
  if (at != end) refuse();
  return {size[0], size[1]};
}

std::size_t terminal_width() {
  winsize window{};
  return ioctl(STDOUT_FILENO, TIOCGWINSZ, &window) == 0 ? window.ws_col : 0;
}

WorkerOptions worker_options(const Program& program, int threads) {
  const int cores = static_cast<int>(std::thread::hardware_concurrency());
  if (threads < 0 || threads > cores) throw Error("--threads {} is outside 1 .. {} cores of this machine", threads, cores);
  return {threads, program.plugins};
}

}  // namespace gnomon::app
