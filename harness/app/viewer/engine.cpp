// The engine's lanes over their board, and what the window calls.
#include "app/viewer/engine.h"

#include <thread>

#include "app/viewer/curve_lane.h"
#include "app/viewer/frame_lane.h"
#include "app/viewer/scene_lane.h"

namespace gnomon::viewer {

struct Engine::Body {
  Body(WorkerOptions workers, double timeout_seconds, std::function<void()> changed)
      : board(std::move(workers), timeout_seconds, std::move(changed)) {
    for (Lane* const lane : std::initializer_list<Lane*>{&loading, &framing, &refining, &measuring, &sides[0], &sides[1]})
      threads.emplace_back([lane] { lane->serve(); });
  }
  ~Body() {
    const std::lock_guard lock(board.mutex);
    board.stop = true;
    for (SideLane& side : sides) side.interrupt();
    measuring.interrupt();
    refining.give_up();
    board.news.notify_all();
  }

  Board board;
  SceneLane loading{board};
  ReferenceLane refining{board};
  CurveLane measuring{board};
  std::array<SideLane, 2> sides{SideLane(board, 0), SideLane(board, 1)};
  FrameLane framing{board, sides, refining};
  std::vector<std::jthread> threads;  ///< joined first
};

bool are_same(const Light& a, const Light& b) { return light_and_view_bytes(a, {}) == light_and_view_bytes(b, {}); }
bool are_same(const View& a, const View& b) { return light_and_view_bytes(Light(), a) == light_and_view_bytes(Light(), b); }

bool are_same(const Selection& a, const Selection& b) {
  return a.scene == b.scene && a.loaded == b.loaded && a.truth == b.truth && are_same(a.light, b.light) &&
         are_same(a.together, b.together) && are_same(a.view, b.view) && a.at == b.at && a.width == b.width &&
         a.height == b.height && a.is_moving == b.is_moving && a.full_while_moving == b.full_while_moving &&
         a.sides == b.sides && a.picked == b.picked && a.repeat == b.repeat && a.curve == b.curve;
}

Engine::Engine(WorkerOptions workers, double timeout_seconds, std::function<void()> changed)
    : body_(std::make_unique<Body>(std::move(workers), timeout_seconds, std::move(changed))) {}

Engine::~Engine() = default;

void Engine::offer(std::shared_ptr<LoadedScene> loaded) {
  const std::lock_guard lock(body_->board.mutex);
  body_->loading.offer(std::move(loaded));
}

std::uint64_t Engine::select(const Selection& selection) {
  Board& board = body_->board;
  const std::lock_guard lock(board.mutex);
  for (SideLane& side : body_->sides) side.drop_work_before(selection);
  body_->measuring.drop_curve_before(selection);
  if (selection.scene != board.selection.scene) board.state.scene_error.clear();
  board.selection = selection;
  ++board.state.selection_number;
  board.wake_lanes();
  return board.state.selection_number;
}

EngineState Engine::state() const {
  const std::lock_guard lock(body_->board.mutex);
  EngineState state = body_->board.state;
  for (int k = 0; k < 2; ++k) body_->sides[k].report_progress(state.sides[k]);
  return state;
}

}  // namespace gnomon::viewer
