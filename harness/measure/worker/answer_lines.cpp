// What a worker's side of the socket does, whatever it is asked for.
#include <unistd.h>

#include <cerrno>
#include <new>

#include "measure/worker/worker_process.h"
#include "measure/worker/worker_server.h"

namespace gnomon {

void answer_lines(int socket, const std::function<Json(const Json&)>& handle) {
  std::string pending;
  for (;;) {
    const std::size_t end = pending.find('\n');
    if (end == std::string::npos) {
      char chunk[4096];
      const ssize_t n = ::read(socket, chunk, sizeof chunk);
      if (n < 0 && errno == EINTR) continue;
      if (n <= 0) _exit(0);
      pending.append(chunk, static_cast<std::size_t>(n));
      continue;
    }
    Json answer;
    try {
      answer = handle(parse_json(pending.substr(0, end)));
    } catch (const std::bad_alloc&) {
      answer["error"] = "out of memory";
    } catch (const std::exception& error) {
      answer["error"] = error.what();
    } catch (...) {
      answer["error"] = "an exception that is no std::exception";
    }
    pending.erase(0, end + 1);
    if (!write_line(socket, json_text(answer))) _exit(0);
  }
}

}  // namespace gnomon
