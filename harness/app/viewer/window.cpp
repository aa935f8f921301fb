// The window: GLFW for display and events, OpenGL for its picture, Dear ImGui for what is around it.
#include "app/viewer/window.h"

#include <epoxy/gl.h>
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <fcntl.h>
#include <gnomon/error.h>
#include <imgui.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <deque>
#include <filesystem>
#include <system_error>
#include <utility>

#include "app/viewer/keys.h"
#include "app/viewer/widgets.h"

namespace gnomon::viewer {

namespace {

constexpr const char* font_file = "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf";
constexpr double font_height = 14;  // pixels at scale 1

// GLFW's callbacks find both here: there is one window.
std::vector<WindowEvent> events;
std::vector<int> struck_keys;           // since the last picture
std::deque<WindowEvent> button_events;  // that have yet to be passed to Dear ImGui
std::string last_error;
glm::dvec2 mouse_place{0};

void on_error(int, const char* words) { last_error = words; }

void add_press(WindowEvent::Kind kind, int code, int modifiers, bool is_pressed) {
  events.push_back({.kind = kind, .code = code, .modifiers = modifiers, .is_pressed = is_pressed, .place = mouse_place});
}

void on_key(GLFWwindow*, int key, int scancode, int action, int modifiers) {
  if (action == GLFW_REPEAT) return;
  if (action == GLFW_PRESS && key >= 0) struck_keys.push_back(key);
  const char* const cap = glfwGetKeyName(key, scancode);
  add_press(WindowEvent::Kind::key, cap ? key_of_cap(key, cap) : key, modifiers, action == GLFW_PRESS);
}

void on_button(GLFWwindow*, int button, int action, int modifiers) {
  add_press(WindowEvent::Kind::button, button, modifiers, action == GLFW_PRESS);
  button_events.push_back(events.back());
}

void on_motion(GLFWwindow* window, double x, double y) {
  int width = 0, height = 0, across = 0, down = 0;
  glfwGetWindowSize(window, &width, &height);
  glfwGetFramebufferSize(window, &across, &down);
  if (width > 0 && height > 0) mouse_place = {x * across / width, y * down / height};
  events.push_back({.kind = WindowEvent::Kind::motion, .place = mouse_place});
}

void on_wheel(GLFWwindow*, double, double y) {
  events.push_back({.kind = WindowEvent::Kind::wheel, .place = mouse_place, .wheel = y});
}

void on_focus(GLFWwindow*, int focused) {
  if (!focused) events.push_back({.kind = WindowEvent::Kind::focus_lost, .place = mouse_place});
}

/// "DISPLAY is not set" or "DISPLAY is :4".
std::string display_words() {
  const char* const display = std::getenv("DISPLAY");
  return display && *display ? fmt::format("DISPLAY is {}", display) : "DISPLAY is not set";
}

constexpr std::array stopping = {SIGTERM, SIGINT, SIGHUP};
// A handler may do little more than write to a pipe; a thread reads the other end.
int ends[2] = {-1, -1};
std::array<struct sigaction, stopping.size()> before;

void on_signal(int) {
  const int kept = errno;
  [[maybe_unused]] const ssize_t ignored = write(ends[1], "", 1);
  errno = kept;
}

}  // namespace

double pixels_per_unit() {
  const double scale = ImGui::GetIO().DisplayFramebufferScale.x;
  return scale > 0 ? scale : 1;
}

Window::Window(const std::string& title) {
  constexpr const char* advice = "gnomon view needs one; gnomon render writes pictures without";
  glfwSetErrorCallback(on_error);
  events.clear();
  button_events.clear();
  if (!glfwInit()) throw Error("there is no display to open a window on ({}): {}; {}", display_words(), last_error, advice);
  for (const int version : {GLFW_CONTEXT_VERSION_MAJOR, GLFW_CONTEXT_VERSION_MINOR}) glfwWindowHint(version, 3);
  glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  glfwWindowHint(GLFW_OPENGL_FORWARD_COMPAT, GLFW_TRUE);
  for (const int unused : {GLFW_VISIBLE, GLFW_DEPTH_BITS, GLFW_STENCIL_BITS}) glfwWindowHint(unused, 0);
  window_ = glfwCreateWindow(640, 480, title.c_str(), nullptr, nullptr);
  if (!window_) {
    glfwTerminate();
    throw Error("the display gives no window with OpenGL 3.3 ({}): {}", display_words(), last_error);
  }
  glfwMakeContextCurrent(window_);
  glfwSwapInterval(1);
  glfwSetKeyCallback(window_, on_key);
  glfwSetMouseButtonCallback(window_, on_button);
  glfwSetCursorPosCallback(window_, on_motion);
  glfwSetScrollCallback(window_, on_wheel);
  glfwSetWindowFocusCallback(window_, on_focus);

  IMGUI_CHECKVERSION();
  ImGui::CreateContext();
  ImGui::GetIO().IniFilename = nullptr;
  ImGui::GetIO().LogFilename = nullptr;
  // Calls our callbacks, too.
  ImGui_ImplGlfw_InitForOpenGL(window_, true);
  ImGui_ImplOpenGL3_Init("#version 330 core");

  glGenTextures(1, &texture_);
  glBindTexture(GL_TEXTURE_2D, texture_);
  for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER}) glTexParameteri(GL_TEXTURE_2D, filter, GL_NEAREST);
  for (const GLenum wrap : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T}) glTexParameteri(GL_TEXTURE_2D, wrap, GL_CLAMP_TO_EDGE);
}

