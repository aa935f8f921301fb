// What WorkerClient makes of workers that answer, and of workers that do not.
#include "measure/worker/worker_client.h"

#include <gnomon/error.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <sstream>
#include <thread>

#include "measure/frame/frame.h"
#include "measure/scene/load.h"
#include "measure/scratch_folder.h"
#include "places.h"

namespace worker_client_test {

using namespace gnomon;
namespace fs = std::filesystem;

/// Workers that are shell scripts, which hear requests and say what a test has them say.
class ScriptedWorker : public testing::Test {
 protected:
  /// After the load has been answered the worker does what the script says: `hear` waits for a request and notes it, `say`
  /// answers.
  WorkerClient loaded(const std::string& script, double timeout = 20) {
    return started("hear\nsay '{\"gl\":null}'\n" + script, timeout);
  }
  WorkerClient started(const std::string& script, double timeout = 20) {
    const fs::path program = folder.path() / "program";
    std::ofstream(program) << "#!/bin/bash\nsocket=$2\nhear() { read -r line <&$socket; echo \"$line\" >> " << heard().string()
                           << "; }\nsay() { printf '%s\\n' \"$1\" >&$socket; }\n"
                           << script;
    fs::permissions(program, fs::perms::owner_all);
    return WorkerClient({.threads = 0, .plugins = {}, .program = program.string()}, folder.path() / "w", timeout);
  }
  fs::path heard() const { return folder.path() / "heard"; }
  std::string requests() const {
    std::ostringstream text;
    text << std::ifstream(heard()).rdbuf();
    return text.str();
  }
  /// Two pixels by two; the scripts do not look at the G-buffer.
  static FrameRequest small_frame() {
    return {.gbuffer_file = "none", .width = 2, .height = 2, .truth = Truth::mesh, .seen = SceneLightAndView{}};
  }

  const ScratchFolder folder = ScratchFolder::temporary("gnomon_worker");
};

const TechniqueOnScene anything{.scene_file = "none", .technique = "unshadowed", .settings = ""};

/// The reason of the WorkerFailure that the call throws.
std::string reason(const std::function<void()>& call) {
  try {
    call();
  } catch (const WorkerFailure& failure) {
    return failure.what();
  }
  return "no failure";
}

TEST_F(ScriptedWorker, a_crash_names_stage_and_signal) {
  WorkerClient worker = loaded("hear\nkill -SEGV $$\n");
  worker.load(anything);
  EXPECT_EQ(reason([&] { worker.time(Stage::build); }), "crashed in build: Segmentation fault (signal 11)");
  EXPECT_EQ(reason([&] { worker.time(Stage::resolve); }), "was asked for resolve after it had ended");
}

TEST_F(ScriptedWorker, an_exit_names_status_and_last_words) {
  WorkerClient worker = started("hear\necho first >&2\necho no scene today >&2\nexit 3\n");
  EXPECT_EQ(reason([&] { worker.load(anything); }), "crashed in open: exit status 3; it said: no scene today");
}

TEST_F(ScriptedWorker, an_error_that_is_no_text_is_shown_as_it_came) {
  WorkerClient worker = loaded("hear\nsay '{\"error\":{\"code\":3}}'\n");
  worker.load(anything);
  EXPECT_EQ(reason([&] { worker.time(Stage::build); }), "threw in build: {\"code\":3}");
}

TEST_F(ScriptedWorker, a_line_without_an_end_fails_before_memory_does) {
  WorkerClient worker = loaded("hear\nhead -c 6000000 /dev/zero | tr '\\0' a >&$socket\nsleep 60\n");
  worker.load(anything);
  EXPECT_EQ(reason([&] { worker.time(Stage::build); }), "answered build with a line without an end");
}

TEST_F(ScriptedWorker, a_hang_ends_with_the_timeout) {
  WorkerClient worker = loaded("hear\nsleep 60\n", 0.2);
  worker.load(anything);
  EXPECT_EQ(reason([&] { worker.time(Stage::relight); }), "hung in relight: no answer within 0.2 s");
}

TEST_F(ScriptedWorker, an_exception_is_told_in_its_own_words) {
  WorkerClient worker = loaded("hear\nsay '{\"error\":\"the tree has no root\"}'\n");
  worker.load(anything);
  EXPECT_EQ(reason([&] { worker.time(Stage::build); }), "threw in build: the tree has no root");
}

TEST_F(ScriptedWorker, nonsense_is_a_failure_of_the_worker) {
  for (const auto& [answer, says] :
       {std::pair("hello", "answered build with a line that is no JSON object"), std::pair("[1]", "no JSON object"),
        std::pair("{\"seconds\":1}", "answered build with something else than was asked"),
        std::pair("{\"ms\":\"long\"}", "answered build with something else than was asked")}) {
    WorkerClient worker = loaded(fmt::format("hear\nsay '{}'\nhear\n", answer));
    worker.load(anything);
    const std::string why = reason([&] { worker.time(Stage::build); });
    EXPECT_NE(why.find(says), std::string::npos) << answer << ": " << why;
  }
}

TEST_F(ScriptedWorker, iterations_are_one_request_and_what_an_answer_leaves_is_asked_for_again) {
  WorkerClient worker = loaded(
      "hear\nsay '{\"ms\":6,\"iterations\":6}'\nhear\nsay '{\"ms\":1,\"iterations\":1}'\n"
      "hear\nsay '{\"ms\":9,\"iterations\":3}'\n");
  worker.load(anything);
  EXPECT_EQ(worker.time(Stage::build, 10), 16);
  EXPECT_NE(requests().find("\"iterations\":10"), std::string::npos) << requests();
  EXPECT_NE(requests().find("\"iterations\":4"), std::string::npos) << requests();
  EXPECT_NE(requests().find("\"iterations\":3"), std::string::npos) << requests();
  EXPECT_EQ(worker.fresh_count(), 2);
}

TEST_F(ScriptedWorker, a_wrong_number_of_iterations_is_a_failure) {
  for (const auto& [count, says] :
       {std::pair("0", "0 iterations of build came for 5"), std::pair("6", "6 iterations of build came"),
        std::pair("1e300", "iterations = 1e+300 is not a whole number"), std::pair("\"2\"", "something else")}) {
    WorkerClient worker = loaded(fmt::format("hear\nsay '{{\"ms\":1,\"iterations\":{}}}'\nhear\n", count));
    worker.load(anything);
    const std::string why = reason([&] { worker.time(Stage::build, 5); });
    EXPECT_NE(why.find(says), std::string::npos) << count << ": " << why;
  }
}

TEST_F(ScriptedWorker, iterations_that_hang_end_with_the_timeout_of_one_and_a_portion) {
  WorkerClient worker = loaded("hear\nsleep 60\n", 0.2);
  worker.load(anything);
  EXPECT_EQ(reason([&] { worker.time(Stage::relight, 50); }), "hung in relight: no answer within 0.3 s");
}

TEST_F(ScriptedWorker, an_interrupt_ends_a_call_that_waits) {
  WorkerClient worker = loaded("hear\nsleep 60\n", 50);
  worker.load(anything);
  const auto start = std::chrono::steady_clock::now();
  std::thread other([&] {
    while (requests().find("time") == std::string::npos) std::this_thread::yield();
    worker.interrupt();
  });
  EXPECT_EQ(reason([&] { worker.time(Stage::build); }), "was interrupted in build");
  other.join();
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(30));
}

