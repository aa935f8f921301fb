#include "measure/edition/edition.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>

#include "error_words.h"
#include "measure/run/run_file.h"
#include "measure/scene/blob.h"
#include "measure/score/metrics.h"

namespace edition_test {

using namespace gnomon;
using error_words::error_of, error_words::expect_words;

constexpr const char* hand_written = R"(# A small one.
title = "Small"
width = 32
height = 18
truth = "shape"
truth_over = "center"
processes = 1
repetitions = 1
warmups = 1
timeout = 60
reference_error = 0.002
reference_rays = 8192

[[group]]
scenes = ["fence", "walking_boxes"]
lights = ["point", "sun"]
views = ["view"]
techniques = ["unshadowed", "shadow_map", { use = "shadow_map:resolution=512", label = "small" }]

[[group]]
scenes = ["walking_boxes"]
lights = ["sun"]
views = ["view"]
animations = ["walk"]
frames = 3
frame_rate = 60
start = 0.25
techniques = ["unshadowed"]

[edition]
training = ["soup:ground=false", "terrain"]
)";

/// A folder with the file of an edition, there as long as the object.
struct Folder {
  std::filesystem::path path = std::filesystem::temp_directory_path() / fmt::format("gnomon_edition_{}_{}", getpid(), count++);
  std::filesystem::path file = path / "small.toml";
  explicit Folder(const std::string& text = hand_written) {
    std::filesystem::create_directories(path);
    write(text);
  }
  ~Folder() { std::filesystem::remove_all(path); }
  void write(const std::string& text) const { std::ofstream(file) << text; }
  void write_errata(const std::string& text) const { std::ofstream(path / "small.errata.toml") << text; }
  /// The file with what this program freezes of it.
  std::string freeze() const {
    SceneLibrary library;
    const std::string text = frozen_edition(file, library);
    write(text);
    return text;
  }
  std::string trouble() const {
    return error_of([&] { read_edition_file(file); });
  }
  static inline int count = 0;
};

/// A text with one part of it replaced.
std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, text.npos) << from;
  return at == text.npos ? text : text.replace(at, from.size(), to);
}

/// The hand-written part with one part of it replaced, frozen or refused.
std::string trouble_of(const std::string& from, const std::string& to) {
  const Folder folder(replaced(hand_written, from, to));
  SceneLibrary library;
  return error_of([&] { frozen_edition(folder.file, library); });
}

TEST(edition, what_is_frozen_is_read_and_given_by_this_program) {
  const Folder folder;
  const std::string text = folder.freeze();
  EXPECT_TRUE(text.starts_with(hand_written));
  const Edition edition = read_edition_file(folder.file);
  EXPECT_EQ(edition.name, "small");
  EXPECT_EQ(edition.title, "Small");
  EXPECT_EQ(edition.suite.name, "edition_small");
  EXPECT_EQ(edition.hash.size(), 16u);
  EXPECT_EQ(edition.training, (std::vector<std::string>{"soup:ground=false", "terrain"}));
  EXPECT_EQ(edition.metrics.size(), metric_infos().size());
  EXPECT_EQ(edition.metrics.at("error"), 1);
  std::vector<std::string> keys;
  for (const auto& [key, hash] : edition.scenes) keys.push_back(key);
  EXPECT_EQ(keys, (std::vector<std::string>{"fence point", "fence sun", "walking_boxes point", "walking_boxes sun",
                                            "walking_boxes sun moving"}));
  EXPECT_NE(edition.scenes.at("walking_boxes sun"), edition.scenes.at("walking_boxes sun moving"));
  EXPECT_EQ(edition.techniques.at("shadow_map")["resolution"], 1024);
  EXPECT_EQ(edition.techniques.at("shadow_map:resolution=512")["resolution"], 512);
  EXPECT_TRUE(edition.errata.empty());
  SceneLibrary library;
  EXPECT_EQ(edition_differences(edition, library), std::vector<std::string>{});
  EXPECT_EQ(folder.freeze(), text) << "frozen again it stays as it is";
}

TEST(edition, the_hash_is_of_all_but_its_own_line) {
  const Folder folder;
  const std::string text = folder.freeze();
  const std::string hash = read_edition_file(folder.file).hash;
  EXPECT_NE(text.find("\nhash = \"" + hash + "\"\n"), text.npos);
  for (const auto& [from, to] :
       {std::pair("# A small one.", "# A small one!"), std::pair("error = 1\n", "error = 2\n"),
        std::pair("processes = 1", "processes = 2"), std::pair("resolution = 1024", "resolution = 2048")}) {
    folder.write(replaced(text, from, to));
    expect_words(folder.trouble(), {"edition small is not as it was frozen", hash});
  }
  folder.write(replaced(text, "\nhash = \"" + hash, "\nhash = \"0123456789abcdef"));
  expect_words(folder.trouble(), {"its hash is " + hash, "0123456789abcdef"});
}

