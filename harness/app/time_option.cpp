#include "app/time_option.h"

#include "measure/scene/time_reference.h"

namespace gnomon::app {

void add_time_option(Command& command, TimeOption& option, const std::string& alone) {
  const auto time =
      command.option("--time", &option.seconds,
                     "Seconds at which a scene that moves is shown, as SCENE@SECONDS; as its file has it by default",
                     {.check = not_negative()});
  command.option("--animation", &option.animation,
                 alone + (alone.empty() ? "With" : "; with") + " --time: animation of the scene; the first by default",
                 {.check = not_empty(), .needs = alone.empty() ? time : nullptr});
}

void put_time(std::string& scene, const TimeOption& option) {
  std::vector<double> times;
  if (option.seconds) times.push_back(*option.seconds);
  scene = at_times({scene}, option.animation, times).front();
}

}  // namespace gnomon::app
