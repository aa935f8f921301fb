#include "measure/part_file.h"

#include <gnomon/error.h>
#include <signal.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <functional>
#include <optional>

namespace gnomon {

namespace fs = std::filesystem;

namespace {

constexpr const char* ending = ".part";

/// The rest of the name after the prefix and the number of a process that is gone; nothing where the name has another form.
std::optional<std::string> after_gone_process(const fs::path& file, const std::string& prefix) {
  const std::string name = file.filename().string();
  if (!name.starts_with(prefix)) return std::nullopt;
  int process = 0;
  const auto [stop, code] = std::from_chars(name.data() + prefix.size(), name.data() + name.size(), process);
  const bool is_gone = code == std::errc{} && process > 0 && kill(process, 0) != 0 && errno == ESRCH;
  return is_gone ? std::optional(std::string(stop)) : std::nullopt;
}

/// Removes the paths in the folder for which `is_dead` is true. What cannot be removed stays.
void remove_where(const fs::path& folder, const std::function<bool(const fs::path&)>& is_dead) {
  std::error_code code;
  for (fs::directory_iterator entry(folder, code); !code && entry != fs::directory_iterator(); entry.increment(code))
    if (std::error_code ignored; is_dead(entry->path())) fs::remove_all(entry->path(), ignored);
}

}  // namespace

fs::path part_of(const fs::path& path) {
  const fs::path target = path.has_filename() ? path : path.parent_path();  // OUT/ is OUT
  // Names have at most 255 bytes.
  const std::string prefix = fmt::format(".{:.200}.", target.filename().string());
  remove_where(target.has_parent_path() ? target.parent_path() : fs::path("."),
               [&](const fs::path& file) { return after_gone_process(file, prefix) == ending; });
  return target.parent_path() / fmt::format("{}{}{}", prefix, getpid(), ending);
}

fs::path replaced_file(const fs::path& path) {
  std::error_code code;
  const fs::path target = fs::is_symlink(path, code) ? fs::weakly_canonical(path, code) : path;
  const fs::file_status status = fs::status(target, code);
  if (fs::exists(status) && !fs::is_regular_file(status))
    throw Error("{} cannot be written: it is there and no regular file", path.string());
  return target;
}

bool is_plain_file(const fs::path& path) {
  std::error_code code;
  return fs::is_regular_file(fs::symlink_status(path, code));
}

void make_way(const fs::path& path) {
  std::error_code code;
  const fs::file_status status = fs::symlink_status(path, code);
  if (fs::is_symlink(status))
    fs::remove(path, code);
  else if (fs::exists(status) && !fs::is_regular_file(status))
    throw Error("{} cannot be written: it is there and no regular file", path.string());
}

void remove_left_over_parts(const fs::path& folder) {
  remove_where(folder, [](const fs::path& file) {
    const std::string name = file.stem().string();
    const std::size_t dot = name.rfind('.');
    return name.starts_with(".") && dot != 0 && after_gone_process(file, name.substr(0, dot + 1)) == ending;
  });
}

void remove_left_over_folders(const fs::path& parent, const std::string& prefix) {
  remove_where(parent, [&](const fs::path& folder) {
    const auto rest = after_gone_process(folder, prefix + "-");
    return rest && (rest->empty() || rest->starts_with("."));
  });
}

}  // namespace gnomon
