#pragma once
#include "measure/child_process.h"
#include "measure/worker/protocol.h"

namespace gnomon {

/// The worker's own side: answers requests on `socket` until it closes.
int worker_main(int socket, int threads);

/// The answers of a server, by the verb of the request.
class Answers {
 public:
  template <class Request, class Answer>
  void on(Answer answer) {
    answers_[Request::verb] = [answer](const Json& json) {
      return written(typename Request::Reply(answer(message_from<Request>(json, Request::verb))));
    };
  }
  /// Throws Error on a request that has no answer here, or is none.
  Json operator()(const Json& request) const {
    const std::string verb = request.at("do");
    const auto found = answers_.find(verb);
    if (found == answers_.end()) throw Error("a worker cannot {}", verb);
    return found->second(request);
  }

 private:
  std::map<std::string, std::function<Json(const Json&)>> answers_;
};

/// Answers requests about techniques and scenes before any of them is opened (roll_protocol.h).
void answer_roll(Answers& answers);

}  // namespace gnomon
