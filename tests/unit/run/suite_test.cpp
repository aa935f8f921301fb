#include "measure/run/suite.h"

#include <gnomon/error.h>
#include <gnomon/registry.h>
#include <gtest/gtest.h>

#include "measure/program/program_technique.h"
#include "measure/run/jobs.h"
#include "measure/scene/blob.h"
#include "places.h"
#include "suite_files.h"

namespace suite_test {

using namespace gnomon;
using suite_files::error_of, suite_files::File, suite_files::group, suite_files::trouble;

std::vector<std::string> names(const std::string& text) {
  std::vector<std::string> result;
  for (const Contender& contender : parse_contenders(text)) result.push_back(contender.name());
  return result;
}

/// Once in the process: what the program itself loads when it starts.
void load_programs_of_the_tree() {
  [[maybe_unused]] static const bool is_done = (load_programs_of(tree_file("techniques")), true);
}

std::string refused(const std::string& text) {
  return error_of([&] { parse_contenders(text); });
}

TEST(contenders, settings_come_out_canonical) {
  EXPECT_EQ(names("unshadowed"), std::vector<std::string>{"unshadowed"});
  EXPECT_EQ(names("shadow_map:resolution=0512"), std::vector<std::string>{"shadow_map:resolution=512"});
  EXPECT_EQ(names("shadow_map:filter=pcf,resolution=512"), names("shadow_map:resolution=512,filter=pcf"));
  EXPECT_EQ(names("shadow_map:resolution=1024"), std::vector<std::string>{"shadow_map"}) << "1024 is the default";
}

TEST(suite, scenes_take_braces_and_groups_take_sizes_and_paths) {
  const File file(
      "[[group]]\nscenes = [\"sphere_field:count={4,9}\"]\nlights = [\"sun\"]\npaths = [\"camera_slide\"]\n"
      "sizes = [\"64x36\", \"32x18\"]\ntechniques = [\"unshadowed\"]\n");
  SceneLibrary library;
  const std::vector<Job> jobs = expand_jobs(read_suite(file.path), library, {.program = tested_program()}).jobs;
  ASSERT_EQ(jobs.size(), 4u);
  EXPECT_EQ(jobs[0].title(), "sphere_field:count=4 sun camera_slide unshadowed");
  EXPECT_EQ(jobs[1].width, 32);
  EXPECT_EQ(jobs[1].height, 18);
  EXPECT_EQ(jobs[2].scene, "sphere_field:count=9");
  for (std::size_t k = 0; k < jobs.size(); ++k) EXPECT_EQ(jobs[k].place, k);
}

TEST(suite, times_make_a_still_of_each_scene_at_each_time) {
  const File file(
      "[[group]]\nscenes = ['fence:count={4,9}']\ntime = [0, 0.50]\ntechniques = ['unshadowed']\n"
      "[[group]]\nscenes = ['a', 'b.glb']\nanimation = 'walk'\ntime = 2\ntechniques = ['unshadowed']\n"
      "[[group]]\nscenes = ['c@walk=01', 'd@{0,1}', 'e']\ntechniques = ['unshadowed']\n");
  const Suite suite = read_suite(file.path);
  using Words = std::vector<std::string>;
  EXPECT_EQ(suite.groups.at(0).scenes, (Words{"fence:count=4@0", "fence:count=4@0.5", "fence:count=9@0", "fence:count=9@0.5"}));
  EXPECT_EQ(suite.groups.at(1).scenes, (Words{"a@walk=2", "b.glb@walk=2"}));
  EXPECT_EQ(suite.groups.at(2).scenes, (Words{"c@walk=1", "d@0", "d@1", "e"}));
}

TEST(suite, what_is_wrong_with_times_is_said) {
  const auto wrong = [](const std::string& keys) { return trouble(group + keys); };
  EXPECT_EQ(wrong("time = -1\n"), "group.time = -1 is not seconds, 0 or more (FILE:4)");
  EXPECT_EQ(wrong("time = [0, inf]\n"), "group.time = inf is not seconds, 0 or more (FILE:4)");
  EXPECT_EQ(wrong("time = 'now'\n"), "group.time = a text is not a number or numbers (FILE:4)");
  EXPECT_EQ(wrong("time = [0, 'now']\n"),
            "group.time = a list with something else is not a number or an array of numbers (FILE:4)");
  EXPECT_EQ(wrong("time = []\n"), "group.time = [] is not a number or an array of numbers (FILE:4)");
  EXPECT_EQ(
      wrong("animation = 'walk'\n"),
      "group.animation = walk is of stills and needs group.time; rows that follow it frame by frame are group.animations = "
      "[\"walk\"] (FILE:4)");
  EXPECT_EQ(wrong("animation = ''\ntime = 0\n"), "group.animation = '' is not the name of an animation (FILE:4)");
  EXPECT_EQ(wrong("animation = 'Walk'\ntime = 0\n"),
            "animation = 'Walk' is not a name of a..z, 0..9 and _, at most 100 of them (FILE:1)");
  EXPECT_EQ(trouble("[[group]]\nscenes = ['contact@1']\ntime = 2\ntechniques = ['unshadowed']\n"),
            "scene contact@1 has a time already, and gets another: 2 (FILE:1)");
}

TEST(suite, a_still_of_a_scene_without_motion_is_refused_before_anything_runs) {
  const File file(group + "time = 1\n");
  SceneLibrary library;
  const std::string what = error_of([&] { expand_jobs(read_suite(file.path), library, {.program = tested_program()}); });
  EXPECT_EQ(what.find("scene contact has no animation"), 0u) << what;
}

TEST(suite, what_is_wrong_with_sizes_and_paths_is_said) {
  const std::string head = "[[group]]\nscenes = [\"contact\"]\ntechniques = [\"unshadowed\"]\n";
  EXPECT_EQ(trouble(head + "sizes = [\"64x\"]\n"), "group.sizes 64x is not WxH with W and H of 1 .. 16384 pixels (FILE:1)");
  const File file(head + "paths = [\"camera_slid\"]\n");
  SceneLibrary library;
  EXPECT_EQ(error_of([&] { (void)expand_jobs(read_suite(file.path), library, {.program = tested_program()}); }),
            "scene contact has no path camera_slid; did you mean camera_slide? It has: camera_slide, light_slide, camera_jump, "
            "light_jump");
}

TEST(suite, names_what_the_truth_is_over) {
  EXPECT_EQ(read_suite(File(group).path).truth_over, TruthOver::center);
  EXPECT_EQ(read_suite(File("truth_over = 'pixel'\n" + group).path).truth_over, TruthOver::pixel);
  EXPECT_EQ(read_suite(File("truth_over = 'both'\n" + group).path).truth_over, TruthOver::both);
  EXPECT_EQ(trouble("truth_over = 'corner'\n" + group), "suite.truth_over = corner is not center, pixel or both (FILE:1)");
}

TEST(jobs, the_truth_at_centers_is_no_part_of_a_hash) {
  SceneLibrary library;
  const auto hash = [&](const std::string& key) {
    const File file(key + group);
    return expand_jobs(read_suite(file.path), library, {.program = tested_program()}).jobs.at(0).hash;
  };
  EXPECT_EQ(hash("truth_over = 'center'\n"), hash(""));
  EXPECT_NE(hash("truth_over = 'both'\n"), hash(""));
  EXPECT_NE(hash("truth_over = 'both'\n"), hash("truth_over = 'pixel'\n"));
}

// The hash is a promise: records of earlier versions are found again.
TEST(jobs, a_job_that_stands_still_keeps_its_hash) {
  const File file("width = 640\nheight = 360\n" + group);
  SceneLibrary library;
  const Suite suite = read_suite(file.path);
  for (const Job& job : expand_jobs(suite, library, {.program = tested_program()}).jobs)
    EXPECT_EQ(job.hash, content_hash(fmt::format("contact|{}|{}|unshadowed|640x360|shape", job.light, job.view)).substr(0, 16));
}

TEST(contenders, a_brace_list_is_a_sweep_and_two_are_their_product) {
  EXPECT_EQ(names("shadow_map:resolution={256,512,2048}"),
            (std::vector<std::string>{"shadow_map:resolution=256", "shadow_map:resolution=512", "shadow_map:resolution=2048"}));
  EXPECT_EQ(names("shadow_map:resolution={256,512},filter={pcf}"),
            (std::vector<std::string>{"shadow_map:resolution=256,filter=pcf", "shadow_map:resolution=512,filter=pcf"}));
  EXPECT_EQ(names("shadow_map:resolution={256,512},depth_bias={0,1,2}").size(), 6u);
  EXPECT_EQ(names("{unshadowed,embree_rays}"), (std::vector<std::string>{"unshadowed", "embree_rays"}));
}

TEST(contenders, a_sweep_names_the_default_of_what_it_sweeps_and_asks_for_the_same_job) {
  const std::string size = registry().technique("shadow_map").make()->parameter("resolution").default_text();
  const std::vector<Contender> sizes = parse_contenders("shadow_map:resolution={256," + size + "},depth_bias=7");
  EXPECT_EQ(sizes[0].label, "");
  EXPECT_EQ(sizes[1].label, "shadow_map:resolution=" + size + ",depth_bias=7");
  EXPECT_EQ(sizes[1].name(), "shadow_map:depth_bias=7");
  // A default that is only stated, not swept, is not named.
  const std::vector<Contender> flags = parse_contenders("shadow_map:stored={first,second},resolution=" + size);
  EXPECT_EQ(flags[0].label, "shadow_map:stored=first");
  EXPECT_EQ(flags[1].label, "");
  for (const char* text : {"shadow_map", "shadow_map:resolution={256,512}", "{unshadowed,shadow_map}"})
    for (const Contender& contender : parse_contenders(text)) EXPECT_EQ(contender.label, "") << text;
}

TEST(jobs, a_row_that_two_groups_have_runs_once_with_the_first_label_that_either_gives_it) {
  Suite suite;
  suite.groups = {{{"contact"}, {"sun"}, {}, parse_contenders("shadow_map")},
                  {{"contact"}, {"sun"}, {}, parse_contenders("shadow_map:stored={first,second}")},
                  {{"contact"}, {"sun"}, {}, parse_contenders("shadow_map", "late")}};
  SceneLibrary library;
  const std::vector<Job> jobs = expand_jobs(suite, library, {.program = tested_program()}).jobs;
  ASSERT_EQ(jobs.size(), 2u);
  EXPECT_EQ(jobs[0].contender.label, "shadow_map:stored=first");
  EXPECT_EQ(jobs[1].contender.label, "");
}

TEST(jobs, a_scene_that_is_not_fetched_changes_no_row_on_the_others) {
  const File scene("[[mesh]]\nfile = \"cache:no_such_scene/x.obj\"\n");
  const auto expanded = [&](std::vector<std::string> scenes) {
    Suite suite;
    suite.groups = {{std::move(scenes), {"sun"}, {}, parse_contenders("*")}};
    SceneLibrary library;
    library.read_from("absent", scene.path);
    SuiteJobs jobs = expand_jobs(suite, library, {.program = tested_program()});
    std::erase_if(jobs.jobs, [](const Job& job) { return job.scene == "absent"; });
    return jobs;
  };
  const SuiteJobs alone = expanded({"contact"}), beside = expanded({"absent", "contact"});
  EXPECT_FALSE(alone.left_out.empty()) << "techniques for lights with area";
  EXPECT_EQ(beside.left_out, alone.left_out);
  ASSERT_EQ(beside.jobs.size(), alone.jobs.size());
  for (std::size_t k = 0; k < alone.jobs.size(); ++k) EXPECT_EQ(beside.jobs[k].hash, alone.jobs[k].hash);
  EXPECT_TRUE(expanded({"absent"}).left_out.empty());
}

TEST(contenders, a_label_belongs_to_one_contender_not_to_a_sweep) {
  EXPECT_EQ(parse_contenders("shadow_map:resolution=256", "coarse")[0].label, "coarse");
  EXPECT_THROW(parse_contenders("shadow_map:resolution={256,512}", "coarse"), Error);
}

TEST(contenders, a_star_is_every_registered_technique_but_those_for_who_names_them) {
  load_programs_of_the_tree();
  std::vector<std::string> wanted, left_out;
  for (const TechniqueEntry& entry : registry().techniques()) (entry.about.named_only ? left_out : wanted).push_back(entry.id);
  EXPECT_EQ(names("*"), wanted);
  EXPECT_GT(wanted.size(), 20u);
  for (const char* engine :
       {"babylon_js", "cycles", "filament", "ogre", "open_scene_graph", "playcanvas", "pov_ray", "three_js"})
    EXPECT_TRUE(std::ranges::find(left_out, engine) != left_out.end()) << engine;
  EXPECT_THROW(parse_contenders("*", "all"), Error);
}

TEST(contenders, what_cannot_be_is_refused) {
  EXPECT_EQ(refused("shadow_map:resolution={256"), "'shadow_map:resolution={256' opens a brace that it does not close");
  EXPECT_EQ(refused("shadow_map:resolution={{256,512}}"),
            "'shadow_map:resolution={{256,512}}' opens a brace that it does not close");
  EXPECT_EQ(refused("shadow_map:resolution=256}"), "'shadow_map:resolution=256}' closes a brace that it does not open");
  EXPECT_EQ(refused("shadow_map:resolution={256,1}"), "shadow_map.resolution = 1 is outside 64 .. 8192 texel");
  EXPECT_EQ(refused("shadow_map:resolution={}"), "shadow_map.resolution = (nothing) is outside 64 .. 8192 texel");
  EXPECT_NE(refused("shadow_mop").find("did you mean shadow_map?"), std::string::npos) << refused("shadow_mop");
  EXPECT_NE(refused("").find("There are: "), std::string::npos) << refused("");
  EXPECT_EQ(refused("shadow_map:resolution={256,512},filter=pcf,unshadowed"),
            "'shadow_map:resolution={256,512},filter=pcf,unshadowed' names 2 techniques; where several are taken, the option "
            "is repeated: --technique shadow_map:resolution={256,512},filter=pcf --technique unshadowed");
}

TEST(suite, a_file_without_extras_has_the_documented_defaults) {
  const File file(group);
  const Suite suite = read_suite(file.path);
  EXPECT_EQ(suite.name, file.path.stem().string());
  EXPECT_EQ(suite.width, 640);
  EXPECT_EQ(suite.height, 360);
  EXPECT_EQ(suite.truth, Truth::shape);
  EXPECT_EQ(suite.processes, 5);
  EXPECT_EQ(suite.repetitions, 3);
  EXPECT_EQ(suite.warmups, 3);
  EXPECT_EQ(suite.timeout, 60);
  ASSERT_EQ(suite.groups.size(), 1u);
  EXPECT_TRUE(suite.groups[0].lights.empty() && suite.groups[0].views.empty());
}

TEST(suite, every_key_is_read) {
  const File file(
      "title = 'T'\nwidth = 32\nheight = 16\ntruth = 'mesh'\nprocesses = 2\nrepetitions = 4\nwarmups = 1\ntimeout = 1.5\n"
      "[[group]]\nscenes = ['contact', 'fence']\nlights = 'sun'\nviews = ['view']\n"
      "techniques = ['unshadowed', { use = 'shadow_map:filter=pcf', label = 'soft' }, 'shadow_map:resolution={256,512}']\n");
  const Suite suite = read_suite(file.path);
  EXPECT_EQ(suite.title, "T");
  EXPECT_EQ(std::pair(suite.width, suite.height), std::pair(32, 16));
  EXPECT_EQ(suite.truth, Truth::mesh);
  EXPECT_EQ(std::tuple(suite.processes, suite.repetitions, suite.warmups, suite.timeout), std::tuple(2, 4, 1, 1.5));
  const SuiteGroup& read = suite.groups.at(0);
  EXPECT_EQ(read.lights, std::vector<std::string>{"sun"});
  ASSERT_EQ(read.contenders.size(), 4u);
  EXPECT_EQ(read.contenders[1].label, "soft");
  // Two scenes, one light, one view, four contenders.
  SceneLibrary library;
  EXPECT_EQ(expand_jobs(suite, library, {.program = tested_program()}).jobs.size(), 8u);
}

TEST(suite, errors_say_what_and_end_in_file_and_line) {
  EXPECT_EQ(trouble("title = 'T'\nwidht = 3\n" + group).substr(0, 51), "suite has no key 'widht'; did you mean 'width'? It ");
  const auto ends_in = [](const std::string& text, const std::string& tail) {
    const std::string what = trouble(text);
    EXPECT_TRUE(what.ends_with(tail)) << what;
  };
  ends_in("title = 'T'\nwidht = 3\n" + group, "(FILE:2)");
  ends_in("width = 0\n" + group, "suite.width = 0 is not within 1 .. 16384 (FILE:1)");
  ends_in("\nheight = 1.5\n" + group, "suite.height = a number is not a whole number of 1 .. 16384 (FILE:2)");
  ends_in("truth = 'sphere'\n" + group, "suite.truth = sphere is not shape or mesh (FILE:1)");
  ends_in("timeout = 0\n" + group, "suite.timeout = 0 is not a number above 0 (FILE:1)");
  ends_in("budget = 30\n" + group,
          "suite.budget = 30 is for the processes that suite.interval asks for, which is not there (FILE:1)");
  ends_in("group = 3\n", "suite.group = a number is not an array of tables: write [[group]] (FILE:1)");
  ends_in(group + "scene = 3\n", "(FILE:4)");
  ends_in("[[group]]\nscenes = []\ntechniques = ['unshadowed']\n", "group.scenes is empty (FILE:1)");
  ends_in("[[group]]\nscenes = ['contact', 3]\ntechniques = ['unshadowed']\n", "a text or an array of texts (FILE:2)");
  ends_in("[[group]]\nscenes = 'contact'\n", "group.techniques is not an array with something in it (FILE:1)");
  ends_in("[[group]]\nscenes = 'contact'\ntechniques = [\n'unshadowed',\n'shadow_map:resolution=1']\n",
          "shadow_map.resolution = 1 is outside 64 .. 8192 texel (FILE:5)");
  ends_in("[[group]]\nscenes = 'contact'\ntechniques = [{ use = 'unshadowed', lable = 'x' }]\n", "(FILE:3)");
  ends_in("width = 3\n", "suite FILE has no [[group]]");
  ends_in("width = 3\nheight = \n" + group, "(FILE:2)");
}

TEST(suite, an_unknown_name_shows_what_there_is) {
  const std::string what = error_of([] { read_suite("quik"); });
  EXPECT_NE(what.find("did you mean quick?"), std::string::npos) << what;
  EXPECT_EQ(error_of([] { read_suite("/nowhere/at_all.toml"); }), "suite /nowhere/at_all.toml does not exist");
}

TEST(suite, the_suites_that_ship_can_be_read) {
  load_programs_of_the_tree();
  EXPECT_FALSE(suite_names().empty());
  for (const std::string& name : suite_names()) EXPECT_NO_THROW(read_suite(name)) << name;
}

TEST(suite, a_light_that_the_scene_lacks_is_an_error) {
  const File file("[[group]]\nscenes = 'contact'\nlights = 'sum'\ntechniques = ['unshadowed']\n");
  SceneLibrary library;
  EXPECT_EQ(error_of([&] { (void)expand_jobs(read_suite(file.path), library, {.program = tested_program()}); }),
            "scene contact has no light sum; did you mean sun? It has: point, sun, lamp, tube");
}

TEST(suite, lights_are_chosen_by_whether_they_have_an_area) {
  const auto lights = [](const char* wanted) {
    const File file(fmt::format("[[group]]\nscenes = ['contact']\nlights = {}\ntechniques = ['unshadowed']\n", wanted));
    SceneLibrary library;
    std::string names;
    for (const Job& job : expand_jobs(read_suite(file.path), library, {.program = tested_program()}).jobs)
      names += job.light + " ";
    return names;
  };
  EXPECT_EQ(lights("'*hard'"), "point sun ");
  EXPECT_EQ(lights("'*soft'"), "lamp tube ");
  EXPECT_EQ(lights("['tube', '*soft', 'sun']"), "tube lamp sun ");
  EXPECT_EQ(error_of([&] { lights("'*sof'"); }),
            "scene contact has no light whose name is like *sof; it has: point, sun, lamp, tube");
  const File file("[[group]]\nscenes = 'soup'\nlights = '*soft'\ntechniques = ['unshadowed']\n");
  SceneLibrary library;
  EXPECT_EQ(error_of([&] { (void)expand_jobs(read_suite(file.path), library, {.program = tested_program()}); }),
            "scene soup has no light with area, which *soft asks for; it has: point, sun");
}

TEST(scene_library, keeps_what_fits_and_loads_the_rest_again) {
  SceneLibrary roomy, narrow(1);
  const Scene* const kept = &*roomy.get("fence").scene;
  const std::size_t triangles = kept->triangle_count();
  roomy.get("composite");
  EXPECT_EQ(&*roomy.get("fence").scene, kept);

  // An entry of its own name stays; with the next name all are let go.
  const SceneLibrary::Entry& first = narrow.get("composite");
  EXPECT_EQ(&narrow.get("composite"), &first);
  EXPECT_EQ(narrow.size(), 1u);
  narrow.get("fence");
  EXPECT_EQ(narrow.size(), 1u);
  EXPECT_EQ(narrow.get("fence").scene->triangle_count(), triangles);

  roomy.forget("fence");
  roomy.forget("never_there");
  EXPECT_EQ(roomy.size(), 1u);
  roomy.read_from("there", "composite");
  EXPECT_EQ(roomy.place_of("there"), "composite");
  EXPECT_EQ(roomy.place_of("fence"), "fence");
}

}  // namespace suite_test
