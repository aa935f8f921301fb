#include "measure/picture/detail_export.h"

#include <gnomon/kit/pictures/surface_detail.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <unordered_map>
#include <unordered_set>

#include "measure/scene/fields.h"

namespace gnomon {

namespace {

constexpr std::uint64_t magic = 0x32'6c'74'64'6d'6e'67ull;  // "gnmdtl2"

/// A word that no other mesh has.
std::string object_name(const Scene& scene, std::size_t mesh, std::unordered_set<std::string>& taken) {
  std::string word = scene.meshes[mesh].name.empty() ? fmt::format("mesh_{}", mesh) : scene.meshes[mesh].name;
  for (char& c : word)
    if (static_cast<unsigned char>(c) <= ' ' || c == '#' || c == '\\' || c == 0x7f) c = '_';
  while (!taken.insert(word).second) word += fmt::format("_{}", mesh);
  return word;
}

/// The corners of a face, numbered within its mesh from 0; corners that came to be one count once.
using Face = std::vector<std::uint32_t>;

}  // namespace

std::vector<std::byte> detail_bytes(const SurfaceDetail& detail) {
  FieldWriter io;
  io(magic, detail.corners, detail.polygons);
  return std::move(io.bytes);
}

SurfaceDetail detail_from_bytes(std::span<const std::byte> bytes) {
  FieldReader io(bytes, fmt::format("surface detail ends early: it has {} bytes", bytes.size()));
  std::uint64_t mark = 0;
  io(mark);
  if (mark != magic) throw Error("these bytes are no surface detail: they begin with {:#x}, not {:#x}", mark, magic);
  SurfaceDetail detail;
  io(detail.corners, detail.polygons);
  if (io.left() > 0)
    throw Error("{} bytes are left after the {} polygons of a surface detail", io.left(), detail.polygons.size());
  for (const DetailPolygon& polygon : detail.polygons) {  // a flag of any other bits is neither true nor false
    if (const auto flag = *reinterpret_cast<const std::uint8_t*>(&polygon.is_lit); flag > 1)
      throw Error("a polygon of a surface detail is lit by {}, neither 0 nor 1", flag);
    if (const auto flag = *reinterpret_cast<const std::uint8_t*>(&polygon.is_penumbra); flag > 1)
      throw Error("a polygon of a surface detail is in the penumbra by {}, neither 0 nor 1", flag);
  }
  return detail;
}

std::string detail_obj(const Scene& scene, const SurfaceDetail& detail, std::span<const std::string> notes,
                       const std::string& mtl_name) {
  double largest = 0;
  for (const glm::dvec3& p : detail.corners) largest = std::max({largest, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  // Rounding noise beside zero would be digits of its own.
  const auto shown = [&](double x) { return std::abs(x) <= 1e-14 * largest ? 0.0 : x; };
  std::string body, line;
  constexpr std::array<std::string_view, 3> kinds = {"lit", "penumbra", "shadowed"};
  std::array<std::size_t, 3> written{};  // of each kind
  std::size_t vertex_count = 0;
  std::unordered_set<std::string> taken;
  for (std::size_t begin = 0, end = 0; begin < detail.polygons.size(); begin = end) {
    const std::uint32_t mesh = detail.polygons[begin].mesh;
    while (end < detail.polygons.size() && detail.polygons[end].mesh == mesh) ++end;
    body += fmt::format("o {}\n", object_name(scene, mesh, taken));
    std::unordered_map<std::string, std::uint32_t> vertices;
    std::array<std::vector<Face>, 3> faces;
    for (std::size_t k = begin; k < end; ++k) {
      const DetailPolygon& polygon = detail.polygons[k];
      Face face;
      for (std::uint32_t c = 0; c < polygon.count; ++c) {
        const glm::dvec3& p = detail.corners[polygon.first + c];
        line = fmt::format("{:.10g} {:.10g} {:.10g}", shown(p.x), shown(p.y), shown(p.z));
        const auto [place, is_new] = vertices.try_emplace(line, static_cast<std::uint32_t>(vertices.size()));
        if (is_new) body.append("v ").append(line).append("\n");
        if (face.empty() || face.back() != place->second) face.push_back(place->second);
      }
      while (face.size() > 1 && face.back() == face.front()) face.pop_back();
      if (face.size() >= 3) faces[polygon.is_lit ? 0 : polygon.is_penumbra ? 1 : 2].push_back(std::move(face));
    }
    for (std::size_t kind = 0; kind < kinds.size(); ++kind) {
      if (faces[kind].empty()) continue;
      body += fmt::format("usemtl {}\n", kinds[kind]);
      for (const Face& face : faces[kind]) {
        body += 'f';
        for (const std::uint32_t v : face) fmt::format_to(std::back_inserter(body), " {}", vertex_count + v + 1);
        body += '\n';
      }
      written[kind] += faces[kind].size();
    }
    vertex_count += vertices.size();
  }
  std::string head = fmt::format(
      "{}: the parts of triangles that are lit, in a penumbra and in cast shadow. Units: meters, +y is up.\n", detail_mark);
  for (std::string note : notes) {
    std::ranges::replace_if(
        note, [](unsigned char c) { return c < ' '; }, ' ');
    head += fmt::format("# {}\n", note);
  }
  const std::string penumbra = written[1] > 0 ? fmt::format("{} penumbra, ", written[1]) : "";
  head += fmt::format("# polygons: {} lit, {}{} shadowed\n", written[0], penumbra, written[2]);
  const std::size_t left_out = detail.polygons.size() - written[0] - written[1] - written[2];
  if (left_out > 0) head += fmt::format("# left out: {} that are smaller than the last digit\n", left_out);
  return head + fmt::format("mtllib {}\n", mtl_name) + body;
}

std::string detail_mtl() {
  std::string text = fmt::format("{}: materials\n", detail_mark);
  const std::vector<DebugLayer> layers = soft_detail_layers();
  for (const Swatch& s : layers.at(0).legend)
    text += fmt::format("newmtl {}\nKd {:.4f} {:.4f} {:.4f}\nillum 1\n", s.name, s.color.r, s.color.g, s.color.b);
  return text;
}

}  // namespace gnomon
