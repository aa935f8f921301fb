#pragma once
// The other end of Child in gnomon_engine.py: a renderer between an engine's library and its adapter.
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <iostream>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>

using Json = nlohmann::json;

/// Reads lines of JSON on standard input and answers each by one line on the file descriptor that the variable GNOMON_ANSWERS
/// names, until the input ends. The key "do" chooses a member of the renderer: hello, load, relight or frame, each from Json to
/// Json. What it throws is answered as "error". Returns an exit status.
template <class Renderer>
int serve(Renderer& renderer) {
  const char* const descriptor = std::getenv("GNOMON_ANSWERS");
  std::FILE* const answers = descriptor ? fdopen(std::atoi(descriptor), "w") : stdout;
  if (!answers) return EXIT_FAILURE;
  const auto answer = [&](const Json& request) -> Json {
    const std::string what = request.at("do");
    if (what == "hello") return renderer.hello(request);
    if (what == "load") return renderer.load(request);
    if (what == "relight") return renderer.relight(request);
    if (what == "frame") return renderer.frame(request);
    throw std::runtime_error("it cannot " + what);
  };
  for (std::string line; std::getline(std::cin, line);) {
    Json said;
    try {
      said = answer(Json::parse(line));
    } catch (const std::exception& problem) {
      said = {{"error", problem.what()}};
    }
    std::fprintf(answers, "%s\n", said.dump().c_str());
    std::fflush(answers);
  }
  return EXIT_SUCCESS;
}
