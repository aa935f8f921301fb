#pragma once
#include <gnomon/registry.h>

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "app/viewer/key_effects.h"

namespace gnomon::viewer {

/// One key is one row: it drives dispatch, the help, `--keys` and the page.
struct KeyRow {
  int key;           ///< GLFW_KEY_...
  int modifiers;     ///< GLFW_MOD_...
  std::string name;  ///< "K", "Ctrl+S", "Page Up"
  KeyEffect effect;
  std::string group;     ///< heading in the help
  std::string sentence;  ///< "Shadowed object: circle."
  bool is_held = false;  ///< goes on while the key is held
};

/// All keys: first those that scenes declare, then the viewer's own.
class KeyTable {
 public:
  /// Throws Error, which names the scene and the letter, when a scene declares a key that is no letter A to Z, that the viewer
  /// uses itself or that the scene declares twice, or a parameter or value that the scene does not have.
  explicit KeyTable(std::span<const SceneEntry> scenes);

  /// In the order of the help; rows of one group, and those of one effect, stand together.
  std::span<const KeyRow> rows() const { return rows_; }
  /// The row of a key with exactly these modifiers. Caps Lock and Num Lock do not count, and for keys that go on while they are
  /// held Shift does not: that hand may be about to drag. Of scenes that declare the same letter, `scene` comes first. Null
  /// when the key means nothing.
  const KeyRow* find(int key, int modifiers, std::string_view scene = "") const;
  /// "k v v Ctrl+S page up": names apart by blanks, whatever their case, with or without the blank inside. Throws Error with
  /// the nearest name.
  std::vector<const KeyRow*> parse(const std::string& text) const;
  /// For docs/viewer.md, Markdown.
  std::string markdown() const;

 private:
  const KeyRow* find_name(std::string_view name) const;

  std::vector<KeyRow> rows_;
};
/// That of the registry; made at the first call, which plugins are loaded before. Throws as the constructor does.
const KeyTable& key_table();

}  // namespace gnomon::viewer
