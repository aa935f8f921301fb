// Rows that follow an animation: the keys of suites, the frames of rows, and the hashes of their jobs.
#include "measure/run/row_paths.h"

#include <gnomon/error.h>
#include <gtest/gtest.h>

#include <cmath>

#include "measure/run/jobs.h"
#include "measure/scene/blob.h"
#include "places.h"
#include "suite_files.h"

namespace row_paths_test {

using namespace gnomon;
using suite_files::error_of, suite_files::File, suite_files::group, suite_files::trouble;
using Words = std::vector<std::string>;

/// The jobs of groups on small walking boxes, whose animation `walk` ends at 2 s.
std::vector<Job> jobs_of(const std::string& keys, const std::string& scene = "walking_boxes:count=4") {
  const File file(
      fmt::format("width = 64\nheight = 36\n[[group]]\nscenes = ['{}']\nlights = ['point']\n"
                  "techniques = ['unshadowed']\n{}",
                  scene, keys));
  SceneLibrary library;
  return expand_jobs(read_suite(file.path), library, {.program = tested_program()}).jobs;
}
Job job_of(const std::string& keys) {
  const std::vector<Job> jobs = jobs_of(keys);
  if (jobs.size() != 1) throw Error("{} rows of {}", jobs.size(), keys);
  return jobs.front();
}
std::string refused(const std::string& keys, const std::string& scene = "walking_boxes:count=4") {
  return error_of([&] { jobs_of(keys, scene); });
}

TEST(suite, groups_take_animations_and_which_of_their_frames_rows_have) {
  const File file(group + "animations = ['walk', '*']\nframes = 5\nframe_rate = 29.97\nstart = 0.5\n" + group +
                  "animations = 'walk'\nstart = -0.0\n" + group);
  const std::vector<SuiteGroup> groups = read_suite(file.path).groups;
  using Words = std::vector<std::string>;
  EXPECT_EQ(groups.at(0).animations, (Words{"walk", "*"}));
  EXPECT_EQ(groups.at(0).times, (FrameTimes{5, 29.97, 0.5}));
  EXPECT_EQ(groups.at(1).animations, Words{"walk"});
  EXPECT_EQ(groups.at(1).times, (FrameTimes{{}, {}, 0}));
  EXPECT_FALSE(std::signbit(*groups.at(1).times.start)) << "a row has one hash, whichever zero it starts at";
  EXPECT_TRUE(groups.at(2).animations.empty());
  EXPECT_EQ(groups.at(2).times, FrameTimes{});
}

TEST(suite, what_is_wrong_with_frames_of_animations_is_said) {
  const auto wrong = [](const std::string& keys) { return trouble(group + keys); };
  const std::string walk = "animations = 'walk'\n";
  for (const char* key : {"frames = 5", "frame_rate = 60", "start = 0"})
    EXPECT_EQ(wrong(key),
              fmt::format("group.{} is for rows that follow an animation, and group.animations is not there (FILE:4)",
                          std::string_view(key).substr(0, std::string_view(key).find(' '))));
  EXPECT_EQ(wrong(walk + "frames = 1\n"), "group.frames = 1 is not within 2 .. 10000 (FILE:5)");
  EXPECT_EQ(wrong(walk + "frames = 10001\n"), "group.frames = 10001 is not within 2 .. 10000 (FILE:5)");
  EXPECT_EQ(wrong(walk + "frames = 2.5\n"), "group.frames = a number is not a whole number of 2 .. 10000 (FILE:5)");
  EXPECT_EQ(wrong(walk + "frame_rate = 0\n"), "group.frame_rate = 0 is not frames per second, above 0 (FILE:5)");
  EXPECT_EQ(wrong(walk + "frame_rate = nan\n"), "group.frame_rate = nan is not within -1e30 .. 1e30 (FILE:5)");
  EXPECT_EQ(wrong(walk + "start = -1\n"), "group.start = -1 is not seconds, 0 or more (FILE:5)");
  EXPECT_EQ(wrong(walk + "start = inf\n"), "group.start = inf is not within -1e30 .. 1e30 (FILE:5)");
  EXPECT_EQ(wrong("animations = []\n"), "group.animations = [] is not a name or an array of names (FILE:4)");
  EXPECT_EQ(wrong("animations = ['Walk']\n"),
            "group.animations = 'Walk' is not a name of a..z, 0..9 and _, at most 100 of them, or * (FILE:4)");
  EXPECT_EQ(
      wrong(walk + "time = 1\n"),
      "group.time is of stills, and group.animations of rows that go on frame by frame: a group has one of both (FILE:5)");
}

TEST(row_paths, a_row_follows_an_animation_to_its_last_key_at_60_frames_a_second) {
  const Job job = job_of("animations = 'walk'\n");
  EXPECT_EQ(job.title(), "walking_boxes:count=4 point walk unshadowed");
  EXPECT_EQ(job.times, (FrameTimes{121, 60, 0}));
  EXPECT_EQ(job.frame_count, 121);
}

TEST(row_paths, another_rate_or_start_has_as_many_frames_as_reach_the_last_key) {
  EXPECT_EQ(job_of("animations = 'walk'\nframe_rate = 10\n").times, (FrameTimes{21, 10, 0}));
  EXPECT_EQ(job_of("animations = 'walk'\nstart = 1.5\n").times, (FrameTimes{31, 60, 1.5}));
  EXPECT_EQ(job_of("animations = 'walk'\nframe_rate = 0.1\n").times, (FrameTimes{2, 0.1, 0})) << "at 0 and 10 s";
  EXPECT_EQ(refused("animations = 'walk'\nframe_rate = 1e6\n"),
            "animation walk has 2e+06 frames from 0 s to its last key at 2 s, 1000000 a second; a row has at most 10000: give "
            "frames, or another frame_rate");
  EXPECT_EQ(job_of("animations = 'walk'\nframes = 3\nframe_rate = 10\nstart = 7\n").times, (FrameTimes{3, 10, 7}));
}

TEST(row_paths, a_star_is_each_animation_once_and_paths_are_rows_beside_them) {
  const std::vector<Job> jobs = jobs_of("animations = ['walk', '*']\npaths = ['camera_slide']\nframes = 2\n");
  ASSERT_EQ(jobs.size(), 2u);
  EXPECT_EQ(jobs[0].path, "camera_slide");
  EXPECT_FALSE(jobs[0].times);
  EXPECT_EQ(jobs[0].frame_count, 16);
  EXPECT_EQ(jobs[1].path, "walk");
  EXPECT_EQ(jobs[1].frame_count, 2);
  EXPECT_EQ(job_of("paths = ['walk']\n").hash, job_of("animations = ['walk']\n").hash)
      << "a path of that name is the animation";
}

TEST(row_paths, frames_rate_and_start_are_part_of_the_job_where_geometry_moves_and_of_no_other) {
  const auto hash = [](const std::string& keys) { return job_of("animations = 'walk'\n" + keys).hash; };
  EXPECT_EQ(
      hash("frames = 5\nframe_rate = 10\n"),
      content_hash("walking_boxes:count=4|point|view|unshadowed|64x36|shape|walk|frames 5 rate 10 start 0").substr(0, 16));
  EXPECT_EQ(hash(""), hash("frames = 121\nframe_rate = 60\nstart = 0\n"));
  const std::set<std::string> hashes = {hash("frames = 5\n"), hash("frames = 6\n"), hash("frames = 5\nframe_rate = 30\n"),
                                        hash("frames = 5\nstart = 0.5\n")};
  EXPECT_EQ(hashes.size(), 4u);
  EXPECT_EQ(job_of("paths = 'light_slide'\n").hash,
            content_hash("walking_boxes:count=4|point|view|unshadowed|64x36|shape|light_slide").substr(0, 16));
}

TEST(row_paths, the_first_frame_has_the_times_of_the_row) {
  SceneLibrary library;
  const Job job = job_of("animations = 'walk'\nframes = 3\nframe_rate = 10\nstart = 0.5\n");
  const Scene& scene = *library.get(job.scene).scene;
  const RowFrame frame = first_frame(job, scene);
  ASSERT_TRUE(frame.path);
  EXPECT_EQ(frame.path->moves, Path::Moves::geometry);
  EXPECT_EQ(frame.count(), 3);
  EXPECT_EQ(std::pair(frame.path->start, frame.path->frame_rate), std::pair(0.5, 10.0));
  EXPECT_DOUBLE_EQ(pose_at(*frame.path, 2)->seconds, 0.7);
  Suite suite;
  const Record record = start_record(job, suite, &scene, Json::object());
  EXPECT_EQ(record.path, "walk");
  EXPECT_EQ(record.start, 0.5);
  EXPECT_EQ(record.frame_rate, 10);
  EXPECT_TRUE(record.notes.empty());
  EXPECT_FALSE(start_record(job_of(""), suite, &scene, Json::object()).start);
}

TEST(row_paths, a_start_at_or_behind_the_last_key_is_noted) {
  SceneLibrary library;
  const Job job = job_of("animations = 'walk'\nframes = 2\nstart = 2\n");
  const Record record = start_record(job, {}, &*library.get(job.scene).scene, Json::object());
  EXPECT_EQ(record.notes, Words{"the row starts at 2 s, and the last key of walk is at 2 s: nothing moves"});
}

TEST(row_paths, several_lights_stand_still_together_while_geometry_moves) {
  const File file(
      "[[group]]\nscenes = ['walking_boxes:count=4']\nlights = ['all+']\nanimations = 'walk'\n"
      "techniques = ['unshadowed']\n");
  SceneLibrary library;
  EXPECT_EQ(expand_jobs(read_suite(file.path), library, {.program = tested_program()}).jobs.at(0).lights.size(), 3u);
}

TEST(row_paths, an_animation_that_is_not_there_is_refused_with_the_nearest_name) {
  EXPECT_EQ(refused("animations = 'wlak'\n"),
            "scene walking_boxes:count=4 has no animation wlak; did you mean walk? It has: walk");
  EXPECT_EQ(refused("animations = 'walk'\n", "contact"),
            "scene contact has no animation; animations = walk follow a scene that moves");
  EXPECT_EQ(refused("animations = '*'\n", "contact"),
            "scene contact has no animation; animations = * follow a scene that moves");
  EXPECT_EQ(refused("animations = 'walk'\n", "walking_boxes@1"),
            "scene walking_boxes@1 has no animation: it is a still; animations = walk follow a scene that moves");
  EXPECT_EQ(
      refused("animations = 'light_slide'\n"),
      "light_slide is a path of scene walking_boxes:count=4, not an animation: name it in paths; its animations are walk");
}

TEST(row_paths, rows_of_a_scene_that_is_not_fetched_differ_by_the_frames_that_are_asked_for) {
  SuiteGroup wanted{.scenes = {}, .lights = {}, .views = {}, .contenders = {}};
  wanted.animations = {"walk", "*"};
  wanted.times = {.frames = 5, .frame_rate = {}, .start = {}};
  const std::vector<RowPath> paths = row_paths(wanted, "absent", nullptr, {}, {});
  ASSERT_EQ(paths.size(), 2u);
  EXPECT_EQ(paths[0].name, "walk");
  EXPECT_EQ(paths[1].name, "-");
  Job job;
  job.times = paths[0].times;
  EXPECT_EQ(job.motion(), "frames 5 rate - start -");
}

}  // namespace row_paths_test
