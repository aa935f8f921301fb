// What the mouse does in the picture.
#include "app/viewer/mouse.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <gnomon/kit/random.h>
#include <gtest/gtest.h>

#include <set>

namespace mouse_test {

using namespace gnomon;
using namespace gnomon::viewer;

constexpr int left = GLFW_MOUSE_BUTTON_LEFT, right = GLFW_MOUSE_BUTTON_RIGHT, middle = GLFW_MOUSE_BUTTON_MIDDLE;

const GrabTargets nothing_else;

TEST(viewer_mouse, buttons_and_shift_say_what_a_drag_does) {
  const struct {
    int button, modifiers;
    DragKind due;
  } cases[] = {{left, 0, DragKind::orbit},
               {right, 0, DragKind::look},
               {middle, 0, DragKind::pan},
               {left, GLFW_MOD_SHIFT, DragKind::pan},
               {left, GLFW_MOD_CONTROL, DragKind::line},
               {right, GLFW_MOD_SHIFT, DragKind::look},
               {left, GLFW_MOD_CAPS_LOCK | GLFW_MOD_NUM_LOCK, DragKind::orbit}};
  for (const auto& [button, modifiers, due] : cases) {
    Gesture gesture;
    EXPECT_EQ(gesture.kind(), DragKind::nothing);
    gesture.press(button, modifiers, {100, 100}, 1, nothing_else);
    EXPECT_EQ(gesture.kind(), DragKind::waiting);
    gesture.move({102, 101}, 1.1);
    EXPECT_EQ(gesture.kind(), DragKind::waiting);  // sqrt 5 < 3
    EXPECT_EQ(gesture.moved(), glm::dvec2(0));
    gesture.move({104, 101}, 1.2);
    EXPECT_EQ(gesture.kind(), due);
    EXPECT_TRUE(gesture.is_drag());
    EXPECT_EQ(gesture.moved(), glm::dvec2(4, 1));  // all of it
    gesture.move({100, 100}, 1.3);
    EXPECT_EQ(gesture.kind(), due);
    EXPECT_EQ(gesture.moved(), glm::dvec2(0));
    EXPECT_FALSE(gesture.release(button, {100, 100}, 1.3));  // it was a drag, wherever it ended
    EXPECT_EQ(gesture.kind(), DragKind::nothing);
  }
  Gesture gesture;
  gesture.press(GLFW_MOUSE_BUTTON_4, 0, {1, 1}, 0, nothing_else);
  EXPECT_EQ(gesture.kind(), DragKind::nothing);
}

TEST(viewer_mouse, a_click_is_short_near_and_left) {
  const auto click = [](int button, int modifiers, glm::dvec2 to, double seconds, double scale) {
    Gesture gesture;
    gesture.press(button, modifiers, {100, 100}, 7, {.light = std::nullopt, .divider = std::nullopt, .scale = scale});
    return gesture.release(button, glm::dvec2(100, 100) + to, 7 + seconds);
  };
  EXPECT_EQ(click(left, 0, {0, 0}, 0.1, 1), glm::dvec2(100, 100));
  EXPECT_EQ(click(left, 0, {3, 0}, 0.4, 1), glm::dvec2(100, 100));  // where it was pressed
  EXPECT_FALSE(click(left, 0, {3.1, 0}, 0.1, 1));
  EXPECT_EQ(click(left, 0, {3.1, 0}, 0.1, 2), glm::dvec2(100, 100));  // coarser fingers on a larger interface
  EXPECT_FALSE(click(left, 0, {6.1, 0}, 0.1, 2));
  EXPECT_FALSE(click(left, 0, {0, 0}, 0.6, 1));
  EXPECT_FALSE(click(left, GLFW_MOD_SHIFT, {0, 0}, 0.1, 1));
  EXPECT_FALSE(click(right, 0, {0, 0}, 0.1, 1));
  EXPECT_FALSE(click(middle, 0, {0, 0}, 0.1, 1));
}

TEST(viewer_mouse, a_press_that_lasts_becomes_a_drag_for_small_ways) {
  Gesture gesture;
  gesture.press(left, 0, {100, 100}, 1, nothing_else);
  gesture.move({101, 100}, 1.4);
  EXPECT_EQ(gesture.kind(), DragKind::waiting);
  gesture.move({101, 100}, 1.6);
  EXPECT_EQ(gesture.kind(), DragKind::orbit);
  EXPECT_EQ(gesture.moved(), glm::dvec2(1, 0));
}

TEST(viewer_mouse, the_handle_of_the_light_keeps_its_offset_to_the_mouse) {
  const GrabTargets targets{.light = glm::dvec2(200, 100), .divider = 203, .scale = 1};
  Gesture gesture;
  gesture.press(left, 0, {206, 108}, 0, targets);  // 10 away, just; and nearer than the divider, which lies under it
  EXPECT_EQ(gesture.kind(), DragKind::light);
  EXPECT_FALSE(gesture.is_vertical());
  EXPECT_EQ(gesture.grabbed(), glm::dvec2(200, 100));
  gesture.move({207, 109}, 0.01);
  EXPECT_EQ(gesture.grabbed(), glm::dvec2(201, 101));  // at once: a handle is no pixel to be picked
  EXPECT_EQ(gesture.moved(), glm::dvec2(1, 1));
  EXPECT_FALSE(gesture.release(left, {207, 109}, 0.02));
  gesture.press(left, GLFW_MOD_SHIFT, {195, 100}, 1, targets);
  EXPECT_EQ(gesture.kind(), DragKind::light);
  EXPECT_TRUE(gesture.is_vertical());
  gesture.cancel();
  gesture.press(left, 0, {206, 108.1}, 2, {.light = targets.light, .divider = std::nullopt, .scale = 1});
  EXPECT_EQ(gesture.kind(), DragKind::waiting);  // past it
  EXPECT_FALSE(gesture.is_vertical());
  gesture.cancel();
  gesture.press(left, 0, {212, 116}, 3, {.light = targets.light, .divider = std::nullopt, .scale = 2});
  EXPECT_EQ(gesture.kind(), DragKind::light);
  gesture.cancel();
  gesture.press(right, 0, {200, 100}, 4, targets);
  EXPECT_EQ(gesture.kind(), DragKind::waiting);  // other buttons do not grab
}

TEST(viewer_mouse, the_nearest_handle_of_the_light_is_grabbed) {
  const GrabTargets targets{.light = glm::dvec2(200, 100),
                            .divider = 212,
                            .scale = 1,
                            .sizes = {glm::dvec2(212, 100), std::nullopt, glm::dvec2(188, 100)}};
  Gesture gesture;
  const auto grabs = [&](glm::dvec2 at) {
    gesture.cancel();
    gesture.press(left, 0, at, 0, targets);
    return gesture.kind();
  };
  EXPECT_EQ(grabs({205, 100}), DragKind::light);  // 5 away, and 7 from the size
  EXPECT_EQ(grabs({207, 100}), DragKind::size);   // 5 from the size
  EXPECT_EQ(gesture.size(), 0u);
  gesture.move({217, 103}, 0.1);
  EXPECT_EQ(gesture.grabbed(), glm::dvec2(222, 103));  // it keeps its offset
  EXPECT_EQ(grabs({185, 100}), DragKind::size);
  EXPECT_EQ(gesture.size(), 2u);
  EXPECT_EQ(grabs({212, 107.9}), DragKind::size);
  EXPECT_EQ(grabs({212, 108.1}), DragKind::divider);
  gesture.cancel();
  gesture.press(left, GLFW_MOD_CONTROL, {212, 100}, 1, targets);
  EXPECT_EQ(gesture.kind(), DragKind::waiting) << "a line may begin anywhere";
  gesture.move({250, 140}, 1.1);
  EXPECT_EQ(gesture.kind(), DragKind::line);
  EXPECT_EQ(gesture.pressed_at(), glm::dvec2(212, 100));
  EXPECT_EQ(gesture.cursor(), glm::dvec2(250, 140));
}

TEST(viewer_mouse, the_divider_is_grabbed_beside_its_line) {
  const GrabTargets targets{.light = std::nullopt, .divider = 300.5, .scale = 1};
  Gesture gesture;
  gesture.press(left, 0, {304, 77}, 0, targets);
  EXPECT_EQ(gesture.kind(), DragKind::divider);
  gesture.move({254, 90}, 0.1);
  EXPECT_EQ(gesture.grabbed().x, 250.5);
  EXPECT_FALSE(gesture.release(left, {254, 90}, 0.2));
  gesture.press(left, 0, {306, 77}, 1, targets);
  EXPECT_EQ(gesture.kind(), DragKind::waiting);
  gesture.cancel();
  gesture.press(left, 0, {306, 77}, 2, {.light = std::nullopt, .divider = 300.5, .scale = 1.25});
  EXPECT_EQ(gesture.kind(), DragKind::divider);
  gesture.cancel();
  gesture.press(left, GLFW_MOD_SHIFT, {300, 77}, 3, targets);
  gesture.move({320, 77}, 3.1);
  EXPECT_EQ(gesture.kind(), DragKind::pan);
}

TEST(viewer_mouse, one_button_at_a_time) {
  Gesture gesture;
  gesture.press(left, 0, {100, 100}, 0, nothing_else);
  gesture.move({150, 100}, 0.1);
  gesture.press(right, 0, {150, 100}, 0.2, nothing_else);
  EXPECT_EQ(gesture.kind(), DragKind::orbit);
  EXPECT_FALSE(gesture.release(right, {150, 100}, 0.3));
  EXPECT_EQ(gesture.kind(), DragKind::orbit);
  EXPECT_EQ(gesture.moved(), glm::dvec2(50, 0));
  gesture.cancel();
  EXPECT_EQ(gesture.kind(), DragKind::nothing);
  EXPECT_FALSE(gesture.release(left, {150, 100}, 0.4));
  gesture.move({0, 0}, 0.5);
  EXPECT_EQ(gesture.moved(), glm::dvec2(0));
}

// Whatever buttons and points come: a click is reported only by a release of the button that was pressed, within 3 px and
// 0.5 s of it, and never after it was a drag.
TEST(viewer_mouse, no_row_of_events_clicks_by_accident) {
  Random random(3);
  Gesture gesture;
  int click_count = 0;
  glm::dvec2 pressed(0), cursor(0);
  double now = 0, pressed_at = 0, farthest = 0;
  int down = -1;
  for (int i = 0; i < 200000; ++i) {
    now += random.uniform(0, 0.3);
    cursor = glm::dvec2(random.below(5), random.below(5));
    if (down >= 0) farthest = std::max(farthest, glm::distance(cursor, pressed));
    const int button = random.below(3);
    switch (random.below(4)) {
      case 0:
        gesture.press(button, random.below(4) ? 0 : GLFW_MOD_SHIFT, cursor, now, nothing_else);
        if (down < 0) down = button, pressed = cursor, pressed_at = now, farthest = 0;
        break;
      case 1: {
        const auto clicked = gesture.release(button, cursor, now);
        if (clicked) {
          ++click_count;
          ASSERT_EQ(down, left);
          ASSERT_EQ(button, left);
          ASSERT_EQ(*clicked, pressed);
          ASSERT_LE(now - pressed_at, 0.5);
          ASSERT_LE(farthest, 3);
        }
        if (button == down) down = -1;
        break;
      }
      default:
        gesture.move(cursor, now);
    }
    ASSERT_EQ(gesture.kind() == DragKind::nothing, down < 0);
  }
  EXPECT_GT(click_count, 100);
}

TEST(viewer_mouse, the_help_names_each_use_once) {
  std::set<std::string_view> names;
  for (const MouseRow& row : mouse_rows) {
    EXPECT_TRUE(names.insert(row.name).second);
    EXPECT_TRUE(row.sentence.ends_with('.'));
  }
  EXPECT_GE(names.size(), 6u);
}

}  // namespace mouse_test
