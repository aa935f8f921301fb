#include "app/command_line.h"

#include <gnomon/error.h>
#include <gnomon/param.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <ranges>

#include "analysis/analysis.h"

namespace gnomon::app {

namespace {

/// The whole text is a finite number that is good; else the message says that it is not `what`. CLI::Range lets NaN pass.
Check number_that(std::function<bool(double)> is_good, const std::string& what, const std::string& range) {
  const auto error = [=](const std::string& text) -> std::string {
    const std::optional<double> value = number_from(text);
    return value && std::isfinite(*value) && is_good(*value) ? "" : fmt::format("{} is not {}", text, what);
  };
  return {error, range};
}

std::vector<std::string> command_names(const CLI::App& cli) {
  std::vector<std::string> names;
  for (const CLI::App* command : cli.get_subcommands({}))
    if (!command->get_group().empty()) names.push_back(command->get_name());
  return names;
}

/// The first word that is neither an option nor its value, null for none, and the command of that name, null for none.
std::pair<const char*, const CLI::App*> named_command(const CLI::App& cli, int argc, char** argv) {
  for (int k = 1; k < argc; ++k) {
    const std::string word = argv[k];
    if (word.starts_with("-")) {
      const CLI::Option* const option = cli.get_option_no_throw(word);
      if (option && option->get_expected_min() > 0) ++k;
      continue;
    }
    const auto found = cli.get_subcommands([&](const CLI::App* app) { return app->get_name() == word; });
    return {argv[k], found.empty() ? nullptr : found.front()};
  }
  return {nullptr, nullptr};
}

/// What is wrong with the words of the command line. CLI11 only says that an argument was not expected; ours says what there
/// is instead, as everywhere.
std::string usage_error(const CLI::App& cli, const CLI::ParseError& error, int argc, char** argv) {
  const std::vector<std::string> names = command_names(cli);
  const auto [word, command] = named_command(cli, argc, argv);
  if (word && !command)
    return fmt::format("there is no command {}; did you mean {}? There are: {}", word, nearest_word(word, names),
                       joined(names, ", "));
  const std::string who = command ? cli.get_name() + " " + command->get_name() : cli.get_name();
  const std::vector<std::string> extra = cli.remaining(true);
  if (!extra.empty() && extra.front().starts_with("-")) {
    std::vector<std::string> options;
    for (const CLI::Option* option : (command ? *command : cli).get_options())
      for (const std::string& name : option->get_lnames()) options.push_back("--" + name);
    return fmt::format("{} has no option {}; did you mean {}? It has: {}", who, extra.front(),
                       nearest_word(extra.front(), options), joined(options, ", "));
  }
  if (!extra.empty())
    return fmt::format("{} does not know what to do with '{}'; {} --help says what it takes", who, extra.front(), who);
  if (!command) return fmt::format("a command is wanted; there are: {}", joined(names, ", "));
  return fmt::format("{}; {} --help says what is allowed", error.what(), who);
}

}  // namespace

Check not_empty() {
  return {[](const std::string& text) { return std::string(text.empty() ? "the name is empty" : ""); }, ""};
}

Check seconds() {
  const auto is_good = [](double value) { return value > 0 && value <= 86400; };
  return number_that(is_good, "a number of seconds above 0, at most 86400", "SECONDS");
}

Check number_in(double low, double high) {
  const std::string range = fmt::format("{} .. {}", low, high);
  return number_that([=](double value) { return low <= value && value <= high; }, "a number in " + range, range);
}

Check above_zero() {
  return number_that([](double value) { return value > 0; }, "a number above 0", "above 0");
}

Check not_negative() {
  return number_that([](double value) { return value >= 0; }, "a number of 0 or more", "0 or more");
}

Check whole_in(int low, int high) {
  const CLI::Range range(low, high);
  return {[range](const std::string& text) { return range(text); }, range.get_description()};
}

Check one_of(std::vector<std::string> words) {
  const std::string range = joined(words, "|");
  const auto error = [words = std::move(words)](const std::string& text) -> std::string {
    return std::ranges::find(words, text) != words.end() ? "" : fmt::format("'{}' is not {}", text, joined(words, " or "));
  };
  return {error, range};
}

namespace {

/// Throws Error where the command has one of these names ("--mode,--style"): CLI11 of some versions takes "technique" and
/// "--technique" for one.
void require_new(const CLI::App& command, std::string_view names) {
  for (const auto part : std::views::split(names, ',')) {
    std::string_view name(part.begin(), part.end());
    name.remove_prefix(std::min(name.find_first_not_of('-'), name.size()));
    for (const CLI::Option* const other : command.get_options())
      if (other->check_lname(std::string(name)) || other->check_sname(std::string(name)) || other->get_single_name() == name)
        throw Error("command {} has '{}' twice", command.get_name(), name);
  }
}

}  // namespace

CLI::Option* Command::option(std::string_view names, OptionTarget target, std::string_view description,
                             const OptionRules& rules) {
  require_new(*command_, names);
  // CLI11 reads an empty text as 0.
  const CLI::Validator is_not_empty(
      [](const std::string& text) { return std::string(text.empty() ? "a number is wanted" : ""); }, "");
  const auto add = [&](auto* value) {
    CLI::Option* const option = command_->add_option(std::string(names), *value, std::string(description));
    using Value = std::remove_pointer_t<decltype(value)>;
    if constexpr (std::is_arithmetic_v<Value> || std::is_same_v<Value, std::string>)
      if (*value != Value()) option->capture_default_str();
    if constexpr (std::is_arithmetic_v<Value> || std::is_same_v<Value, std::optional<double>> ||
                  std::is_same_v<Value, std::vector<double>>)
      option->check(is_not_empty);
    return option;
  };
  CLI::Option* const option = std::visit(add, target)->required(rules.is_required)->delimiter(rules.delimiter);
  if (rules.check.error) option->check(CLI::Validator(rules.check.error, rules.check.range));
  if (!rules.type_name.empty()) option->type_name(rules.type_name);
  if (rules.needs) option->needs(rules.needs);
  if (rules.excludes) option->excludes(rules.excludes);
  return option;
}

CLI::Option* Command::flag(std::string_view names, bool* target, std::string_view description, CLI::Option* needs) {
  require_new(*command_, names);
  CLI::Option* const flag = command_->add_flag(std::string(names), *target, std::string(description));
  if (needs) flag->needs(needs);
  return flag;
}

void Command::action(std::function<int()> action) {
  command_->callback([chosen = chosen_, action = std::move(action)] { *chosen = action; });
}

void Command::hide() { command_->group(""); }

bool Command::is_given(const std::string& name) const {
  const CLI::Option* const option = command_->get_option_no_throw(name);
  return option && option->count() > 0;
}

CommandLine::CommandLine(const std::string& description, const std::string& program, const std::string& version)
    : cli_(std::make_unique<CLI::App>(description, program)) {
  cli_->require_subcommand(1);
  cli_->set_version_flag("--version", version);
}

CommandLine::~CommandLine() = default;

void CommandLine::early_option(const std::string& name, const std::string& type_name, const std::string& description,
                               const std::function<void(const std::string&)>& use) {
  early_.push_back([=](CLI::App& to) {
    // Without a target: one is cleared when the option comes again.
    to.add_option(name, description)->type_name(type_name)->expected(1)->trigger_on_parse()->each(use);
  });
  early_.back()(*cli_);
}

Command CommandLine::add(const std::string& name, const std::string& description) {
  CLI::App* const command = cli_->add_subcommand(name, description);
  for (const auto& add_early : early_) add_early(*command);
  return {command, &chosen_};
}

int CommandLine::run(int argc, char** argv) {
  try {
    cli_->parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return cli_->exit(error);
    throw Error("{}", usage_error(*cli_, error, argc, argv));
  }
  return chosen_();
}

}  // namespace gnomon::app