Window::~Window() {
  glDeleteTextures(1, &texture_);
  ImGui_ImplOpenGL3_Shutdown();
  ImGui_ImplGlfw_Shutdown();
  ImGui::DestroyContext();
  glfwDestroyWindow(window_);
  glfwTerminate();
}

void Window::show(int width, int height) {
  int units = 0, ignored = 0;
  glfwGetWindowSize(window_, &units, &ignored);
  const double ratio = units > 0 ? static_cast<double>(size().x) / units : 1;
  const auto in_units = [&](double pixels) { return static_cast<int>(std::lround(pixels / ratio)); };
  glfwSetWindowSizeLimits(window_, in_units(480 * scale()), in_units(320 * scale()), GLFW_DONT_CARE, GLFW_DONT_CARE);
  glfwSetWindowSize(window_, in_units(width), in_units(height));
  glfwShowWindow(window_);
}

glm::ivec2 Window::size() const {
  glm::ivec2 size{0};
  glfwGetFramebufferSize(window_, &size.x, &size.y);
  return size;
}

double Window::scale() const {
  float x = 1, y = 1;
  glfwGetWindowContentScale(window_, &x, &y);
  return std::isfinite(x) && x > 0 ? std::clamp<double>(x, 0.5, 8) : 1;
}

bool Window::is_closing() const { return glfwWindowShouldClose(window_); }

void Window::wait(double seconds) const {
  if (seconds < 0)
    glfwWaitEvents();
  else if (seconds > 0)
    glfwWaitEventsTimeout(seconds);
  else
    glfwPollEvents();
}

std::vector<WindowEvent> Window::take_events() { return std::exchange(events, {}); }

void Window::wake() { glfwPostEmptyEvent(); }

double Window::now() { return glfwGetTime(); }

void Window::set_picture(std::span<const std::uint32_t> rgba, int width, int height) {
  glBindTexture(GL_TEXTURE_2D, texture_);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
  if (texture_size_ != glm::ivec2(width, height)) {
    texture_size_ = {width, height};
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, width, height, 0, GL_RGBA, GL_UNSIGNED_BYTE, rgba.data());
  } else {
    glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, rgba.data());
  }
}

void Window::load_font() {
  font_scale_ = scale();
  ImGuiIO& io = ImGui::GetIO();
  io.Fonts->Clear();
  std::error_code ignored;
  if (std::filesystem::is_regular_file(font_file, ignored))
    io.Fonts->AddFontFromFileTTF(font_file, static_cast<float>(std::round(font_height * font_scale_)));
  if (io.Fonts->Fonts.empty()) {
    ImFontConfig config;
    config.SizePixels = static_cast<float>(std::round(13 * font_scale_));
    io.Fonts->AddFontDefault(&config);
  }
  ImGui_ImplOpenGL3_DestroyFontsTexture();
  ImGui_ImplOpenGL3_CreateFontsTexture();
  set_style(font_scale_ / pixels_per_unit());
  io.FontGlobalScale = static_cast<float>(1 / pixels_per_unit());
}

