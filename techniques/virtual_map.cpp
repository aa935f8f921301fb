// Virtual shadow map: pages of one huge depth image of the light. Only the pages that the picture requests are drawn, at the
// level that its pixels request.
//
// All but the fit is work of resolve. A pass over the G-buffer writes for every pixel which page it requests; the processor
// collects these words and sorts the casters' triangles to pages; each page draws its own; a second pass looks up, by the very
// words that the first one wrote, so that no rounding can make it miss a page. After an update pages stay in the pool that no
// moving caster touches (StillPages).
#include <gnomon/kit/counts.h>
#include <gnomon/kit/geometry/camera.h>
#include <gnomon/kit/maps/map_causes.h>
#include <gnomon/kit/shared.h>
#include <gnomon/registry.h>

#include <utility>

#include "virtual_map/layers.h"
#include "virtual_map/pool.h"

namespace {
using namespace gnomon;
using namespace gnomon::virtual_map;

constexpr About about{
    .title = "Virtual shadow map",
    .summary = "Pages of one huge depth image, drawn only where and as fine as the picture's pixels need.",
    .source =
        "Lefohn, Sengupta and Owens 2007 (resolution-matched shadow maps); Fernando et al. 2001 (pages of levels); Dou et al. "
        "2014 (bias of the receiver's own plane)",
    .error =
        "Stair steps along shadow edges, as wide as a texel: 1/texels_per_pixel of a pixel's side or less, more where the "
        "light sees a pixel over eight times as long as wide. Where more pages are needed than there is room for, all "
        "texels are 2^levels_raised times as wide. "
        "Holes are those of the mask with alpha=texel alone: mips and mips_kept filter alpha, and hashed is random "
        "where alpha is neither 0 nor 1. A texel holds no product: glass is taken for opaque or left out.",
    .fails =
        "Pixels that need pages far apart: surfaces edge-on to the light, leaves and grass; a page is then drawn for a few "
        "pixels. All but the fit is work of resolve, paid for in every picture. Where some casters move and others do not, the "
        "first resolve after an update keeps pages that none of the moving ones touches, and draws the others.",
    .device = Device::opengl,
    .floor = Floor::depth_draw,
    .handles = with_gray_transmission,
    .causes = map_causes};

class VirtualMap final : public Technique {
  Number<double> texels_per_pixel =
      Number<double>(this, "texels_per_pixel", 1, {.unit = "texel", .min = 1, .max = 16, .log = true}, Stage::resolve,
                     "How many texels there are at least along a pixel's side: of levels, each half as fine as the one before, "
                     "a pixel takes the coarsest that has as many.");
  Choice measure = Choice(this, "measure", "shorter", {"shorter", "mean"}, Stage::setup,
                          "Which of a pixel's sides counts, seen from the light: the shorter one (or an eighth of the longer "
                          "one, where that is more), or the geometric mean of both.");
  Choice page_size = Choice(this, "page_size", "128", {"64", "128", "256"}, Stage::setup,
                            "Texels along a page's side: of larger pages more lies beside what is needed, of smaller ones "
                            "there are more to draw.");
  Number<int> pages =
      Number<int>(this, "pages", 8192, {.unit = "page", .min = 6, .max = 32768, .log = true}, Stage::resolve,
                  "Room: of more pages than this all levels are raised until they fit, and levels_raised counts by how many. "
                  "A page takes 64 KiB (16 KiB, 256 KiB) where page_size is 128 (64, 256); what is not needed takes none, "
                  "but where some casters move there is room for up to a quarter more.");
  Number<double> depth_bias =
      Number<double>(this, "depth_bias", 2, {.unit = "texel", .min = 0, .max = 64}, Stage::resolve,
                     "What is added to the bias of the receiver's own plane, in world widths of a texel at the point.");
  AlphaSetting alpha{this, Stage::resolve};
  GlassSetting glass{this};

