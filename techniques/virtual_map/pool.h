#pragma once
#include <gnomon/kit/maps/alpha_levels.h>
#include <gnomon/kit/volumes/volume_faces.h>

#include "places.h"
#include "shaders.h"

namespace gnomon::virtual_map {

/// What was drawn into a pool.
struct Drawn {
  std::size_t pages = 0, triangles = 0;
};

/// Draws pages. One serves all lights of a technique.
class PageDrawer {
 public:
  /// Compiles; needs the context.
  void setup() {
    programs_[0] = CasterPrograms("virtual_map pages", "#define PARALLEL\n" + page_vertex, depth_fragment);
    programs_[1] = CasterPrograms("virtual_map pages", page_vertex, depth_fragment);
    framebuffer_ = make_framebuffer();
    vertex_array_ = make_vertex_array();
  }
  void build(const Scene& scene, AlphaRule rule) {
    scene_ = &scene;
    alpha_levels_ = {};
    use_alpha(rule);
  }
  /// Makes what a rule about holes needs, unless it is there.
  void use_alpha(AlphaRule rule) {
    alpha_levels_.use(*scene_, rule);
    for (CasterPrograms& programs : programs_) programs.fit(*scene_, rule);
  }
  /// By that rule; by the texel's where no mesh has a mask.
  HoleTest hole_test() const { return alpha_levels_.hole_test(); }
  /// The pages of a table, by their lists, into `pool`, which becomes D32F of the layout's size. `test` is `hole_test` or the
  /// texel's. Pages that are `kept`, see StillPages, stay as they are; without it none is.
  Drawn draw(const LightCamera& camera, const PageTable& table, const DrawLists& lists, const PoolLayout& layout, Texture& pool,
             const HoleTest& test, std::span<const std::uint8_t> kept = {}) {
    const SceneBuffers& buffers = scene_buffers(*scene_);
    const int size = layout.page_size;
    pool.fit(GL_DEPTH_COMPONENT32F, PoolLayout::width, layout.rows * size, layout.layers);
    const std::vector<std::uint32_t> drawn = drawn_pages(table, layout, kept);
    const bool are_all = drawn.size() == table.pages.size();
    if (!are_all) clear(drawn, layout, pool);
    bind_vertices(buffers, table, lists, size);
    CasterPrograms& programs = programs_[camera.space.is_parallel() ? 0 : 1];
    if (test.rule != hole_test().rule) programs.fit(*scene_, test.rule);
    // Lists hold triangles with holes and without.
    const Program& program = buffers.masks ? programs.masked(test.rule) : programs.solid();
    buffers.bind_masks(test);
    const GLuint framebuffer = framebuffer_.name();
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
    glUseProgram(program.name());
    glEnable(GL_DEPTH_TEST);
    glEnable(GL_DEPTH_CLAMP);
    glDepthFunc(GL_GREATER);
    int face = -1, layer = -1;
    std::size_t triangles = 0;
    for (const std::uint32_t k : drawn) {
      const glm::ivec3 place = layout.place(k);
      if (place.z != layer) {
        layer = place.z;
        glNamedFramebufferTextureLayer(framebuffer, GL_DEPTH_ATTACHMENT, pool.name(), 0, layer);
        if (are_all) glClearNamedFramebufferfv(framebuffer, GL_DEPTH, 0, &infinitely_far);
      }
      if (table.pages[k].face() != face) {
        face = table.pages[k].face();
        set_image(program, camera.images[face]);
      }
      glViewport(place.x * size, place.y * size, size, size);
      for (const std::uint32_t bin : {2 * k, 2 * k + 1}) {
        const std::uint32_t begin = lists.bins.begin[bin], end = lists.bins.begin[bin + 1];
        if (begin == end) continue;
        triangles += end - begin;
        const auto* const first = reinterpret_cast<const void*>(std::uintptr_t(begin) * 3 * sizeof(std::uint32_t));
        glDrawElementsInstancedBaseInstance(GL_TRIANGLES, static_cast<GLsizei>(3 * (end - begin)), GL_UNSIGNED_INT, first, 1,
                                            k);
      }
    }
    glDisable(GL_DEPTH_CLAMP);
    glDisable(GL_DEPTH_TEST);
    glBindVertexArray(0);
    glNamedFramebufferTexture(framebuffer, GL_DEPTH_ATTACHMENT, 0, 0);
    return {drawn.size(), triangles};
  }
  std::size_t bytes() const { return corners_.bytes() + placements_.bytes() + alpha_levels_.bytes(); }