TEST(edition, a_file_that_is_not_frozen_is_no_edition) {
  const Folder folder;
  expect_words(folder.trouble(), {"small.toml is not frozen", "gnomon edition small --freeze"});
}

TEST(edition, what_leaves_rows_open_is_refused) {
  expect_words(trouble_of("width = 32\n", ""), {"does not state `width`"});
  expect_words(trouble_of("warmups = 1\n", ""), {"does not state `warmups`"});
  expect_words(trouble_of("timeout = 60", "timeout = 60\ninterval = 0.1"), {"edition.interval"});
  expect_words(trouble_of("lights = [\"point\", \"sun\"]\n", ""), {"group 1", "lights"});
  expect_words(trouble_of("[\"point\", \"sun\"]", "[\"*hard\"]"), {"group 1", "lights"});
  expect_words(trouble_of("[\"point\", \"sun\"]", "[\"all+\"]"), {"group 1", "lights"});
  expect_words(trouble_of("views = [\"view\"]\n", ""), {"group 1", "views"});
  expect_words(trouble_of("[\"view\"]", "[\"*\"]"), {"group 1", "views"});
  expect_words(trouble_of("techniques = [\"unshadowed\", ", "techniques = [\"*\", "), {"group 1", "techniques"});
  expect_words(trouble_of("[\"walk\"]", "[\"*\"]"), {"group 2", "animations"});
  expect_words(trouble_of("frames = 3\n", ""), {"group 2", "frames"});
}

TEST(edition, unknown_keys_and_scored_training_scenes_are_refused) {
  expect_words(trouble_of("width = 32", "wide = 32"), {"suite has no key 'wide'", "small.toml:3"});
  expect_words(trouble_of("training = ", "trained = "), {"edition has no key 'trained'"});
  expect_words(trouble_of("\"terrain\"]", "\"fence:spacing=0.3\"]"),
               {"edition.training = fence:spacing=0.3", "scores nothing"});
  const std::string own = "[edition]\ntraining = [\"soup:ground=false\", \"terrain\"]\n";
  const Folder misplaced(replaced(replaced(hand_written, own, ""), "[[group]]\n", own + "[[group]]\n"));
  SceneLibrary library;
  expect_words(error_of([&] { frozen_edition(misplaced.file, library); }), {"[edition] is the last table"});
}

TEST(edition, what_the_program_has_otherwise_is_a_line_each) {
  const Folder folder;
  folder.freeze();
  Edition edition = read_edition_file(folder.file);
  SceneLibrary library;
  edition.scenes["fence sun"] = "0123";
  edition.scenes.erase("fence point");
  edition.scenes["soup sun"] = "4567";
  edition.metrics["error"] = 2;
  edition.metrics["bygone"] = 1;
  edition.metrics.erase("ssim");
  edition.frames -= 1;
  edition.techniques["shadow_map"]["resolution"] = 2048;
  edition.techniques["shadow_map"]["bygone"] = "yes";
  edition.techniques["shadow_map"].erase("filter");
  edition.techniques["moment_map"] = json_object();
  const std::vector<std::string> lines = edition_differences(edition, library);
  EXPECT_EQ(lines.size(), 9u) << joined(lines, "\n");
  const std::string all = joined(lines, "\n");
  for (const char* words :
       {"scene fence sun has hash ", ", and the edition 0123", "scene fence point: the edition has no hash of it",
        "scene soup sun: the edition has a hash of it and no row", "metric error has version 1, and the edition 2",
        "metric bygone is not there", "pixel classes) have version",
        "technique shadow_map has resolution = 1024, and the edition 2048",
        "technique shadow_map has no parameter bygone; the edition has yes",
        "technique moment_map: the edition has its parameters"})
    EXPECT_NE(all.find(words), all.npos) << words << "\n" << all;
}

TEST(edition, a_scene_without_a_light_it_had_is_a_difference) {
  const Folder folder;
  folder.freeze();
  Edition edition = read_edition_file(folder.file);
  edition.suite.groups[0].lights = {"point", "moon"};
  SceneLibrary library;
  const std::vector<std::string> lines = edition_differences(edition, library);
  ASSERT_EQ(lines.size(), 1u) << joined(lines, "\n");
  expect_words(lines[0], {"fence", "has no light moon"});
}

