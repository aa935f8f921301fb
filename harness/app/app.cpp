#include "app/app.h"

#include <fcntl.h>
#include <gnomon/registry.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <system_error>
#include <thread>

#include "measure/cause/own_causes.h"
#include "measure/conformance/child.h"
#include "measure/keeper.h"
#include "measure/notice.h"
#include "measure/paths.h"
#include "measure/printable.h"
#include "measure/program/program_technique.h"
#include "measure/scene/import.h"
#include "measure/worker/build.h"
#include "measure/worker/outside.h"
#include "measure/worker/worker_server.h"

namespace gnomon::app {

namespace {

struct ServeOptions {
  int socket = 0, threads = 0;
};
struct ImportOptions {
  std::string file;
  int descriptor = 0;
};

/// What a message quotes may be anything: control characters are shown as \x1b, so that the message stays one line and does
/// nothing to the terminal; a message of a screen and more loses its middle.
std::string shown(std::string_view text) {
  constexpr std::size_t most_begin = 3000, most_end = 1000;
  if (text.size() > most_begin + most_end)
    return fmt::format("{} ... {}", shown(text.substr(0, most_begin)), shown(text.substr(text.size() - most_end)));
  return printable(text, true);
}

/// The processes that `run`, `check` and the importer start; hidden.
void add_worker(Program& program) {
  const auto add_server = [&](const char* name, const char* description, int (*serve)(int socket, int threads)) {
    auto [server, options] = program.line.command<ServeOptions>(
        name, description, [serve](const ServeOptions& read) { return serve(read.socket, read.threads); });
    server.hide();
    server.option("socket", &options.socket, "", {.is_required = true});
    server.option("threads", &options.threads, "", {.is_required = true});
  };
  add_server("worker", "Serve one technique to the program that started this", worker_main);
  add_server("check-rule", "Check one rule on a technique for the program that started this", conformance::rule_child_main);

  auto [mesh, to_import] = program.line.command<ImportOptions>(
      "import-mesh", "Read a mesh file for the program that started this",
      [](const ImportOptions& read) { return import_child_main(read.file, read.descriptor); });
  mesh.hide();
  mesh.option("file", &to_import.file, "", {.is_required = true});
  mesh.option("descriptor", &to_import.descriptor, "", {.is_required = true});
}

/// Standard input, output and error that were closed lead nowhere: the first file that is opened would take their place. What
/// cannot be written is an error with words, not the end by a signal.
void prepare_process() {
  int nothing = -1;
  do nothing = open("/dev/null", O_RDWR);
  while (nothing >= 0 && nothing <= STDERR_FILENO);
  if (nothing > STDERR_FILENO) close(nothing);
  for (const int number : {SIGPIPE, SIGXFSZ}) std::signal(number, SIG_IGN);
  std::signal(SIGINT, SIG_DFL);  // a shell that runs a script lets its background jobs ignore it: they must end, too
}

/// Whether this process is one of those that the program starts, where techniques run: a worker's command has two numbers
/// behind it.
bool is_where_techniques_run(int argc, char** argv) {
  const std::string_view command = argc > 3 ? argv[argc - 3] : "";
  return command == "worker" || command == "check-rule";
}

}  // namespace

int run_program(int argc, char** argv) {
  prepare_process();
  if (!is_where_techniques_run(argc, argv)) end_orphans_of_keepers();
  try {
    Program program{
        {"Gnomon: shadow techniques side by side, by cost and by error against ray-traced truth", "gnomon", build_text()},
        {},
        {argv, argv + argc}};
    if (argc > 0) program.words.front() = "gnomon";  // wherever it lies
    const auto loaded_by = [&](void (*load)(const std::string&)) {
      return [&program, load](const std::string& path) {
        load(path);
        check_own_causes(registry().techniques());
        program.plugins.push_back(path);
      };
    };
    program.line.early_option("--plugin", "FILE.so", "Load techniques from a plugin built with gnomon_add_plugin",
                              loaded_by(is_where_techniques_run(argc, argv) ? load_plugin : register_plugin));
    program.line.early_option("--program", "FILE.toml", "Load a technique that is a program of its own (docs/protocol.md)",
                              loaded_by([](const std::string& path) { load_program(path); }));
    if (const std::filesystem::path root = find_data_root(); !root.empty()) load_programs_of(root / "techniques");
    check_own_causes(registry().techniques());
    for (auto* add : {add_list,    add_describe, add_check,  add_render,     add_run,    add_edition, add_tune,  add_table,
                      add_compare, add_merge,    add_report, add_analyze,    add_figure, add_certify, add_docs,  add_score,
                      add_site,    add_export,   add_pack,   add_submission, add_cache,  add_view,    add_worker})
      add(program);
    const int status = program.line.run(argc, argv);
    if (std::fflush(stdout) != 0) throw std::system_error(errno, std::generic_category());
    return status;
  } catch (const Error& error) {
    print_notice("gnomon: {}\n", shown(error.what()));
    return 2;
  } catch (const std::filesystem::filesystem_error& error) {
    print_notice("gnomon: {}: {}\n", shown(error.path1().string()), error.code().message());
    return 2;
  } catch (const std::system_error& error) {
    if (error.code() != std::errc::broken_pipe)  // the reader has read enough
      print_notice("gnomon: standard output cannot be written: {}\n", error.code().message());
    return 2;
  } catch (const std::bad_alloc&) {
    print_notice("gnomon: not enough memory for {}\n", shown(joined(std::vector<std::string>(argv, argv + argc), " ")));
    return 1;
  } catch (const std::exception& error) {
    print_notice("gnomon: {}\n", shown(error.what()));
    return 1;
  }
}

Truth parse_truth(const std::string& text) {
  if (text != "shape" && text != "mesh") throw Error("--truth {} is neither shape nor mesh", text);
  return text == "mesh" ? Truth::mesh : Truth::shape;
}

std::filesystem::path timed_folder(const std::string& name) {
  const std::time_t now = std::time(nullptr);
  std::tm local{};
  char time[32];
  std::strftime(time, sizeof time, "%Y%m%d-%H%M%S", localtime_r(&now, &local));
  return std::filesystem::path("runs") / (name + "-" + time);
}

WorkerOptions worker_options(const Program& program, int threads) {
  const int cores = static_cast<int>(std::thread::hardware_concurrency());
  if (threads < 0 || threads > cores) throw Error("--threads {} is outside 1 .. {} cores of this machine", threads, cores);
  return {threads, program.plugins};
}

}  // namespace gnomon::app
