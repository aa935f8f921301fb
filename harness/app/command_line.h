#pragma once
// What the commands take, described without the parser: with CLI11 a command took about twice as long to compile, so that only
// command_line.cpp includes it.
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace gnomon::app {

/// Where the value of an option goes; it must live until the command has run. A list takes one value or more.
using OptionTarget = std::variant<std::string*, std::filesystem::path*, int*, double*, std::optional<double>*,
                                  std::vector<std::string>*, std::vector<std::filesystem::path>*, std::vector<double>*>;

/// A condition that the text of a value must meet; without a function there is none.
struct Check {
  std::function<std::string(const std::string&)> error = {};  ///< what is wrong with the text; "" when nothing is
  std::string range = {};                                     ///< for the help, beside the kind of the value: "above 0"
};

Check not_empty();                             ///< a name: "" is none
Check seconds();                               ///< a number above 0, at most a day
Check number_in(double low, double high);      ///< the whole text is a finite number, `low` and `high` included
Check above_zero();                            ///< the whole text is a finite number above 0
Check not_negative();                          ///< the whole text is a finite number, 0 or more
Check whole_in(int low, int high);             ///< a whole number, `low` and `high` included
Check one_of(std::vector<std::string> words);  ///< the text is one of them

/// Further properties of an option.
struct OptionRules {
  bool is_required = false;
  Check check = {};
  char delimiter = 0;               ///< of a list: also splits one text into values
  std::string type_name = {};       ///< what the help writes for the value
  CLI::Option* needs = nullptr;     ///< given without that one, it is refused
  CLI::Option* excludes = nullptr;  ///< given with that one, it is refused
};

inline const OptionRules no_rules;

/// One command, to which its options are added. A handle: copies refer to the same command.
class Command {
 public:
  Command(CLI::App* command, std::function<int()>* chosen) : command_(command), chosen_(chosen) {}

  /// Names with dashes ("--error,--metric") are an option, one without is a positional argument. The help prints the text or
  /// number that the target has now, unless that is empty or 0.
  CLI::Option* option(std::string_view names, OptionTarget target, std::string_view description = "",
                      const OptionRules& rules = no_rules);
  CLI::Option* flag(std::string_view names, bool* target, std::string_view description, CLI::Option* needs = nullptr);
  /// What the command does, after its words were read into their targets; returns the exit status.
  void action(std::function<int()> action);
  /// Leaves the command out of the help and of the lists of commands.
  void hide();
  /// Whether the words hold this option; false also when the command has none of that name.
  bool is_given(const std::string& name) const;

 private:
  CLI::App* command_;
  std::function<int()>* chosen_;
};

/// The words after the program's name: options before the command, the command, and what that one takes.
class CommandLine {
 public:
  CommandLine(const std::string& description, const std::string& program, const std::string& version);
  ~CommandLine();

  /// An option that may be given again, before the command or among what the command takes; `use` gets each value when it is
  /// read, before the command runs. Commands that are added later take it.
  void early_option(const std::string& name, const std::string& type_name, const std::string& description,
                    const std::function<void(const std::string&)>& use);
  /// A command, which stores what it read in a struct, and that struct with its defaults. `work` does what the
  /// command is for, called with the options, or with the options and the command; returns the exit status, or nothing for 0.
  template <class Options, class Work>
  std::pair<Command, Options&> command(const std::string& name, const std::string& description, Work work) {
    Command added = add(name, description);
    const auto options = std::make_shared<Options>();
    const auto call = [=] {
      if constexpr (std::is_invocable_v<Work, Options&, const Command&>)
        return work(*options, added);
      else
        return work(*options);
    };
    added.action([=] {
      if constexpr (!std::is_void_v<decltype(call())>) return call();
      call();
      return 0;
    });
    return {added, *options};
  }

  /// Reads the words and runs the command that they name; returns its exit status. Prints the help or the version on request.
  /// Throws Error, which lists the valid words, when the words name no command or not what it takes.
  int run(int argc, char** argv);

 private:
  Command add(const std::string& name, const std::string& description);

  std::unique_ptr<CLI::App> cli_;
  std::vector<std::function<void(CLI::App&)>> early_;  ///< each adds an early option to the program or to a command
  std::function<int()> chosen_;
};

}  // namespace gnomon::app
