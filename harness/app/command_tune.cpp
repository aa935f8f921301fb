// gnomon tune: the setting of a technique that costs least, or errs least, within limits.
#include "app/app.h"
#include "app/table_options.h"
#include "app/tune_run.h"
#include "measure/counted.h"
#include "measure/notice.h"
#include "measure/run/estimate.h"
#include "measure/scene/blob.h"
#include "measure/worker/machine_context.h"
#include "report/figure/figure.h"

namespace gnomon::app {

namespace {

namespace fs = std::filesystem;

struct TuneOptions {
  std::string technique, error, least = "cost=light", over = "worst", hold_out, budget, size, shard, pictures = "all";
  std::vector<std::string> techniques, scenes, lights, views, each, replay;
  std::string keep;
  int processes = 0, seed = 1, threads = 0;
  std::optional<double> timeout;
  RunOptions run;
  TableWidth width;
  bool dry_run = false, quiet = false;
};

/// "10min", "90s", "1.5h", or seconds. Throws Error.
double duration_from(const std::string& text) {
  const std::size_t end = text.find_first_not_of("0123456789.");
  const std::string unit = end == text.npos ? "s" : text.substr(end);
  static constexpr std::pair<std::string_view, double> units[] = {{"s", 1}, {"min", 60}, {"h", 3600}};
  const auto found = std::ranges::find(units, unit, &std::pair<std::string_view, double>::first);
  const std::optional<double> number = number_from(text.substr(0, end));
  if (!number || !(*number > 0) || found == std::end(units))
    throw Error("--budget {} is no time; write a number above 0 with s, min or h, as in 10min", text);
  return *number * found->second;
}

std::vector<TuneSpace> spaces_of(const TuneOptions& options, const TuneMatter& matter) {
  std::vector<std::string> texts = listed(options.technique);
  texts.insert(texts.end(), options.techniques.begin(), options.techniques.end());
  if (texts.empty())
    throw Error("tune needs a technique, as in 'gnomon tune shadow_map', or --technique shadow_map:resolution=*");
  std::vector<TuneSpace> spaces;
  std::vector<std::string> skipped;
  double count = 0;
  for (const std::string& text : texts) {
    spaces.push_back(tune_space(text, matter));
    count += spaces.back().grid.count();
    skipped.insert(skipped.end(), spaces.back().skipped.begin(), spaces.back().skipped.end());
  }
  if (count < 2)
    throw Error(
        "{} has one setting{}, and there is nothing to choose; give a parameter * or values in braces, as in "
        "shadow_map:resolution={{512,1024}}",
        joined(texts, ", "), skipped.empty() ? "" : fmt::format(", without an effect here: {}", joined(skipped, ", ")));
  return spaces;
}

TuneGoal goal_of(const TuneOptions& options, const Command& command) {
  TuneGoal goal{.least = tuned_number(options.least), .each = {}};
  if (!options.error.empty()) goal.each = tune_limits("error<=" + options.error);
  for (const std::string& text : options.each)
    for (TuneLimit& limit : tune_limits(text)) goal.each.push_back(std::move(limit));
  if (goal.each.empty() && !command.is_given("--least") && options.keep.empty())
    throw Error(
        "tune needs a limit, or the cheapest setting is the one that errs most: --error 1%, --each 'error<=1%', or --least "
        "error");
  goal.over = options.over == "mean" ? TuneOver::mean : TuneOver::worst;
  return goal;
}

TunePlan plan_of(TuneOptions& options, const Command& command, const Program& program) {
  TunePlan plan;
  plan.spaces = spaces_of(options, {});
  plan.goal = goal_of(options, command);
  plan.run = options.run;
  if (options.scenes.empty()) throw Error("tune needs a scene: --scene bunny, or --scene FILE");
  plan.seed = static_cast<std::uint64_t>(options.seed);
  if (!options.budget.empty()) plan.budget = duration_from(options.budget);
  plan.processes = options.processes;
  plan.is_quiet = options.quiet;
  plan.holds_out_places = options.hold_out == "place" || (options.hold_out.empty() && options.scenes.size() == 1);
  Suite& suite = plan.run.suite;
  suite.name = "tune";
  if (!options.size.empty()) std::tie(suite.width, suite.height) = parse_size(options.size, "--size");
  if (options.timeout) suite.timeout = *options.timeout;
  if (options.pictures == "none") suite.pictures = Suite::Pictures::none;
  if (options.lights == std::vector<std::string>{"all"}) options.lights.clear();
  suite.groups.push_back({options.scenes, options.lights, options.views, {}});
  plan.run.command = program.words;
  plan.run.worker = worker_options(program, options.threads);
  if (!options.shard.empty()) std::tie(plan.run.shard_index, plan.run.shard_count) = parse_shard(options.shard);
  if (plan.run.out.empty()) {
    if (plan.run.resume) throw Error("--resume needs --out: which folder to continue");
    plan.run.out = timed_folder(suite.name);
  }
  return plan;
}

/// What the scenes and the goal of the plan have. Scenes that are not fetched count for nothing.
TuneMatter matter_of(const TunePlan& plan, SceneLibrary& library) {
  TuneMatter matter{.has_holes = false, .has_glass = false, .has_motion = false, .has_costs = plan.goal.counts_costs()};
  for (const std::string& reference : plan.run.suite.groups.front().scenes) {
    const std::optional<Scene>& scene = library.get(reference).scene;
    matter.has_holes = matter.has_holes || (scene && scene->has_alpha_masks());
    matter.has_glass = matter.has_glass || (scene && scene->has_transmission());
  }
  return matter;
}

/// The levels of every parameter, how many evaluations there are and about how long they take.
void print_plan(const TunePlan& plan, Tuning& tuning, std::size_t width) {
  for (const TuneSpace& space : plan.spaces) {
    const double count = space.grid.count(), raw_count = space.grid.raw_count();
    fmt::print(
        "{}{}: {:.0f} settings{}\n", space.technique, space.fixed.empty() ? "" : ":" + space.fixed, count,
        count < raw_count ? fmt::format(" of {:.0f} combinations; others differ where it has no effect", raw_count) : "");
    TextTable table({{"parameter", ""}, {"values", ""}, {"has an effect", ""}});
    for (const TuneSpace::Parameter& parameter : space.parameters)
      table.add_row({parameter.name, joined(parameter.values, ", "),
                     parameter.condition.empty() ? "always" : "for " + parameter.condition});
    fmt::print("{}{}\n", table.text(width),
               space.skipped.empty() ? "" : fmt::format("skipped where it has no effect: {}\n", joined(space.skipped, ", ")));
  }
  const double possible = tuning.possible();
  const double asked = tuning.is_whole() ? possible : std::min(most_evaluations, possible / 5);
  fmt::print("{}{}; {:.0f} evaluations, of which {}{:.0f} are run\n", counted(tuning.place_count(), "place{s}"),
             plan.holds_out_places && tuning.place_count() > 2 ? ", a quarter of them held out" : "", possible,
             tuning.is_whole() ? "all " : "at most ", asked);
  std::vector<RowCost> costs = own_history().read();
  for (RowCost& cost : shipped_costs()) costs.push_back(std::move(cost));
  const Estimator estimate(std::move(costs), machine_name(machine_context(plan.run.worker.threads)));
  const std::vector<Job> jobs = tuning.first_jobs();
  TimeEstimate time = estimate(jobs, {1, tuning.search_suite().warmups, tuning.search_suite().repetitions});
  time.seconds *= asked / static_cast<double>(jobs.size());
  fmt::print("{}, before the finalists\n", text(time));
}

/// Draws what each parameter did to the first number with a limit, else to the goal. Without gnuplot there is a note.
void draw_parameters_of(const TuneReport& report, std::span<const Record> records, const fs::path& folder) {
  std::vector<Record> of_answer;
  for (const Record& record : records)
    if (record.technique == report.rows.front().rows.front()->technique) of_answer.push_back(record);
  FigureOptions figure;
  figure.analysis.metric = report.goal.each.empty() ? report.goal.least.name : report.goal.each.front().number.name;
  if (figure.analysis.metric == "light_ms" || figure.analysis.metric == "geometry_ms") figure.analysis.metric = "error";
  const fs::path out = folder / "parameters.svg";
  try {
    run_gnuplot(figure_script(of_answer, "parameters", figure, out), out);
    fmt::print("{}  what each parameter did\n", out.string());
  } catch (const Error& error) {
    print_notice("note: no figure of what each parameter did: {}\n", error.what());
  }
}

int tune(TuneOptions& options, const Command& command, const Program& program) {
  if (!options.replay.empty()) {
    if (!options.technique.empty() || !options.techniques.empty() || !options.scenes.empty())
      throw Error("--replay searches what its files hold: it goes with no technique and no --scene");
    print_replays(options.replay, goal_of(options, command), static_cast<std::uint64_t>(options.seed), options.width.columns());
    return 0;
  }
  TunePlan plan = plan_of(options, command, program);
  SceneLibrary library;
  if (plan.run.resume) use_recorded_scenes(plan.run.out, plan.run.suite, library);
  plan.spaces = spaces_of(options, matter_of(plan, library));
  if (!options.keep.empty()) {
    keep_grid(std::move(plan), library, options.keep);
    return 0;
  }
  const fs::path out = plan.run.out;
  Tuning tuning(plan, library);
  if (options.dry_run) {
    print_plan(plan, tuning, options.width.columns());
    return 0;
  }
  tuning.search();
  if (tuning.is_shard()) {
    fmt::print(
        "shard {}/{} has {} of the first round in {}; gnomon merge joins the shards, and gnomon tune with --resume "
        "decides in the joined folder\n",
        plan.run.shard_index, plan.run.shard_count, counted(tuning.row_count(), "row{s}"), out.string());
    return 0;
  }
  const TuneReport report = tuning.decided();
  const std::vector<Record> records = read_records(out);
  write_tables(out, records);
  write_file(out / "tune.txt", tune_text(report, 0));
  fmt::print("{}\n", tune_text(report, options.width.columns()));
  fmt::print("{}  this text; the folder is that of a run: gnomon report {}\n", (out / "tune.txt").string(), out.string());
  draw_parameters_of(report, records, out);
  return report.is_feasible ? 0 : 1;
}

}  // namespace

void add_tune(Program& program) {
  auto [command, options] = program.line.command<TuneOptions>(
      "tune", "The cheapest setting that keeps limits at every place, or the one that errs least",
      [&program](TuneOptions& read, const Command& given) { return tune(read, given, program); });
  command.option("id", &options.technique, "ID: all of its parameters; as --technique ID:*");
  command.option("--technique", &options.techniques,
                 "ID:param=*,...: its levels; {a,b}: these; else one value. Again for another technique", {.delimiter = ';'});
  command.option("--scene", &options.scenes, "Scene ids or files");
  command.option("--light", &options.lights, "Light names; all of each scene by default", {.delimiter = ','});
  command.option("--view", &options.views, "View names, * in one stands for any letters; each scene's first by default",
                 {.check = not_empty(), .delimiter = ','});
  command.option("--error", &options.error, "Largest error at each place: 1%; as --each 'error<=1%'", {.check = not_empty()});
  command.option("--least", &options.least, "What is to be least: cost=light, cost=COST, error, or another number of a row",
                 {.check = not_empty()});
  command.option("--each", &options.each, "Limits at each place: 'resolve_ms<=5,MiB<=8'");
  command.option("--over", &options.over, "What counts of the places: worst or mean", {.check = one_of({"worst", "mean"})});
  command.option("--hold-out", &options.hold_out,
                 "scene: each in turn; place: a quarter of lights and views, too; none. By default place for one scene",
                 {.check = one_of({"scene", "place", "none"})});
  command.option("--keep", &options.keep,
                 "Run every setting for its error and bytes alone, and write them as a table to this file",
                 {.check = not_empty()});
  command.option("--replay", &options.replay,
                 "Search grids whose every evaluation was kept, as in results/tune_grids/*.csv; nothing is run",
                 {.check = not_empty()});
  command.option("--budget", &options.budget, "Time of the search: 10min, 90s, 1h; without limit by default",
                 {.check = not_empty()});
  command.option("--seed", &options.seed, "Of what is held out, and of where a search begins",
                 {.check = whole_in(0, 1'000'000'000)});
  command.option("--size", &options.size, "Picture size in pixels, WxH", {.check = not_empty()});
  command.option("--pictures", &options.pictures, "all: finalists leave masks and pictures; none",
                 {.check = one_of({"all", "none"})});
  command.option("--processes", &options.processes, "Fresh processes of each finalist; 5 by default, 15 of those that are tied",
                 {.check = whole_in(1, 1000)});
  command.option("--threads", &options.threads, "Pin workers to this many cores; all by default");
  command.option("--timeout", &options.timeout, "Seconds that one step of a worker may take", {.check = seconds()});
  command.option("--out", &options.run.out, "Folder to write to; runs/tune-TIME by default", {.check = not_empty()});
  command.option("--shard", &options.shard, "I/N: part I of N of the first round; gnomon merge joins them",
                 {.check = not_empty()});
  const auto resume = command.flag("--resume", &options.run.resume, "Continue in --out, and decide again from what is there");
  command.flag("--retry-failed", &options.run.retry_failed, "With --resume: rows that failed are run again", resume);
  command.flag("--rebuilt", &options.run.rebuilt, "With --resume: rows that other code measured are run again", resume);
  command.flag("--dry-run", &options.dry_run, "Print the levels and how many evaluations there are; run nothing");
  command.flag("--quiet", &options.quiet, "No progress");
  add_width_options(command, options.width);
}

}  // namespace gnomon::app