/// Passes on one event of a button, with the place and the modifier keys of that moment. Dear ImGui looks at the mouse once a
/// picture, so that a click would be lost when the next one, or Ctrl+S, comes before the picture.
void Window::pass_button_event() {
  ImGuiIO& io = ImGui::GetIO();
  const auto is_down = [&](int left, int right) { return io.KeysDown[left] || io.KeysDown[right]; };
  io.KeyCtrl = is_down(GLFW_KEY_LEFT_CONTROL, GLFW_KEY_RIGHT_CONTROL);
  io.KeyShift = is_down(GLFW_KEY_LEFT_SHIFT, GLFW_KEY_RIGHT_SHIFT);
  io.KeyAlt = is_down(GLFW_KEY_LEFT_ALT, GLFW_KEY_RIGHT_ALT);
  if (button_events.empty()) {
    std::copy(std::begin(io.MouseDown), std::end(io.MouseDown), buttons_down_.begin());
    passed_place_ = mouse_place;
    return;
  }
  const WindowEvent event = button_events.front();
  const auto unit = static_cast<float>(pixels_per_unit());
  const ImVec2 place(static_cast<float>(event.place.x) / unit, static_cast<float>(event.place.y) / unit);
  // A drag ends where the button goes up, which the button must be down for.
  const bool has_moved = event.place != passed_place_;
  if (event.is_pressed || !has_moved) {
    button_events.pop_front();
    if (event.code >= 0 && event.code < static_cast<int>(buttons_down_.size())) buttons_down_[event.code] = event.is_pressed;
  }
  std::copy(buttons_down_.begin(), buttons_down_.end(), std::begin(io.MouseDown));
  passed_place_ = event.place;
  io.MousePos = place;
  io.KeyCtrl = event.modifiers & GLFW_MOD_CONTROL;
  io.KeyShift = event.modifiers & GLFW_MOD_SHIFT;
  io.KeyAlt = event.modifiers & GLFW_MOD_ALT;
}

bool Window::has_button_events() const { return !button_events.empty(); }

void Window::begin_drawing() {
  ImGui_ImplOpenGL3_NewFrame();
  ImGui_ImplGlfw_NewFrame();
  if (scale() != font_scale_) load_font();
  pass_button_event();
  // It drops text while Control is down, and none is typed so: Control was pressed after it, such as for Ctrl+S in the same
  // picture.
  if (!ImGui::GetIO().InputQueueCharacters.empty()) ImGui::GetIO().KeyCtrl = false;
  // Dear ImGui reads which keys are down: one that was pressed and released between two frames is down for this one.
  auto& down = ImGui::GetIO().KeysDown;
  std::erase_if(struck_keys, [&](int key) { return key >= static_cast<int>(std::size(down)) || down[key]; });
  for (const int key : struck_keys) down[key] = true;
  ImGui::NewFrame();
  for (const int key : struck_keys) down[key] = false;
  struck_keys.clear();
}

void Window::end_drawing() {
  ImGui::Render();
  const glm::ivec2 size = this->size();
  glViewport(0, 0, size.x, size.y);
  glClearColor(0.075f, 0.08f, 0.09f, 1);
  glClear(GL_COLOR_BUFFER_BIT);
  ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
}

void Window::present() { glfwSwapBuffers(window_); }

Picture Window::read_picture() const {
  const glm::ivec2 size = this->size();
  const std::size_t row = static_cast<std::size_t>(size.x) * 3;
  std::vector<std::uint8_t> upward(row * size.y);
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadBuffer(GL_BACK);
  glReadPixels(0, 0, size.x, size.y, GL_RGB, GL_UNSIGNED_BYTE, upward.data());
  Picture picture{size.x, size.y, std::vector<std::uint8_t>(upward.size())};
  for (int y = 0; y < size.y; ++y) std::copy_n(upward.begin() + (size.y - 1 - y) * row, row, picture.rgb.begin() + y * row);
  return picture;
}

void Window::set_clipboard(const std::string& text) { glfwSetClipboardString(window_, text.c_str()); }

StopSignals::StopSignals(std::function<void()> asked) {
  if (pipe2(ends, O_CLOEXEC) != 0) throw std::system_error(errno, std::generic_category(), "pipe");
  thread_ = std::thread([this, asked = std::move(asked)] {
    char ignored = 0;
    while (const ssize_t count = ::read(ends[0], &ignored, 1)) {  // 0: the other end is closed
      if (count < 0) continue;                                    // interrupted
      is_asked_ = true;
      asked();
    }
  });
  struct sigaction ours = {};
  ours.sa_handler = on_signal;
  ours.sa_flags = SA_RESTART | static_cast<int>(SA_RESETHAND);
  for (std::size_t k = 0; k < stopping.size(); ++k) {
    sigaction(stopping[k], nullptr, &before[k]);
    if (before[k].sa_handler != SIG_IGN) sigaction(stopping[k], &ours, nullptr);
  }
}

StopSignals::~StopSignals() {
  for (std::size_t k = 0; k < stopping.size(); ++k) sigaction(stopping[k], &before[k], nullptr);
  close(ends[1]);
  thread_.join();
  close(ends[0]);
}

}  // namespace gnomon::viewer