TEST(edition, errata_name_techniques_of_the_edition) {
  const Folder folder;
  folder.freeze();
  folder.write_errata("# none\n");
  EXPECT_EQ(folder.trouble(), "");
  const std::string whole =
      "[[erratum]]\ntechnique = \"shadow_map\"\nversion = \"0.0.9\"\nreason = \"R.\"\nrows = \"^fence \"\n";
  folder.write_errata(whole + replaced(whole, "0.0.9", "1000.0.0"));
  const std::vector<Erratum> errata = read_edition_file(folder.file).errata;
  ASSERT_EQ(errata.size(), 2u);
  EXPECT_EQ(errata[0].reason, "R.");
  EXPECT_TRUE(applies(errata[0]));
  EXPECT_FALSE(applies(errata[1])) << "of a version that this program has not reached";
  for (const auto& [from, to, words] :
       {std::tuple("shadow_map", "moment_map", "a technique of the edition"),
        std::tuple("0.0.9", "new", "a version of the program"), std::tuple("0.0.9", "0.1", "a version of the program"),
        std::tuple("\"R.\"", "\"\"", "a sentence"), std::tuple("^fence ", "(", "a regular expression"),
        std::tuple("reason", "why", "has no key 'why'")}) {
    folder.write_errata(replaced(whole, from, to));
    expect_words(folder.trouble(), {words, "small.errata.toml"});
  }
}

TEST(edition, its_file_is_a_suite_and_other_suites_have_no_such_tables) {
  const Folder folder;
  folder.freeze();
  EXPECT_EQ(read_suite(folder.file).groups.size(), 2u);
  folder.write("[metrics]\nerror = 1\n[[group]]\nscenes = [\"fence\"]\ntechniques = [\"unshadowed\"]\n");
  expect_words(error_of([&] { read_suite(folder.file); }), {"suite has no key 'metrics'"});
}

TEST(edition, only_the_default_division_has_no_settings) {
  const Folder folder;
  folder.freeze();
  const Edition edition = read_edition_file(folder.file);
  const auto refused = [&](Division division, const std::string& text) {
    return error_of([&] { require_division(edition, division, parse_contenders(text)); });
  };
  expect_words(refused(Division::default_settings, "shadow_map:resolution=256"),
               {"shadow_map:resolution=256 has settings", "tuned"});
  EXPECT_EQ(refused(Division::default_settings, "shadow_map:resolution=512"), "") << "the edition has it itself";
  EXPECT_EQ(refused(Division::default_settings, "moment_map"), "");
  EXPECT_EQ(refused(Division::tuned, "shadow_map:resolution=256"), "");
  EXPECT_EQ(refused(Division::open, "shadow_map:resolution=256"), "");
  EXPECT_EQ(parse_division("tuned"), Division::tuned);
  expect_words(error_of([] { parse_division("best"); }), {"division best", "default, tuned, open"});
}

TEST(edition, other_techniques_take_its_places) {
  const Folder folder;
  folder.freeze();
  const Edition edition = read_edition_file(folder.file);
  const Suite suite = with_contenders(edition, parse_contenders("stencil_volume"));
  ASSERT_EQ(suite.groups.size(), 2u);
  for (const SuiteGroup& group : suite.groups) {
    ASSERT_EQ(group.contenders.size(), 1u);
    EXPECT_EQ(group.contenders[0].name(), "stencil_volume");
    EXPECT_TRUE(group.contenders[0].is_from_wildcard);
  }
  EXPECT_EQ(suite.name, "edition_small");
}

TEST(edition, folders_of_different_editions_are_told_apart) {
  const Folder folder;
  const auto run_of = [&](const char* name, const std::string& runs) {
    const std::filesystem::path run = folder.path / name;
    write_file(run / "run.json", "{\"schema\": \"gnomon-run-1\", \"runs\": [" + runs + "]}");
    return run;
  };
  const std::string own = R"({"edition": {"name": "small", "hash": "0123", "division": "default"}})";
  const auto one = run_of("one", own), two = run_of("two", own), plain = run_of("plain", "{}");
  const auto tuned = run_of("tuned", replaced(own, "default", "tuned")), mixed = run_of("mixed", own + ", {}");
  const auto bad = run_of("bad", R"({"edition": "small"})");
  const auto conflict = [](std::vector<std::filesystem::path> folders) {
    return error_of([&] { require_one_edition(folders); });
  };
  EXPECT_EQ(conflict({one, two}), "");
  EXPECT_EQ(conflict({plain, folder.path / "nowhere"}), "");
  expect_words(conflict({one, tuned}), {"edition small (0123), division default", "division tuned", "are not merged"});
  expect_words(conflict({one, plain}), {"of no edition"});
  expect_words(conflict({mixed}), {"of no edition"});
  expect_words(conflict({bad}), {"names an edition without a text `name`"});
  EXPECT_EQ(error_of([&] { require_edition_of_folder(one, RunEdition{"small", "0123", "default"}); }), "");
  expect_words(error_of([&] { require_edition_of_folder(one, std::nullopt); }), {"this run is of no edition", "--out"});
  expect_words(error_of([&] { require_edition_of_folder(one, RunEdition{"small", "4567", "default"}); }), {"(0123)", "(4567)"});
  EXPECT_EQ(error_of([&] { require_edition_of_folder(folder.path / "nowhere", RunEdition{}); }), "");
}

}  // namespace edition_test
