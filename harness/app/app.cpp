#include "app/app.h"

#include <gnomon/registry.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <system_error>
#include <thread>

namespace gnomon::app {

namespace {

/// What is wrong with the words of the command line. CLI11 only says that an argument was not expected; ours says what there
/// is instead, as everywhere.
std::string usage_error(const CLI::App& cli, const CLI::ParseError& error, int argc, char** argv) {
  std::vector<std::string> names;
  for (const CLI::App* command : cli.get_subcommands({}))
    if (!command->get_group().empty()) names.push_back(command->get_name());
  const CLI::App* command = nullptr;
  for (int k = 1; k < argc && !command; ++k) {
    const std::string word = argv[k];
    if (word == "--plugin") ++k;
    if (word.starts_with("-")) continue;
    const auto found = cli.get_subcommands([&](const CLI::App* app) { return app->get_name() == word; });
    if (!found.empty())
      command = found.front();
    else
      return fmt::format("there is no command {}; did you mean {}? There are: {}", word, nearest_word(word, names),
                         fmt::join(names, ", "));
  }
  const CLI::App& asked = command ? *command : cli;
  const std::string who = command ? "gnomon " + command->get_name() : "gnomon";
  const std::vector<std::string> extra = cli.remaining(true);
  if (!extra.empty() && extra.front().starts_with("-")) {
    std::vector<std::string> options;
    for (const CLI::Option* option : asked.get_options())
      for (const std::string& name : option->get_lnames()) options.push_back("--" + name);
    return fmt::format("{} has no option {}; did you mean {}? It has: {}", who, extra.front(),
                       nearest_word(extra.front(), options), fmt::join(options, ", "));
  }
  if (!extra.empty())
    return fmt::format("{} does not know what to do with '{}'; {} --help says what it takes", who, extra.front(), who);
  if (!command) return fmt::format("a command is wanted; there are: {}", fmt::join(names, ", "));
  return fmt::format("{}; {} --help says what is allowed", error.what(), who);
}

/// The whole text is a finite number that is good; else the message says that it is not `what`.
CLI::Validator number_that(std::function<bool(double)> is_good, const std::string& what, const std::string& name) {
  const auto check = [=](const std::string& text) -> std::string {
    double value = 0;
    const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
    const bool is_number = code == std::errc{} && end == text.data() + text.size() && std::isfinite(value);
    return is_number && is_good(value) ? "" : fmt::format("{} is not {}", text, what);
  };
  return CLI::Validator(check, name);
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
    for (auto* add : {add_list, add_describe, add_render, add_run, add_table, add_compare, add_merge, add_report, add_analyze,
                      add_figure, add_certify, add_docs, add_score, add_view, add_worker})
      add(program);
    try {
      program.cli.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
      if (error.get_exit_code() == 0) return program.cli.exit(error);
      fmt::print(stderr, "gnomon: {}\n", usage_error(program.cli, error, argc, argv));
      return 2;
    }
    const int status = program.chosen();
    if (std::fflush(stdout) != 0) throw std::system_error(errno, std::generic_category());
    return status;
  } catch (const Error& error) {
    fmt::print(stderr, "gnomon: {}\n", error.what());
    return 2;
  } catch (const WorkerFailure& failure) {
    fmt::print(stderr, "gnomon: {}\n", failure.what());
    return 1;
  } catch (const std::filesystem::filesystem_error& error) {
    fmt::print(stderr, "gnomon: {}: {}\n", error.path1().string(), error.code().message());
    return 2;
  } catch (const std::system_error& error) {
    fmt::print(stderr, "gnomon: standard output cannot be written: {}\n", error.code().message());
    return 2;
  } catch (const std::bad_alloc&) {
    fmt::print(stderr, "gnomon: out of memory\n");
    return 1;
  } catch (const std::exception& error) {
    fmt::print(stderr, "gnomon: {}\n", error.what());
    return 1;
  }
}

Truth parse_truth(const std::string& text) {
  if (text != "shape" && text != "mesh") throw Error("--truth {} is neither shape nor mesh", text);
  return text == "mesh" ? Truth::mesh : Truth::shape;
}

CLI::Validator seconds() {
  const auto is_good = [](double value) { return value > 0 && value <= 86400; };
  return number_that(is_good, "a number of seconds above 0, at most 86400", "SECONDS");
}

CLI::Validator not_empty() {
  return CLI::Validator([](const std::string& text) { return std::string(text.empty() ? "the name is empty" : ""); }, "");
}

CLI::Validator number_in(double low, double high) {
  const std::string range = fmt::format("{} .. {}", low, high);
  return number_that([=](double value) { return low <= value && value <= high; }, "a number in " + range, range);
}

CLI::Validator above_zero() {
  return number_that([](double value) { return value > 0; }, "a number above 0", "above 0");
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