 public:
  Support supports(const Scene& scene, const Light& light, const View&) const override {
    const bool moves = std::ranges::any_of(scene.meshes, [](const Mesh& mesh) { return !mesh.reach.empty(); });
    const PoolLayout layout(static_cast<std::size_t>(pages.value()), size(),
                            moves ? PoolLayout::Room::in_steps : PoolLayout::Room::exact);
    if (const Support support = light_map_support(light, PoolLayout::width, fit_margin, 1); !support) return support;
    const Support support = within_limits({.texture_size = layout.rows * size(), .texture_layers = layout.layers});
    return glass.limit(scene, alpha.limit(scene, support));
  }
  void setup() override {
    made_->drawer.setup();
    for (int k = 0; k < light_projection_count; ++k) {
      const auto projection = LightProjection(k);
      const std::string constants = light_map_constants(projection);
      const auto program = [&](std::string_view title, std::string_view more, std::string_view define, std::string_view body) {
        return pass_program(title, fmt::format("{}{}", constants, more),
                            fmt::format("{}{}{}{}", define, light_map_head(projection), page_head(size()), body));
      };
      made_->address_programs[k] =
          program("virtual_map addresses", "", fmt::format("#define MEASURE {}\n", measure.index()), address_fragment);
      made_->look_up_programs[k] = program("virtual_map look-up", look_up_constants, "", look_up_fragment);
      made_->explain_programs[k] = program("virtual_map look-up", look_up_constants, "#define EXPLAIN\n", look_up_fragment);
    }
    made_->framebuffer = make_framebuffer();
    warm_up(*this);
  }
  void build(const Scene& scene) override {
    made_->scene = &scene;
    made_->boxes = mesh_boxes(scene, glass.as());
    made_->moving.build(scene);
    made_->glass_difference = {scene, glass.as()};
    made_->solid_parts = solid_parts(scene);
    scene_buffers(scene);
    made_->drawer.build(scene, alpha.rule());
  }
  void update(const Scene& scene, const Changes& changes) override {
    if (!made_->moving.update(scene, changes)) return build(scene);
    made_->glass_difference = {scene, glass.as()};
    for (std::size_t m = 0; m < scene.meshes.size(); ++m)
      if (changes.meshes[m].kind != MeshChange::Kind::still) made_->solid_parts[m] = solid_parts(scene.meshes[m]);
    scene_buffers(scene);
  }
  void relight(const Light& light) override {
    light_ = light;
    LightCamera camera = finest_camera(light, made_->boxes);
    std::optional<EarlierFootprints> earlier;
    if (made_->moving.number().is_update_of(number_) && camera == camera_)
      earlier.emplace(EarlierFootprints{footprints_, made_->moving});
    may_keep_ = earlier.has_value();
    if (!may_keep_) still_pages_ = {};
    number_ = {};  // until all are found
    footprints_ = footprints_of(*made_->scene, made_->solid_parts, camera, earlier);
    camera_ = std::move(camera);
    number_ = made_->moving.number();
  }
  void resolve(const GBuffer& gbuffer, VisibilityMask& mask) override {
    const StateGuard guard;
    gbuffer_ = &gbuffer;
    if (made_->read_back.of == this) made_->read_back = {};
    made_->drawer.use_alpha(alpha.rule());
    find_addresses();
    table_ = pages_of(asked_, static_cast<std::size_t>(pages.value()), top());
    fill(lists_, *made_->scene, scene_buffers(*made_->scene), camera_, footprints_, table_, size());
    draw_pages();
    look_up(made_->look_up_programs[projection()], pool_, mask.texture());
    glFinish();
  }
  Counts counts() const override {
    const double shared_bytes =
        static_cast<double>(made_->drawer.bytes() + bytes_of(made_->solid_parts) + made_->moving.bytes());
    const double bytes =
        static_cast<double>(pool_.bytes + addresses_.bytes + places_.bytes + lists_.bins.bytes() + still_pages_.bytes() +
                            bytes_of(footprints_.all, asked_, table_.pages, lists_.corners, layout_.slots));
    Counts counts{{"pages_asked_for", double(table_.asked_count), "page"},
                  {"pages", double(table_.pages.size()), "page"},
                  most_of("levels", table_.level_count()),
                  most_of("levels_raised", table_.raised),
                  {"texels", double(table_.pages.size()) * size() * size(), "texel"},
                  count_of("triangles", drawn_.triangles),
                  {"bytes", bytes + made_.own(shared_bytes), "byte"}};
    if (has_still_pages()) counts.push_back({"pages_drawn", double(drawn_.pages), "page"});
    return counts;
  }
  std::unique_ptr<Technique> for_another_light() const override { return another(*this, &VirtualMap::made_); }
  std::optional<Explanation> explain(std::size_t index) const override {
    Explanation why;
    if (!faces_light(*made_->scene, *gbuffer_, light_, index)) return why;
    if (const PageAddress page = page_at(index); page.word != PageAddress::none) why = explain_look_up(index, page);
    made_->glass_difference.explain(why, *gbuffer_, light_, index);
    return why;
  }
  std::vector<std::uint32_t> image_parts() const override {
    std::vector<std::uint32_t> pages(asked_.size());
    for (std::size_t i = 0; i < pages.size(); ++i) pages[i] = page_at(i).word;
    return pages;
  }
  std::vector<DebugLayer> debug_layers() const override { return virtual_map::debug_layers(); }
  std::vector<float> draw_debug(std::string_view layer) const override {
    if (layer == "map") {
      const std::vector<float> depths = read_texels<float>(pool_, GL_DEPTH_COMPONENT);
      const auto depth_at = [&](std::uint32_t slot, const glm::ivec2& texel) {
        const glm::ivec3 place = layout_.place(slot);
        const std::size_t row = std::size_t(place.z) * pool_.height + place.y * size() + texel.y;
        return depths[row * pool_.width + place.x * size() + texel.x];
      };
      return paint_map(camera_, table_, size(), gbuffer_->width, gbuffer_->height, depth_at);
    }
    if (layer != "pages" && layer != "texels") return Technique::draw_debug(layer);
    std::vector<PageAddress> pages(gbuffer_->size());
    std::vector<glm::ivec2> texels(gbuffer_->size());
    for (std::size_t i = 0; i < pages.size(); ++i) {
      pages[i] = page_at(i);
      texels[i] = glm::ivec2(looked_up()[i]);
    }
    const std::vector<float> mask = answer(pool_);
    const Resolved resolved{camera_, *made_->scene, *gbuffer_, light_, pages, texels, mask};
    return layer == "pages" ? paint_pages(resolved) : paint_texels(resolved);
  }

