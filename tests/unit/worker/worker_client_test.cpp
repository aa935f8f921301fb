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
  EXPECT_EQ(worker.fresh_count(), 3) << "build brings along what update would";
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
      "\"floor\":\"\"}'\n"
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
  const FrameReply near = worker.frame(small_frame());
  EXPECT_EQ(near.support.kind(), Support::Kind::approximate);
  EXPECT_EQ(near.support.why(), "near");
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
      "'{\"support\":{\"support\":\"full\",\"why\":\"\"},\"fresh\":3,\"lights\":[{\"support\":\"full\",\"why\":\"\"}],"
      "\"floor\":\"\"}'\nhear\nsay '{}'\nhear\nsay '{}'\n"
      "hear\nsay '{\"fresh\":4}'\nhear\nsay '{}'\n");
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

TEST_F(ScriptedWorker, a_pose_goes_along_to_the_bit_and_update_is_brought_up) {
  WorkerClient worker = loaded(
      "hear\nsay "
      "'{\"support\":{\"support\":\"full\",\"why\":\"\"},\"fresh\":2,\"lights\":[{\"support\":\"full\",\"why\":\"\"}],"
      "\"floor\":\"\"}'\nhear\nsay '{}'\nhear\nsay '{}'\n");
  worker.load(anything);
  FrameRequest request = small_frame();
  request.pose = WantedPose{.at = {.animation = "walk", .seconds = 0.1 + 0.2, .start = 0.1, .frame_rate = 1.0 / 3, .frames = 7},
                            .hash = "1a2b"};
  worker.frame(request);
  worker.bring_up(Stage::relight);
  std::istringstream lines(requests());
  std::string open, frame, rest;
  std::getline(lines, open);
  std::getline(lines, frame);
  const GoRequest heard = message_from<GoRequest>(Json::parse(frame), "frame");
  ASSERT_TRUE(heard.pose);
  EXPECT_EQ(heard.pose->at, request.pose->at);
  EXPECT_EQ(heard.pose->hash, "1a2b");
  std::getline(lines, rest, '\0');
  EXPECT_EQ(rest, "{\"do\":\"bring_up\",\"stage\":\"update\"}\n{\"do\":\"bring_up\",\"stage\":\"relight\"}\n");
}

TEST_F(ScriptedWorker, a_mask_of_the_wrong_size_or_value_is_a_failure) {
  const std::string frame =
      "hear\nsay "
      "'{\"support\":{\"support\":\"full\",\"why\":\"\"},\"fresh\":5,\"lights\":[{\"support\":\"full\",\"why\":\"\"}],"
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

TEST_F(ScriptedWorker, a_depth_curve_comes_as_it_was_or_is_a_failure) {
  DepthCurveRequest::Reply reply{.curve = DepthCurve{.held = {.depth = {1, 2.5}, .share = {1, 0.5}},
                                                     .exact = {.depth = {1, 1.75, 1.75, 2.5}, .share = {1, 1, 0.25, 0.25}},
                                                     .receiver = 0.1}};
  const std::string frame =
      "hear\nsay "
      "'{\"support\":{\"support\":\"full\",\"why\":\"\"},\"fresh\":5,\"lights\":[{\"support\":\"full\",\"why\":\"\"}],"
      "\"floor\":\"\"}'\nhear\nsay '";
  const auto asked = [&](const std::string& answer) {
    WorkerClient worker = loaded(frame + answer + "'\nhear\n");
    worker.load(anything);
    worker.frame(small_frame());
    return worker.depth_curve(3);
  };
  const std::optional<DepthCurve> curve = asked(json_text(written(reply)));
  ASSERT_TRUE(curve);
  EXPECT_EQ(curve->held.depth, reply.curve->held.depth);
  EXPECT_EQ(curve->held.share, reply.curve->held.share);
  EXPECT_EQ(curve->exact.depth, reply.curve->exact.depth);
  EXPECT_EQ(curve->exact.share, reply.curve->exact.share);
  EXPECT_EQ(curve->receiver, 0.1);
  EXPECT_NE(requests().find("{\"do\":\"depth_curve\",\"pixel\":3,\"light\":0}"), std::string::npos) << requests();
  EXPECT_FALSE(asked("{\"curve\":null}"));
  reply.curve->exact.share.pop_back();
  EXPECT_NE(reason([&] { asked(json_text(written(reply))); }).find("a curve of 3 shares at 4 depths came"), std::string::npos);
  reply.curve->exact.share.push_back(NAN);
  EXPECT_NE(reason([&] { asked(json_text(written(reply))); }).find("exact.share = null is not a number"), std::string::npos);
}

TEST_F(ScriptedWorker, parts_are_a_number_a_pixel_or_a_failure) {
  const std::string frame =
      "hear\nsay "
      "'{\"support\":{\"support\":\"full\",\"why\":\"\"},\"fresh\":5,\"lights\":[{\"support\":\"full\",\"why\":\"\"}],"
      "\"floor\":\"\"}'\nhear\n";
  const std::string file = (folder.path() / "w.parts").string();
  const auto asked = [&](const std::string& make, bool has_parts) {
    WorkerClient worker = loaded(fmt::format("{}{} > {}\nsay '{{\"has_parts\":{}}}'\nhear\n", frame, make, file, has_parts));
    worker.load(anything);
    worker.frame(small_frame());
    return worker.parts();
  };
  EXPECT_EQ(asked("printf '\\1\\0\\0\\0\\0\\0\\0\\0\\2\\1\\0\\0\\1\\0\\0\\0'", true),
            (std::vector<std::uint32_t>{1, 0, 258, 1}));
  EXPECT_NE(requests().find("{\"do\":\"parts\","), std::string::npos) << requests();
  EXPECT_TRUE(asked("true", false).empty());
  EXPECT_NE(reason([&] { asked("head -c 12 /dev/zero", true); }).find("has 12 bytes; 16 are required"), std::string::npos);
}

}  // namespace worker_client_test