TEST_F(ScriptedWorker, a_missing_program_is_named) {
  const auto start = [](const std::string& program) {
    WorkerClient({.threads = 0, .plugins = {}, .program = program}, "none", 1);
  };
  const std::string gone = reason([&] { start("/nowhere/gnomon"); });
  EXPECT_NE(gone.find("/nowhere/gnomon: No such file or directory"), std::string::npos) << gone;
  const fs::path plain = folder.path() / "plain";
  std::ofstream(plain) << "text";
  const std::string locked = reason([&] { start(plain.string()); });
  EXPECT_NE(locked.find("plain: Permission denied"), std::string::npos) << locked;
  // It may be started as far as its mode says, and is no program: half a file that a linker is writing.
  fs::permissions(plain, fs::perms::owner_all);
  WorkerClient broken({.threads = 0, .plugins = {}, .program = plain.string()}, folder.path() / "w", 5);
  const std::string half = reason([&] { broken.load(anything); });
  EXPECT_NE(half.find("plain cannot be started: Exec format error"), std::string::npos) << half;
}

TEST_F(ScriptedWorker, support_comes_with_its_reason) {
  WorkerClient worker = loaded(
      "hear\nsay "
      "'{\"support\":{\"support\":\"full\",\"why\":\"\"},\"fresh\":0,\"lights\":[{\"support\":\"full\",\"why\":\"\"}],"
      "\"floor\":\"\",\"input_bytes\":12,\"upload_ms\":0.5}'\n"
      "hear\nsay "
      "'{\"support\":{\"support\":\"approximate\",\"why\":\"near\"},\"fresh\":2,\"lights\":[{\"support\":\"approximate\","
      "\"why\":\"near\"}],\"floor\":\"\"}'\n"
      "hear\nsay '{\"support\":{\"support\":\"unsupported\",\"why\":\"has an "
      "area\"},\"fresh\":2,\"lights\":[{\"support\":\"unsupported\",\"why\":\"has an area\"}],\"floor\":\"\"}'\n"
      "hear\nsay "
      "'{\"support\":{\"support\":\"perhaps\",\"why\":\"\"},\"fresh\":2,\"lights\":[{\"support\":\"perhaps\",\"why\":\"\"}],"
      "\"floor\":\"\"}'\n");
  worker.load(anything);
  const FrameReply full = worker.frame(small_frame());
  EXPECT_EQ(full.support.kind(), Support::Kind::full);
  ASSERT_TRUE(full.upload);
  EXPECT_EQ(full.upload->bytes, 12u);
  const FrameReply near = worker.frame(small_frame());
  EXPECT_EQ(near.support.kind(), Support::Kind::approximate);
  EXPECT_EQ(near.support.why(), "near");
  EXPECT_FALSE(near.upload);
  EXPECT_EQ(worker.fresh_count(), 2);
  const FrameReply none = worker.frame(small_frame());
  EXPECT_FALSE(none.support);
  EXPECT_EQ(none.support.why(), "has an area");
  EXPECT_NE(reason([&] { worker.frame(small_frame()); }).find("frame.support.support = \"perhaps\" is not one of full"),
            std::string::npos);
}