 private:
  int size() const { return 64 << page_size.index(); }
  int top() const { return top_level(size()); }
  int projection() const { return static_cast<int>(projection_of(camera_)); }
  /// The page that a pixel was looked up in; none where it does not face the light, or nothing casts.
  PageAddress page_at(std::size_t index) const {
    return asked_[index] == PageAddress::none ? PageAddress() : PageAddress{asked_[index]}.raised(table_.raised, top());
  }
  /// Taps and what comes with them, of a pixel that looks into this page.
  Explanation explain_look_up(std::size_t index, const PageAddress& page) const {
    const LightImage image = at_level(camera_.images[page.face()], page.level());
    const glm::dvec3 point = gbuffer_->position(index), q = image.seen(point);
    const glm::dvec3 ray = image.is_perspective ? q / q.z : glm::dvec3(0, 0, 1);
    const double facing = -glm::dot(image.turned(gbuffer_->normal(index)), ray);
    Explanation why;
    why.texel_width = image.largest_texel(q);
    const double error = camera_.rounding * (image.is_perspective ? 1 + q.z * q.z / (image.near * image.far) : 1);
    why.bias = (depth_bias * why.texel_width + (error + why.texel_width / 128) / facing) * glm::length(ray);
    const glm::vec4 looked = looked_up()[index];
    why.taps.push_back(image.tap(glm::dvec2(looked) + 0.5, image.axis_distance(looked.z), 1));
    why.cause = alpha_cause(index);
    return why;
  }
  void find_addresses() {
    const GBufferTextures& textures = gbuffer_textures(*gbuffer_, *made_->scene);
    const Program& program = made_->address_programs[projection()];
    set_light_camera(program, light_, camera_);
    const Camera eye(gbuffer_->view, gbuffer_->width, gbuffer_->height);
    program.set("eye", glm::vec4(eye.eye, std::log2(texels_per_pixel)));
    program.set("axis", glm::vec3(eye.forward));
    program.set("right_step", glm::vec3(eye.ray(1, 0) - eye.ray(0, 0)));
    program.set("down_step", glm::vec3(eye.ray(0, 1) - eye.ray(0, 0)));
    addresses_.fit(GL_R32UI, gbuffer_->width, gbuffer_->height);
    const GLuint framebuffer = made_->framebuffer.name(), none[4] = {};
    glNamedFramebufferTexture(framebuffer, GL_COLOR_ATTACHMENT0, addresses_.name(), 0);
    glClearNamedFramebufferuiv(framebuffer, GL_COLOR, 0, none);
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
    glViewport(0, 0, gbuffer_->width, gbuffer_->height);
    bind_gbuffer(textures);
    glUseProgram(program.name());
    draw_receivers(textures);
    asked_.resize(gbuffer_->size());
    glGetTextureImage(addresses_.name(), 0, GL_RED_INTEGER, GL_UNSIGNED_INT, static_cast<GLsizei>(4 * asked_.size()),
                      asked_.data());
  }
  /// Gives pages their places, and draws those that the pool does not hold. Where some casters move and others do not, the
  /// first resolve after a relight that could keep what it found keeps pages.
  void draw_pages() {
    const HoleTest test = made_->drawer.hole_test();
    std::vector<std::uint8_t> moving, kept;
    if (has_still_pages()) moving = pages_of_moving(lists_, footprints_, made_->moving, table_.pages.size());
    layout_ = PoolLayout(table_.pages, size(), moving);
    const StillPages before = std::exchange(still_pages_, {});  // none until all is drawn
    if (std::exchange(may_keep_, false)) kept = before.kept(table_, layout_, moving, test.rule);
    write_places();
    drawn_ = made_->drawer.draw(camera_, table_, lists_, layout_, pool_, test, kept);
    still_pages_ = StillPages(table_, layout_, moving, test.rule);
  }
  bool has_still_pages() const { return made_->moving.divide(made_->boxes); }
  /// Writes for each pixel where its page lies in the pool.
  void write_places() {
    std::vector<std::uint32_t> places(asked_.size());
    for_blocks(asked_.size(), 16384, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        if (asked_[i] == PageAddress::none) continue;
        places[i] = i > begin && asked_[i] == asked_[i - 1] ? places[i - 1] : layout_.word(table_.index(page_at(i)));
      }
    });
    places_.fit(GL_R32UI, gbuffer_->width, gbuffer_->height);
    glTextureSubImage2D(places_.name(), 0, 0, 0, gbuffer_->width, gbuffer_->height, GL_RED_INTEGER, GL_UNSIGNED_INT,
                        places.data());
  }
  void look_up(const Program& program, const Texture& pool, unsigned target) const {
    set_light_camera(program, light_, camera_, [&](const LightImage& image) {
      return image.is_perspective ? camera_.rounding / (image.near * image.far) : image.far;
    });
    program.set("look_up", glm::vec4(depth_bias.value(), camera_.rounding, table_.raised, 0));
    glBindTextureUnit(3, pool.name());
    glBindTextureUnit(4, addresses_.name());
    glBindTextureUnit(5, places_.name());
    draw_mask(program, made_->framebuffer, target, gbuffer_textures(*gbuffer_, *made_->scene));
  }
  /// Where each pixel looked in the last resolve, by the shader itself: next to a border of texels, float32 decides.
  const std::vector<glm::vec4>& looked_up() const {
    ReadBack& read_back = made_->read_back;
    if (read_back.of == this) return read_back.looked_up;
    const StateGuard guard;
    const Texture texels(GL_RGBA32F, gbuffer_->width, gbuffer_->height);
    look_up(made_->explain_programs[projection()], pool_, texels.name());
    read_back = {.of = this, .looked_up = read_texels<glm::vec4>(texels, GL_RGBA), .alpha_difference = {}};
    return read_back.looked_up;
  }
  /// The mask of the last resolve, once more, of its pages in this pool.
  std::vector<float> answer(const Texture& pool) const {
    return read_mask(*gbuffer_, [&](unsigned target) { look_up(made_->look_up_programs[projection()], pool, target); });
  }
  /// What of `alpha` explains a wrong pixel of the last resolve; empty where nothing does.
  std::string_view alpha_cause(std::size_t index) const {
    const AlphaRule rule = made_->drawer.hole_test().rule;
    if (rule == AlphaRule::texel) return "";
    looked_up();  // what is read back is this object's from here on
    const auto draw = [&](Texture& by_texel) { made_->drawer.draw(camera_, table_, lists_, layout_, by_texel, {}); };
    return AlphaDifference::cause(made_->read_back.alpha_difference, rule, made_->glass_difference.has_glass(), index, pool_,
                                  draw, [&](const Texture& pool) { return answer(pool); });
  }

  /// What questions need, in memory: of one object at a time.
  struct ReadBack {
    const VirtualMap* of = nullptr;
    std::vector<glm::vec4> looked_up;  // by pixel
    std::optional<AlphaDifference> alpha_difference;
  };
  struct Made {
    ReadBack read_back;
    PageDrawer drawer;
    std::array<Program, light_projection_count> address_programs, look_up_programs, explain_programs;
    Framebuffer framebuffer;
    const Scene* scene = nullptr;
    GlassDifference glass_difference;
    MeshBoxes boxes;
    MovingMeshes moving;
    SolidParts solid_parts;
  };
  Shared<Made> made_;
  Light light_;
  LightCamera camera_;           // of level 0
  MovingMeshes::Number number_;  // of what the footprints are of
  Footprints footprints_;
  std::vector<std::uint32_t> asked_;  // by pixel: a PageAddress
  PageTable table_;
  DrawLists lists_;
  PoolLayout layout_;
  bool may_keep_ = false;   // pages, in the next resolve
  StillPages still_pages_;  // of the pool, of this camera
  Drawn drawn_;
  Texture addresses_, places_, pool_;
  const GBuffer* gbuffer_ = nullptr;
};

}  // namespace

GNOMON_TECHNIQUE(virtual_map, VirtualMap, about)
