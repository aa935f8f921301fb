#pragma once
// Values as bytes, one after the other. One function names the fields of a struct in their order, for a writer and for a
// reader, so that the two cannot disagree: `io(mesh.name, mesh.positions, mesh.casts)`.
#include <gnomon/error.h>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

namespace gnomon {

/// Appends values to `bytes`: numbers and plain structs as they are in memory, texts and vectors of such after their count
/// (64 bits), variants after their index (32 bits), optional values after whether they are there (bool).
class FieldWriter {
 public:
  std::vector<std::byte> bytes;

  void operator()(const auto&... values) { (put(values), ...); }
  /// Items that are no plain structs: their count, then each as `visit(io, item)` writes it.
  void list(const auto& items, const auto& visit) {
    put(static_cast<std::uint64_t>(items.size()));
    for (const auto& item : items) visit(*this, item);
  }
  /// Plain structs whose count is stored in another place.
  void items(const auto& items) { append(items.data(), items.size() * sizeof(*items.data())); }
  /// Whether a list that older bytes lack follows.
  bool has_more(const auto& items) const { return !items.empty(); }

 private:
  template <class T>
  void put(const T& value) {
    if constexpr (requires { value.valueless_by_exception(); }) {
      put(static_cast<std::uint32_t>(value.index()));
      std::visit([&](const auto& alternative) { put(alternative); }, value);
    } else if constexpr (requires { value.has_value(); }) {
      put(value.has_value());
      if (value) put(*value);
    } else if constexpr (requires { value.data(); }) {
      put(static_cast<std::uint64_t>(value.size()));
      items(value);
    } else {
      static_assert(std::is_trivially_copyable_v<T>);
      append(&value, sizeof(T));
    }
  }
  void append(const void* data, std::size_t size) {
    const auto* begin = static_cast<const std::byte*>(data);
    bytes.insert(bytes.end(), begin, begin + size);
  }
};

/// The inverse, of bytes that may be damaged: a count that the rest cannot hold is refused. Throws Error with the words
/// `too_short` where bytes are missing.
class FieldReader {
 public:
  FieldReader(std::span<const std::byte> bytes, std::string too_short) : bytes_(bytes), too_short_(std::move(too_short)) {}

  void operator()(auto&... values) { (take(values), ...); }
  void list(auto& items, const auto& visit) {
    std::uint64_t count = 0;
    take(count);
    need(count, 1);
    items.clear();
    for (std::uint64_t k = 0; k < count; ++k) visit(*this, items.emplace_back());  // memory for those alone that are there
  }
  void items(auto& items, std::uint64_t count) {
    need(count, sizeof(*items.data()));
    items.resize(count);
    copy(items.data(), count * sizeof(*items.data()));
  }
  bool has_more(const auto&) const { return !bytes_.empty(); }
  std::size_t left() const { return bytes_.size(); }

 private:
  template <class T>
  void take(T& value) {
    if constexpr (requires { value.valueless_by_exception(); }) {
      std::uint32_t index = 0;
      take(index);
      take_alternative(value, index, std::make_index_sequence<std::variant_size_v<T>>{});
    } else if constexpr (requires { value.has_value(); }) {
      bool is_there = false;
      take(is_there);
      if (is_there) take(value.emplace());
    } else if constexpr (std::is_same_v<T, bool>) {
      std::uint8_t byte = 0;
      take(byte);
      if (byte > 1) throw Error("a flag is {}, neither 0 nor 1", byte);
      value = byte == 1;
    } else if constexpr (requires { value.data(); }) {
      std::uint64_t count = 0;
      take(count);
      items(value, count);
    } else {
      static_assert(std::is_trivially_copyable_v<T>);
      copy(&value, sizeof(T));
    }
  }
  template <class Variant, std::size_t... I>
  void take_alternative(Variant& value, std::uint32_t index, std::index_sequence<I...>) {
    const bool is_known = ((index == I && (take(value.template emplace<I>()), true)) || ...);
    if (!is_known) throw Error("scene bytes hold an unknown kind {}", index);
  }
  void need(std::uint64_t count, std::size_t item_size) const {
    if (count > bytes_.size() / item_size) throw Error("{}", too_short_);
  }
  void copy(void* target, std::size_t size) {
    need(size, 1);
    if (size > 0) std::memcpy(target, bytes_.data(), size);
    bytes_ = bytes_.subspan(size);
  }

  std::span<const std::byte> bytes_;
  std::string too_short_;
};

}  // namespace gnomon
