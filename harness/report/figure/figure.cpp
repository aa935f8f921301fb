#include "report/figure/figure.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>

#include "measure/part_file.h"
#include "measure/scratch_folder.h"
#include "report/figure/figure_script.h"

extern char** environ;

namespace gnomon {

namespace fs = std::filesystem;

namespace {

struct FigureKind {
  std::string_view name;
  void (*draw)(std::span<const Record>, FigureScript&);
};
constexpr FigureKind drawn[] = {{"front", draw_front}, {"growth", draw_growth},         {"stages", draw_stages},
                                {"map", draw_map},     {"causes", draw_causes},         {"motion", draw_motion},
                                {"sweep", draw_sweep}, {"parameters", draw_parameters}, {"sheet", draw_sheet}};

/// The texts behind a comment's beginning in a program, one a line.
std::vector<std::string> comments(const std::string& script, std::string_view beginning) {
  std::vector<std::string> texts;
  std::istringstream lines(script);
  for (std::string line; std::getline(lines, line);)
    if (line.starts_with(beginning)) texts.push_back(line.substr(beginning.size()));
  return texts;
}

std::string escaped(std::string_view text) {
  std::string safe;
  for (const char c : text) safe += c == '&' ? "&amp;" : c == '<' ? "&lt;" : c == '>' ? "&gt;" : std::string(1, c);
  return safe;
}

/// gnuplot calls an SVG "Gnuplot" and its curves "gnuplot_plot_1", which browsers show: they get the names that the program
/// says.
void name_parts(const fs::path& svg, const std::string& script) {
  std::ifstream file(svg);
  const std::string drawn(std::istreambuf_iterator<char>(file), {});
  std::vector<std::string> names = comments(script, "# Shows: ");
  std::ranges::move(comments(script, "# Curve: "), std::back_inserter(names));
  constexpr std::string_view opening = "<title>", closing = "</title>";
  std::string named;
  std::size_t from = 0, count = 0;
  for (std::size_t at; (at = drawn.find(opening, from)) != drawn.npos && count < names.size(); ++count) {
    named += drawn.substr(from, at - from) + std::string(opening) + escaped(names[count]);
    from = drawn.find(closing, at);
  }
  named += drawn.substr(from);
  // A program of other hands may draw more or fewer curves than it names.
  if (count == names.size() && drawn.find(opening, from) == drawn.npos) std::ofstream(svg) << named;
}

}  // namespace

std::vector<std::string> figure_kinds() { return names_in(drawn); }

std::string figure_script(std::span<const Record> records, const std::string& kind, const FigureOptions& options,
                          const fs::path& out) {
  require_word("there is no figure", kind, figure_kinds());
  FigureScript script(options);
  std::ranges::find(drawn, kind, &FigureKind::name)->draw(records, script);
  return script.text(out);
}

void run_gnuplot(const std::string& script, const fs::path& out) {
  const fs::path target = replaced_file(out), folder = target.has_parent_path() ? target.parent_path() : fs::path(".");
  // gnuplot writes where the program says; it runs in a folder of its own, from which the finished file is moved.
  const ScratchFolder scratch = ScratchFolder::in(folder, ".gnomon-figure");
  const fs::path program = scratch.path() / "figure.gp", output = scratch.path() / "output";
  std::ofstream(program) << script;
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addchdir_np(&actions, scratch.path().c_str());
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "output", O_WRONLY | O_CREAT | O_EXCL, 0644);
  posix_spawn_file_actions_adddup2(&actions, STDOUT_FILENO, STDERR_FILENO);
  const char* const arguments[] = {"gnuplot", "figure.gp", nullptr};
  pid_t child = 0;
  const int code = posix_spawnp(&child, "gnuplot", &actions, nullptr, const_cast<char* const*>(arguments), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (code == ENOENT)
    throw Error(
        "there is no gnuplot, which draws the figures; the Debian package gnuplot-nox has it. --script prints the "
        "program that it would run");
  if (code != 0) throw Error("no process for gnuplot: {}", std::strerror(code));
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) continue;
  const fs::path made = scratch.path() / out.filename();
  std::ifstream said(output);
  const std::string complaint(std::istreambuf_iterator<char>(said), {});
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0 || !fs::exists(made) || fs::file_size(made) == 0)
    throw Error("gnuplot could not draw {}: {}", out.string(), complaint.empty() ? "it said nothing" : complaint);
  if (out.extension() == ".svg") name_parts(made, script);
  fs::rename(made, target);
}

}  // namespace gnomon
