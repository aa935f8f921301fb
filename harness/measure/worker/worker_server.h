#pragma once
#include <functional>
#include <map>
#include <string>

#include "measure/worker/protocol.h"

namespace gnomon {

/// The worker's own side: answers requests on `socket` until it closes.
int worker_main(int socket, int threads);

/// Answers each line of JSON on `socket` by what `handle` makes of it, an exception by {"error": text}; ends the process when
/// the other side is gone.
[[noreturn]] void answer_lines(int socket, const std::function<Json(const Json&)>& handle);

/// What a server answers, by the verb of the request.
class Answers {
 public:
  template <class Request, class Answer>
  void on(Answer answer) {
    answers_[Request::verb] = [answer](const Json& json) {
      return written(typename Request::Reply(answer(message_from<Request>(json, Request::verb))));
    };
  }
  /// Throws Error on a request that nobody answers, or that is none.
  Json operator()(const Json& request) const {
    const std::string verb = request.at("do");
    const auto found = answers_.find(verb);
    if (found == answers_.end()) throw Error("a worker cannot {}", verb);
    return found->second(request);
  }

 private:
  std::map<std::string, std::function<Json(const Json&)>> answers_;
};

}  // namespace gnomon
