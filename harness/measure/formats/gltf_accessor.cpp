// The numbers of glTF's accessors: buffer views with a stride, components of six types, sparse replacements.
#include <algorithm>
#include <bit>
#include <cstring>

#include "measure/formats/gltf_file.h"

namespace gnomon::importing {
namespace {

enum Component : unsigned { int8 = 5120, uint8 = 5121, int16 = 5122, uint16 = 5123, uint32 = 5125, float32 = 5126 };

std::size_t size_of(unsigned component) { return component <= uint8 ? 1 : component <= uint16 ? 2 : 4; }

double largest_of(unsigned component) {
  constexpr double largest[] = {127, 255, 32767, 65535};
  return component <= uint16 ? largest[component - int8] : 4294967295.0;
}

double component_at(const char* bytes, unsigned component) {
  std::uint32_t bits = 0;
  for (std::size_t k = size_of(component); k-- > 0;) bits = bits << 8 | static_cast<unsigned char>(bytes[k]);
  if (component == int8) return static_cast<std::int8_t>(bits);
  if (component == int16) return static_cast<std::int16_t>(bits);
  if (component == float32) return std::bit_cast<float>(bits);
  return bits;
}

/// Columns of a matrix begin at multiples of four bytes; no type but MAT2 and MAT3 of small components has gaps.
struct ElementType {
  std::string_view name;
  std::size_t width;
};
constexpr ElementType element_types[] = {{"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4},
                                         {"MAT2", 4},   {"MAT3", 9}, {"MAT4", 16}};

}  // namespace

struct GltfFile::Layout {
  std::string where;
  unsigned component = float32;
  bool is_normalized = false;
  std::size_t width = 1, count = 0;
  std::size_t size() const { return width * size_of(component); }
};

GltfFile::Layout GltfFile::layout(std::size_t accessor, std::size_t width) const {
  const Json& json = item("accessors", accessor);
  Layout layout{.where = fmt::format("accessor {}", accessor)};
  const std::string type = text(json, "type");
  const auto found = std::ranges::find(element_types, type, &ElementType::name);
  layout.width = found == std::end(element_types) ? 0 : found->width;
  if (layout.width != width)
    throw Error("{}: {} is of type '{}'; {} numbers an element are required", name_, layout.where, type, width);
  layout.component = static_cast<unsigned>(index(json, layout.where, "componentType").value_or(0));
  if (layout.component < int8 || layout.component > float32 || layout.component == 5124)
    throw Error("{}: {}: componentType = {} is none of 5120 .. 5123, 5125, 5126", name_, layout.where, layout.component);
  layout.is_normalized = flag_in(json, "normalized", false);
  layout.count = index(json, layout.where, "count").value_or(0);
  constexpr std::size_t most = std::size_t{1} << 32;
  if (layout.count >= most) throw Error("{}: {}: count = {} is 2^32 or more", name_, layout.where, layout.count);
  return layout;
}

std::string_view GltfFile::view(std::size_t view, std::size_t& stride) const {
  const std::string where = fmt::format("bufferView {}", view);
  const Json& json = item("bufferViews", view);
  const std::size_t buffer = index(json, where, "buffer").value_or(0);
  item("buffers", buffer);
  const std::string& bytes = buffers_[buffer];
  const std::size_t begin = index(json, where, "byteOffset").value_or(0), size = index(json, where, "byteLength").value_or(0);
  stride = index(json, where, "byteStride").value_or(0);
  const bool is_compressed = extension_of(json, "EXT_meshopt_compression") || extension_of(json, "KHR_meshopt_compression");
  if (bytes.empty() && size > 0)
    throw Error("{}: {}: buffer {} holds no bytes{}", name_, where, buffer,
                is_compressed ? "; EXT_meshopt_compression is not read" : "");
  if (begin > bytes.size() || size > bytes.size() - begin)
    throw Error("{}: {} of {} bytes from byte {} ends after its buffer of {} bytes", name_, where, size, begin, bytes.size());
  return std::string_view(bytes).substr(begin, size);
}

std::string_view GltfFile::bytes(std::size_t index) const {
  std::size_t stride = 0;
  return view(index, stride);
}

void GltfFile::fill(const Layout& layout, std::string_view bytes, std::size_t stride, std::size_t count, double* values) const {
  if (stride == 0) stride = layout.size();
  if (stride < layout.size())
    throw Error("{}: {}: a stride of {} bytes is less than an element of {}", name_, layout.where, stride, layout.size());
  if (count > 0 && (bytes.size() < layout.size() || (count - 1) > (bytes.size() - layout.size()) / stride))
    throw Error("{}: {} declares {} elements, more than its {} bytes hold", name_, layout.where, count, bytes.size());
  const double scale = layout.is_normalized && layout.component != float32 ? largest_of(layout.component) : 0;
  for (std::size_t e = 0; e < count; ++e)
    for (std::size_t k = 0; k < layout.width; ++k) {
      const double value = component_at(bytes.data() + e * stride + k * size_of(layout.component), layout.component);
      *values++ = scale > 0 ? std::max(value / scale, -1.0) : value;
    }
}

/// Replaces some elements.
void GltfFile::read_sparse(const Json& sparse, const Layout& layout, Numbers& numbers) const {
  const std::size_t count = index(sparse, layout.where, "count").value_or(0);
  if (count > numbers.count) throw Error("{}: {} replaces {} elements of {}", name_, layout.where, count, numbers.count);
  const auto bytes_of = [&](const char* key, std::size_t& stride) {
    const Json* part = object_in(sparse, key);
    if (!part) throw Error("{}: {}: its sparse part has no {}", name_, layout.where, key);
    const std::string_view bytes = view(index(*part, layout.where, "bufferView").value_or(0), stride);
    return bytes.substr(std::min(index(*part, layout.where, "byteOffset").value_or(0), bytes.size()));
  };
  Layout places{.where = layout.where + ", sparse indices", .count = count};
  places.component = static_cast<unsigned>(index(sparse.at("indices"), layout.where, "componentType").value_or(0));
  if (places.component != uint8 && places.component != uint16 && places.component != uint32)
    throw Error("{}: {}: componentType = {} is none of 5121, 5123, 5125", name_, places.where, places.component);
  std::size_t stride = 0;
  std::vector<double> at(count), values(count * layout.width);
  const std::string_view place_bytes = bytes_of("indices", stride);
  fill(places, place_bytes, stride, count, at.data());
  const std::string_view value_bytes = bytes_of("values", stride);
  fill(layout, value_bytes, stride, count, values.data());
  for (std::size_t i = 0; i < count; ++i) {
    if (at[i] >= static_cast<double>(numbers.count))
      throw Error("{}: {} names element {} of {}", name_, places.where, at[i], numbers.count);
    std::memcpy(&numbers.values[static_cast<std::size_t>(at[i]) * layout.width], &values[i * layout.width],
                layout.width * sizeof(double));
  }
}

Numbers GltfFile::read(std::size_t accessor, std::size_t width) const {
  const Layout wanted = layout(accessor, width);
  const Json& json = item("accessors", accessor);
  Numbers numbers{.count = wanted.count, .width = width, .values = {}};
  const auto source = index(json, wanted.where, "bufferView");
  std::size_t stride = 0;
  std::string_view bytes;
  if (source) {
    bytes = view(*source, stride);
    const std::size_t begin = index(json, wanted.where, "byteOffset").value_or(0);
    bytes = bytes.substr(std::min(begin, bytes.size()));
    if (wanted.count > bytes.size())  // before memory is allocated
      throw Error("{}: {} declares {} elements, more than its {} bytes hold", name_, wanted.where, wanted.count, bytes.size());
  }
  numbers.values.resize(wanted.count * width);  // 0 without bytes
  if (source) fill(wanted, bytes, stride, wanted.count, numbers.values.data());
  if (const Json* sparse = object_in(json, "sparse")) read_sparse(*sparse, wanted, numbers);
  return numbers;
}

Numbers GltfFile::read_indices(std::size_t accessor, std::size_t width, double& largest) const {
  const Layout wanted = layout(accessor, width);
  if (wanted.component != uint8 && wanted.component != uint16 && wanted.component != uint32)
    throw Error("{}: {}: componentType = {} is none of 5121, 5123, 5125", name_, wanted.where, wanted.component);
  largest = largest_of(wanted.component);
  return read(accessor, width);
}

}  // namespace gnomon::importing
