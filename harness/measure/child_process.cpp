#include "measure/child_process.h"

#include <fmt/format.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <new>

namespace gnomon {

Launch::Launch(std::vector<std::string> command, const Variables& variables) : words(std::move(command)) {
  for (char** entry = environ; *entry; ++entry) {
    const std::string_view name = std::string_view(*entry).substr(0, std::string_view(*entry).find('='));
    if (std::ranges::none_of(variables, [&](const auto& variable) { return variable.first == name; }))
      environment.emplace_back(*entry);
  }
  for (const auto& [name, value] : variables)
    if (!value.empty()) environment.push_back(fmt::format("{}={}", name, value));
  for (std::string& word : words) argv.push_back(word.data());
  for (std::string& variable : environment) envp.push_back(variable.data());
  argv.push_back(nullptr);
  envp.push_back(nullptr);
}

bool comes_within(int milliseconds, const std::function<bool()>& is_over) {
  for (int waited = 0; waited <= milliseconds; ++waited) {
    if (is_over()) return true;
    usleep(1000);
  }
  return false;
}

bool write_line(int socket, const std::string& line) {
  const std::string bytes = line + '\n';
  for (std::size_t sent = 0; sent < bytes.size();) {
    const ssize_t n = send(socket, bytes.data() + sent, bytes.size() - sent, MSG_NOSIGNAL);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return false;
    sent += static_cast<std::size_t>(n);
  }
  return true;
}

bool read_more(int descriptor, std::string& pending) {
  char chunk[65536];
  const ssize_t n = ::read(descriptor, chunk, sizeof chunk);
  if (n > 0) pending.append(chunk, static_cast<std::size_t>(n));
  return n > 0 || (n < 0 && errno == EINTR);
}

void answer_lines(int socket, const std::function<Json(const Json&)>& handle) {
  std::string pending;
  for (;;) {
    const std::size_t end = pending.find('\n');
    if (end == std::string::npos) {
      if (!read_more(socket, pending)) _exit(0);
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
