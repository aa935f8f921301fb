// A plugin that misbehaves where and how the environment says, UNRULY=PLACE:DEED, and is sound elsewhere. Places: load (the
// library's own initialization), roll, constructor, layers, detail, supports, scene. Compiled by itself, without
// gnomon_add_plugin, so that it can misbehave before its roll is called.
#include <gnomon/registry.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <stdexcept>
#include <string>

namespace {
using namespace gnomon;

void misbehave(const std::string& place) {
  const char* const asked = std::getenv("UNRULY");
  const std::string all = asked ? asked : "";
  if (all.substr(0, all.find(':')) != place) return;
  const std::string deed = all.substr(all.find(':') + 1);
  if (deed == "throw") throw std::runtime_error("it throws");
  if (deed == "throw_a_number") throw 5;
  if (deed == "abort") std::abort();
  if (deed == "exit") std::exit(0);
  if (deed == "segv") {
    std::signal(SIGSEGV, SIG_DFL);  // a sanitizer would end the process in a way of its own
    std::raise(SIGSEGV);
  }
  if (deed == "hang") pause();
}

[[maybe_unused]] const bool is_loaded = (misbehave("load"), true);

bool gives_nothing(const std::string& place) {
  const char* const asked = std::getenv("UNRULY");
  return asked && asked == place + ":nothing";
}

class Unruly final : public Technique {
  Number<int> level{this, "level", 3, {"", 1, 9}, Stage::relight, "A whole number."};
  Number<double> share{this, "share", 0.5, {"", 0, 1}, Stage::relight, "A number."};
  Choice word{this, "word", "one", {"one", "two"}, Stage::setup, "A word."};
  Flag flag{this, "flag", false, Stage::build, "Yes or no."};

 public:
  Unruly() {
    misbehave("constructor");
    set_id("unruly");
  }
  Support supports(const Scene&, const Light&, const View&) const override {
    misbehave("supports");
    return Support::full();
  }
  void setup() override {}
  void build(const Scene&) override {}
  void relight(const Light&) override {}
  void resolve(const GBuffer&, VisibilityMask& mask) override {
    for (float& pixel : mask.pixels()) pixel = 1;
  }
  Counts counts() const override { return {{"bytes", 0, "byte"}}; }
  std::optional<SurfaceDetail> surface_detail() const override {
    misbehave("detail");
    return std::nullopt;
  }
  std::vector<DebugLayer> debug_layers() const override {
    misbehave("layers");
    return {{.name = "gray", .sentence = "Nothing.", .legend = {{"gray", {0.5, 0.5, 0.5}}}}};
  }
};

class UnrulyScene final : public SceneGenerator {
  Number<double> width{this, "width", 8, {"m", 1, 100}, Stage::build, "Of the ground."};

 public:
  UnrulyScene() { set_id("unruly_scene"); }
  Scene make() const override {
    misbehave("scene");
    Scene scene;
    const auto half = static_cast<float>(width / 2);
    Mesh& ground = scene.meshes.emplace_back();
    ground.positions = {{-half, 0, -half}, {-half, 0, half}, {half, 0, half}, {half, 0, -half}};
    ground.triangles = {{0, 1, 2}, {0, 2, 3}};
    scene.lights = {{.name = "point", .kind = PointLight{{0, 4, 0}}}, {.name = "sun", .kind = DirectionalLight{}}};
    scene.views = {{.name = "main", .eye = {0, 5, 8}, .target = {0, 0, 0}}};
    finish(ground);
    return scene;
  }
};
}  // namespace

extern "C" {
extern const int gnomon_plugin_abi;
const int gnomon_plugin_abi = gnomon::abi_version;
void gnomon_plugin_roll_call(gnomon::Registry& registry) {
  misbehave("roll");
  constexpr gnomon::About about{
      .title = "Unruly", .summary = "It does as it is told.", .source = "none", .error = "All of it.", .fails = "Everywhere."};
  registry.add(gnomon::TechniqueEntry{"unruly", about, []() -> std::unique_ptr<gnomon::Technique> {
                                        if (gives_nothing("constructor")) return nullptr;
                                        return std::make_unique<Unruly>();
                                      }});
  registry.add(gnomon::SceneEntry{"unruly_scene",
                                  {.title = "Unruly", .summary = "A ground."},
                                  []() -> std::unique_ptr<gnomon::SceneGenerator> { return std::make_unique<UnrulyScene>(); }});
}
}