 private:
  static constexpr float infinitely_far = 0;

  /// Layer after layer, for each new one makes drivers wait; of a layer in rising order, face after face.
  static std::vector<std::uint32_t> drawn_pages(const PageTable& table, const PoolLayout& layout,
                                                std::span<const std::uint8_t> kept) {
    std::vector<std::uint32_t> drawn;
    drawn.reserve(table.pages.size());
    for (std::uint32_t k = 0; k < table.pages.size(); ++k)
      if (kept.empty() || kept[k] == 0) drawn.push_back(k);
    if (layout.layers > 1 && !layout.slots.empty())
      std::ranges::stable_sort(drawn, {}, [&](std::uint32_t k) { return layout.place(k).z; });
    return drawn;
  }
  static void clear(std::span<const std::uint32_t> pages, const PoolLayout& layout, const Texture& pool) {
    const int size = layout.page_size;
    for (const std::uint32_t k : pages) {
      const glm::ivec3 place = layout.place(k);
      glClearTexSubImage(pool.name(), 0, place.x * size, place.y * size, place.z, size, size, 1, GL_DEPTH_COMPONENT, GL_FLOAT,
                         &infinitely_far);
    }
  }
  void bind_vertices(const SceneBuffers& buffers, const PageTable& table, const DrawLists& lists, int page_size) {
    corners_.rewrite(lists.corners);
    placements_.rewrite<glm::vec3>(table.pages.size(), [&](auto room) {
      for (std::size_t k = 0; k < table.pages.size(); ++k) {
        const glm::ivec2 page = table.pages[k].page();
        room[k] = {std::ldexp(2.0f / static_cast<float>(page_size), -table.pages[k].level()), 2 * page.x + 1, 2 * page.y + 1};
      }
    });
    const GLuint vao = vertex_array_.name();
    glVertexArrayVertexBuffer(vao, 0, buffers.positions.name(), 0, sizeof(glm::vec3));
    glVertexArrayVertexBuffer(vao, 1, placements_.name(), 0, sizeof(glm::vec3));
    glVertexArrayBindingDivisor(vao, 1, 1);
    for (GLuint k = 0; k < 2; ++k) {
      glVertexArrayAttribFormat(vao, k, 3, GL_FLOAT, GL_FALSE, 0);
      glVertexArrayAttribBinding(vao, k, k);
      glEnableVertexArrayAttrib(vao, k);
    }
    add_mask_attributes(vertex_array_, buffers);
    glVertexArrayElementBuffer(vao, corners_.name());
    glBindVertexArray(vao);
  }
  static void set_image(const Program& program, const LightImage& image) {
    const glm::dvec2 along_axis = image.is_perspective ? image.offset : glm::dvec2(0);
    const glm::dmat3 rows(image.axis(0) * image.scale.x + image.axis(2) * along_axis.x,
                          image.axis(1) * image.scale.y + image.axis(2) * along_axis.y, image.axis(2));
    program.set("axes", glm::mat3(glm::transpose(rows)));
    program.set("origin", glm::vec3(image.origin));
    program.set("image", glm::vec4(image.near, image.far, image.offset));
  }

  CasterPrograms programs_[2];  // parallel rays, rays from a center
  Framebuffer framebuffer_;
  VertexArray vertex_array_;
  RewrittenBuffer corners_, placements_;
  const Scene* scene_ = nullptr;
  AlphaLevels alpha_levels_;
};

}  // namespace gnomon::virtual_map
