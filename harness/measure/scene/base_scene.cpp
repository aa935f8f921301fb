// What descriptions name: their own files, files of fetched scenes, and the scene that they start from.
#include "measure/scene/base_scene.h"

#include <toml++/toml.h>

#include <algorithm>

#include "measure/paths.h"
#include "measure/scene/load.h"

namespace gnomon {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t most_descriptions = 64;

/// An error that says already which description named the scene.
class BaseError : public Error {
  using Error::Error;
};

/// The reference as the program takes it, free of the folder that its description lies in.
std::string seen_from_here(const std::string& reference, const fs::path& description) {
  return names_file(reference) ? described_file(reference, description).string() : reference;
}

void check_fetched(const std::string& reference, std::size_t depth);

/// Throws SceneNotFetched. What is wrong in any other way, loading will say.
void check_fetched_toml(const fs::path& file, std::size_t depth) {
  toml::table document;
  try {
    document = toml::parse_file(file.string());
  } catch (const toml::parse_error&) {
    return;
  }
  if (const toml::array* meshes = document["mesh"].as_array())
    for (const toml::node& mesh : *meshes)
      if (const toml::table* table = mesh.as_table())
        if (const auto name = (*table)["file"].value_exact<std::string>()) described_file(*name, file);
  if (const auto base = document["scene"].value_exact<std::string>()) check_fetched(seen_from_here(*base, file), depth + 1);
}

void check_fetched(const std::string& reference, std::size_t depth) {
  if (depth > most_descriptions) return;
  const fs::path file = names_file(reference) ? fs::path(reference) : data_root() / "scenes" / (reference + ".toml");
  if (file.extension() == ".toml") check_fetched_toml(file, depth);
}

}  // namespace

bool names_file(const std::string& reference) {
  return fs::path(reference).extension() == ".toml" || reference.find('/') != std::string::npos || is_mesh_file_name(reference);
}

fs::path described_file(const std::string& name, const fs::path& description) {
  constexpr std::string_view prefix = "cache:";
  if (!name.starts_with(prefix)) return description.parent_path() / name;
  const fs::path inside = name.substr(prefix.size());
  const fs::path file = cache_root() / "scenes" / inside;
  const std::string id = inside.empty() ? "" : inside.begin()->string();
  if (!fs::exists(file)) throw SceneNotFetched("scene {0} is not fetched: run scripts/fetch_scenes {0}", id);
  return file;
}

void check_above(const fs::path& description, const Descriptions& above) {
  std::error_code ignored;
  const auto same =
      std::ranges::find_if(above, [&](const fs::path& other) { return fs::equivalent(other, description, ignored); });
  if (same != above.end()) {
    std::string chain;
    for (auto file = same; file != above.end(); ++file) chain += file->string() + " names ";
    throw Error("scene comes back to itself: {}{}", chain, description.string());
  }
  if (above.size() >= most_descriptions)
    throw Error("{}: more than {} descriptions, each of which names the next as its scene", description.string(),
                most_descriptions);
}

Scene read_base(const std::string& reference, const fs::path& description, const std::string& where,
                const Descriptions& above) {
  Descriptions chain = above;
  chain.push_back(description);
  try {
    return read_scene(seen_from_here(reference, description), chain);
  } catch (const SceneNotFetched&) {
    throw;
  } catch (const BaseError&) {
    throw;
  } catch (const Error& error) {
    throw BaseError("{} (named in {})", error.what(), where);
  }
}

bool is_fetched(const std::string& reference) {
  try {
    check_fetched(reference, 0);
    return true;
  } catch (const SceneNotFetched&) {
    return false;
  }
}

}  // namespace gnomon
