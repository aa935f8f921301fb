// What a worker hears, and what its owner hears of a worker.
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <sstream>

#include "fuzz.h"
#include "measure/cause/causes.h"
#include "measure/foreign_text.h"
#include "measure/paths.h"
#include "measure/pattern.h"
#include "measure/picture/detail_export.h"
#include "measure/run/suite.h"
#include "measure/scene/blob.h"
#include "measure/worker/worker_client.h"
#include "measure/worker/worker_server.h"

namespace fuzz {

using namespace gnomon;
namespace fs = std::filesystem;

namespace {

constexpr const char* replies_variable = "GNOMON_FUZZ_REPLIES";

/// What a worker writes for 4x4 pixels, of which two are explained.
std::string file_beside_reply(const std::string& asked) {
  if (asked == "explain") return text_of(explanation_bytes(std::vector<std::optional<Explanation>>(2)));
  if (asked == "detail") return text_of(detail_bytes({}));
  return std::string((asked == "debug" ? 3 : 1) * 16 * sizeof(float), 0);
}

}  // namespace

Outcome read_settings(const fs::path& file, const std::string& bytes) {
  if (file.extension() == ".filter") {
    Pattern(bytes, "is no expression")
        .is_in("single_triangle point shadow_map:resolution=512,filter=pcf aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa");
  } else if (file.extension() == ".size") {
    parse_size(bytes, "--size");
  } else {
    parse_contenders(bytes);
  }
  return Outcome::accepted;
}

Answer read_requests(const fs::path&, const std::string& bytes) {
  int ends[2];
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) throw Problem{"no socket"};
  const pid_t worker = fork();
  if (worker == 0) {
    close(ends[0]);
    _exit(worker_main(ends[1], 1));
  }
  close(ends[1]);
  // Answers are read beside, lest both wait for each other.
  const pid_t writer = fork();
  if (writer == 0) {
    std::istringstream lines(bytes);
    for (std::string line; std::getline(lines, line) && write_line(ends[0], line);) {
    }
    shutdown(ends[0], SHUT_WR);
    _exit(0);
  }
  std::string answers;
  char chunk[4096];
  for (ssize_t n = 0; (n = read(ends[0], chunk, sizeof chunk)) > 0;) answers.append(chunk, static_cast<std::size_t>(n));
  close(ends[0]);
  int status = 0;
  waitpid(writer, nullptr, 0);
  waitpid(worker, &status, 0);
  if (WIFSIGNALED(status)) throw Problem{"the worker crashed by signal " + std::to_string(WTERMSIG(status))};
  if (WEXITSTATUS(status) != 0) throw Problem{"the worker ended with " + std::to_string(WEXITSTATUS(status))};
  if (const std::size_t error = answers.find("\"error\""); error != answers.npos)
    return {Outcome::refused, answers.substr(error, answers.find('\n', error) - error)};
  return Outcome::accepted;
}

int say_replies(int socket) {
  const std::string file = std::getenv(replies_variable);
  const std::string bytes = read_foreign_text(file, file, 1 << 20);
  std::istringstream lines(bytes);
  std::string heard;
  char c = 0;
  for (std::string line; read(socket, &c, 1) == 1;) {
    heard += c;
    if (c != '\n') continue;
    const Json request = parse_if_json(heard);
    heard.clear();
    for (const char* file : {"mask", "out"})
      if (request.contains(file)) write_file(request[file].get<std::string>(), file_beside_reply(request["do"]));
    if (!std::getline(lines, line)) return 0;
    write_line(socket, line);
  }
  return 0;
}

Outcome read_replies(const fs::path& file, const std::string&) {
  setenv(replies_variable, file.c_str(), 1);
  WorkerClient client({.threads = 0, .plugins = {}, .program = program_path().string()}, file.parent_path() / "w", 3);
  try {
    client.load({.scene_file = "none", .technique = "unshadowed", .settings = ""});
    client.frame({.gbuffer_file = "none", .width = 4, .height = 4, .truth = Truth::mesh, .seen = SceneLightAndView{}});
    client.answer();
    const std::uint32_t pixels[] = {0, 5};
    client.explain(pixels);
    client.debug_layer("map");
    client.surface_detail();
    client.set("a=1");
    client.time(Stage::build);
  } catch (const WorkerFailure& failure) {
    throw Error("{}", failure.what());
  }
  return Outcome::accepted;
}

}  // namespace fuzz