TEST_F(ScriptedWorker, only_stages_out_of_date_are_brought_up) {
  WorkerClient worker = loaded(
      "hear\nsay "
      "'{\"support\":{\"support\":\"full\",\"why\":\"\"},\"fresh\":2,\"lights\":[{\"support\":\"full\",\"why\":\"\"}],"
      "\"floor\":\"\"}'\nhear\nsay '{}'\nhear\nsay '{}'\n"
      "hear\nsay '{\"fresh\":3}'\nhear\nsay '{}'\n");
  worker.load(anything);
  worker.frame(small_frame());
  worker.bring_up(Stage::resolve);
  worker.bring_up(Stage::resolve);
  worker.set("a=1");
  worker.bring_up(Stage::resolve);
  EXPECT_EQ(requests().substr(requests().find("bring_up") - 7),
            "{\"do\":\"bring_up\",\"stage\":\"relight\"}\n{\"do\":\"bring_up\",\"stage\":\"resolve\"}\n"
            "{\"do\":\"set\",\"settings\":\"a=1\"}\n{\"do\":\"bring_up\",\"stage\":\"resolve\"}\n");
}

TEST_F(ScriptedWorker, a_mask_of_the_wrong_size_or_value_is_a_failure) {
  const std::string frame =
      "hear\nsay "
      "'{\"support\":{\"support\":\"full\",\"why\":\"\"},\"fresh\":4,\"lights\":[{\"support\":\"full\",\"why\":\"\"}],"
      "\"floor\":\"\"}'\nhear\n";
  const std::string mask = (folder.path() / "w.mask").string();
  for (const auto& [make, says] :
       {std::pair("rm -f {}", "w.mask"), std::pair("head -c 8 /dev/zero > {}", "has 8 bytes; 16 are"),
        std::pair("printf '\\0\\0\\300\\177%012d' 0 > {}", "mask value nan at pixel 0 is outside")}) {
    WorkerClient worker = loaded(frame + fmt::format(fmt::runtime(make), mask) + "\nsay '{}'\nhear\n");
    worker.load(anything);
    worker.frame(small_frame());
    const std::string why = reason([&] { worker.mask(); });
    EXPECT_NE(why.find(says), std::string::npos) << make << ": " << why;
  }
}

/// Workers of this program on a scene of one triangle, 80 pixels by 45.
class OwnWorker : public testing::Test {
 protected:
  WorkerClient worker(const std::string& name) {
    return WorkerClient({.threads = 0, .plugins = {}, .program = tested_program()}, folder.path() / name, 60);
  }
  TechniqueOnScene request(const std::string& technique, const std::string& settings = "") {
    return {.scene_file = frames.scene_file(), .technique = technique, .settings = settings};
  }
  FrameRequest frame() {
    const FrameKey key{.view = scene.views[0], .width = 80, .height = 45, .truth = Truth::mesh};
    return {.gbuffer_file = frames.gbuffer_file(key),
            .width = key.width,
            .height = key.height,
            .truth = key.truth,
            .seen = SceneLightAndView{}};
  }
  static constexpr std::size_t pixel_count = 80 * 45;

  const ScratchFolder folder = ScratchFolder::temporary("gnomon_worker");
  const Scene scene = load_scene("single_triangle");
  FrameStore frames{scene, folder.path() / "frames"};
};

TEST_F(OwnWorker, answers_counts_layers_and_explanations) {
  WorkerClient client = worker("map");
  client.load(request("shadow_map", "resolution=256"));
  ASSERT_TRUE(client.gl());
  EXPECT_FALSE(client.gl()->renderer.empty());
  EXPECT_GE(client.gl()->subpixel_bits, 4);  // what OpenGL promises
  const FrameReply reply = client.frame(frame());
  EXPECT_TRUE(reply.support);
  ASSERT_TRUE(reply.upload);
  EXPECT_GT(reply.upload->bytes, 0u);
  const MaskReply answer = client.answer();
  EXPECT_EQ(client.fresh_count(), 4);
  EXPECT_EQ(answer.mask.size(), pixel_count);
  EXPECT_NE(std::ranges::find(answer.mask, 0.0f), answer.mask.end());
  const auto bytes = std::ranges::find(answer.counts, "bytes", &Count::name);
  ASSERT_NE(bytes, answer.counts.end());
  EXPECT_GE(bytes->value, 6 * 256 * 256 * 2) << "six faces of at least 16 bits a texel";
  EXPECT_GT(answer.peak_bytes, 1'000'000u);
  EXPECT_EQ(client.debug_layer("map").size(), 3 * pixel_count);
  // More pixels than one request asks for: those of the picture, twice over.
  std::vector<std::uint32_t> pixels(2 * pixel_count);
  for (std::size_t k = 0; k < pixels.size(); ++k) pixels[k] = static_cast<std::uint32_t>(k % pixel_count);
  const auto explanations = client.explain(pixels);
  ASSERT_EQ(explanations.size(), pixels.size());
  const std::size_t shadow = static_cast<std::size_t>(std::ranges::find(answer.mask, 0.0f) - answer.mask.begin());
  ASSERT_TRUE(explanations[shadow] && explanations[shadow + pixel_count]);
  EXPECT_FALSE(explanations[shadow]->taps.empty());
  EXPECT_EQ(explanations[shadow]->taps.size(), explanations[shadow + pixel_count]->taps.size());
  client.set("resolution=128");
  EXPECT_EQ(client.fresh_count(), 2) << "setup and build know no resolution";
  EXPECT_EQ(client.mask().size(), pixel_count);
}

TEST_F(OwnWorker, a_technique_without_samples_explains_nothing) {
  WorkerClient client = worker("rays");
  client.load(request("embree_rays"));
  EXPECT_FALSE(client.gl());
  client.frame(frame());
  const std::vector<std::uint32_t> pixels{0, 7, 9};
  const auto explanations = client.explain(pixels);
  ASSERT_EQ(explanations.size(), 3u);
  EXPECT_FALSE(explanations[0] || explanations[1] || explanations[2]);
}

TEST_F(OwnWorker, gives_surface_detail_once_light_is_there) {
  WorkerClient client = worker("tree");
  client.load(request("svbsp"));
  client.frame(frame());
  const SurfaceDetail detail = client.surface_detail();
  EXPECT_FALSE(detail.polygons.empty());
  EXPECT_EQ(client.fresh_count(), 3);
}

TEST_F(OwnWorker, answers_a_light_that_is_not_the_scenes) {
  WorkerClient client = worker("free");
  client.load(request("embree_rays"));
  client.frame(frame());
  const std::vector<float> before = client.mask();
  Light moved = scene.lights[0];
  std::get<PointLight>(moved.kind).position += glm::vec3(1, 0, 0);
  FrameRequest elsewhere = frame();
  elsewhere.seen = FreeLightAndView{{moved}, scene.views[0]};
  client.frame(elsewhere);
  EXPECT_EQ(client.fresh_count(), 2) << "another light: build stands";
  EXPECT_NE(client.mask(), before);
  elsewhere.seen = FreeLightAndView{{scene.lights[0]}, scene.views[0]};
  client.frame(elsewhere);
  EXPECT_EQ(client.mask(), before);
}

TEST_F(OwnWorker, several_load_at_once) {
  WorkerClient one = worker("one"), two = worker("two");
  one.begin_load(request("unshadowed"));
  two.begin_load(request("embree_rays"));
  two.end_load();
  one.end_load();
  one.frame(frame());
  two.frame(frame());
  EXPECT_EQ(one.mask(), std::vector<float>(pixel_count, 1.0f));
  EXPECT_NE(two.mask(), one.mask());
}

TEST_F(OwnWorker, an_unknown_technique_is_an_exception_in_open) {
  WorkerClient client = worker("none");
  const std::string why = reason([&] { client.load(request("shadow_mop")); });
  EXPECT_TRUE(why.starts_with("threw in open: there is no technique shadow_mop")) << why;
}

}  // namespace worker_client_test
