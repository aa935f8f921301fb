// DIR/records.jsonl: reading what is there, appending so that what was written stays whole.
#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <unordered_map>

#include "measure/foreign_text.h"
#include "measure/notice.h"
#include "measure/part_file.h"
#include "measure/record/record.h"
#include "measure/scene/blob.h"

namespace gnomon {

namespace fs = std::filesystem;

namespace {

/// A row of 1000 times in each of 1000 processes has a million numbers for each stage and clock.
constexpr std::size_t most_line_bytes = std::size_t{512} << 20;

/// The end of the file after its last newline. Empty for an empty file, one that is no regular file, and one that cannot be
/// read: the write that follows reports what is wrong with the disk. Throws Error where the last line is too long.
std::string unfinished_tail(int descriptor, off_t size) {
  std::vector<char> block(1 << 20);
  off_t begin = size;
  while (begin > 0) {
    const off_t start = std::max<off_t>(0, begin - static_cast<off_t>(block.size()));
    if (size - start > static_cast<off_t>(most_line_bytes))
      throw Error("its last line is longer than {} bytes", most_line_bytes);
    if (pread(descriptor, block.data(), static_cast<std::size_t>(begin - start), start) != begin - start) return {};
    const std::size_t newline = std::string_view(block.data(), static_cast<std::size_t>(begin - start)).rfind('\n');
    begin = newline == std::string_view::npos ? start : start + static_cast<off_t>(newline) + 1;
    if (newline != std::string_view::npos) break;
  }
  std::string tail(static_cast<std::size_t>(size - begin), '\0');
  return pread(descriptor, tail.data(), tail.size(), begin) == size - begin ? tail : std::string();
}

off_t size_of(int descriptor) {
  struct stat facts {};
  return fstat(descriptor, &facts) == 0 && S_ISREG(facts.st_mode) ? facts.st_size : 0;
}

std::ifstream opened(const fs::path& file) {
  if (fs::exists(file) && !fs::is_regular_file(file)) throw Error("{} cannot be read: it is not a file", file.string());
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw Error("{} cannot be read: {}", file.string(), std::strerror(errno));
  return stream;
}

/// Calls use(record, start of its line) for each record of the file. Returns notes on what was left out.
std::vector<std::string> for_each_record(const fs::path& file, const std::function<void(Record&&, std::streamoff)>& use) {
  std::ifstream stream = opened(file);
  std::vector<std::string> notes;
  std::string line;
  std::streamoff start = 0;
  for (int number = 1;; ++number) {
    try {
      if (!next_foreign_line(stream, line, most_line_bytes)) break;
      if (stream.eof() && parse_if_json(line).is_discarded()) {
        notes.push_back(fmt::format("{}:{}: the last line is unfinished, the run was stopped while writing it; left out",
                                    file.string(), number));
        break;
      }
      use(record_of(parse_json(line)), start);
    } catch (const Json::exception& problem) {
      throw Error("{}:{}: not a record: {}", file.string(), number, complaint(problem));
    } catch (const Error& problem) {
      throw Error("{}:{}: {}", file.string(), number, problem.what());
    }
    start += static_cast<std::streamoff>(line.size()) + 1;
  }
  if (stream.bad()) throw Error("{} cannot be read to its end: {}", file.string(), std::strerror(errno));
  return notes;
}

fs::path records_file_of_run(const fs::path& dir) {
  fs::path file = records_file(dir);
  if (!fs::exists(file)) throw Error("{} is not the folder of a run: it has no {}", dir.string(), file.filename().string());
  return file;
}

void print_notes(const std::vector<std::string>& notes) {
  for (const std::string& note : notes) print_notice("{}\n", note);
}

/// Items in the order of the file; of a job that was run again its last one, in the place of the first.
template <class Item>
class LastOfJobs {
 public:
  std::vector<Item> items;

  void add(const std::string& job, Item&& item) {
    const auto [place, is_new] = place_of_job_.try_emplace(job, items.size());
    if (is_new || job.empty())
      items.push_back(std::move(item));
    else
      items[place->second] = std::move(item);
  }

 private:
  std::unordered_map<std::string, std::size_t> place_of_job_;
};

/// Sorts by suites in order of first appearance, within one by place; place_of returns both.
template <class Item, class PlaceOf>
void sort_by_suite(std::vector<Item>& items, const PlaceOf& place_of) {
  std::map<std::string, std::size_t, std::less<>> suites;  // in order of first appearance
  for (const Item& item : items) suites.try_emplace(std::string(place_of(item).first), suites.size());
  const auto key = [&](const Item& item) {
    const auto [suite, place] = place_of(item);
    return std::pair(suites.find(suite)->second, place);
  };
  std::ranges::stable_sort(items, std::less(), key);
}

}  // namespace

fs::path records_file(const fs::path& dir) { return dir / "records.jsonl"; }

RecordFile read_record_file(const fs::path& file) {
  LastOfJobs<Record> records;
  std::vector<std::string> notes =
      for_each_record(file, [&](Record&& record, std::streamoff) { records.add(record.job, std::move(record)); });
  return {std::move(records.items), std::move(notes)};
}

RecordLines::RecordLines(const fs::path& dir, const std::function<void(const Record&)>& seen)
    : file_(records_file_of_run(dir)) {
  struct Line {
    std::size_t number;
    std::string suite;
    std::uint64_t place;
  };
  LastOfJobs<Line> lines;
  const std::vector<std::string> notes = for_each_record(file_, [&](Record&& record, std::streamoff start) {
    lines.add(record.job, {starts_.size(), record.suite, record.place});
    starts_.push_back(start);
    if (seen) seen(record);
  });
  print_notes(notes);
  sort_by_suite(lines.items, [](const Line& line) { return std::pair(std::string_view(line.suite), line.place); });
  for (const Line& line : lines.items) order_.push_back(line.number);
  stream_ = opened(file_);
}

Record RecordLines::read(std::size_t line) {
  std::string text;
  stream_.clear();
  stream_.seekg(starts_.at(line));
  if (!next_foreign_line(stream_, text, most_line_bytes)) throw Error("{} was shortened while it was read", file_.string());
  return record_of(parse_json(text));
}

void sort_by_place(std::vector<Record>& records) {
  sort_by_suite(records, [](const Record& record) { return std::pair(std::string_view(record.suite), record.place); });
}

std::vector<Record> read_records(const fs::path& dir) {
  RecordFile contents = read_record_file(records_file_of_run(dir));
  print_notes(contents.notes);
  sort_by_place(contents.records);
  return std::move(contents.records);
}

RecordWriter::RecordWriter(const fs::path& dir) : file_(records_file(dir)) {
  std::error_code code;
  if (const fs::file_status status = fs::symlink_status(file_, code); fs::exists(status) && !fs::is_regular_file(status))
    throw Error("{} cannot be written: it is there and no regular file{}", file_.string(),
                fs::is_symlink(status) ? ": links in the folder of a run are not followed" : "");
  descriptor_ = open(file_.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC | O_NOFOLLOW, 0666);
  if (descriptor_ < 0) throw Error("{} cannot be opened for writing: {}", file_.string(), std::strerror(errno));
  const auto refuse = [this](const std::string& why) {
    ::close(std::exchange(descriptor_, -1));
    throw Error("{} {}", file_.string(), why);
  };
  if (flock(descriptor_, LOCK_EX | LOCK_NB) != 0) refuse("is being written by another run");
  // Rescoring renames a new file into its place; a writer that opened the old one just before would add to a file without a
  // name.
  struct stat held {};
  struct stat there {};
  const bool is_there = fstat(descriptor_, &held) == 0 && stat(file_.c_str(), &there) == 0;
  if (!is_there || held.st_ino != there.st_ino || held.st_dev != there.st_dev) refuse("was just replaced; try again");

  remove_left_over_parts(dir);
  // A tail that is a whole record only lacks its newline; any other tail was cut off and its job runs again.
  const off_t size = size_of(descriptor_);
  std::string tail;
  try {
    tail = unfinished_tail(descriptor_, size);
  } catch (const Error& error) {
    refuse(fmt::format("cannot be gone on with: {}", error.what()));
  }
  if (tail.empty()) return;
  const bool is_mended = parse_if_json(tail).is_discarded()
                             ? ftruncate(descriptor_, size - static_cast<off_t>(tail.size())) == 0
                             : write(descriptor_, "\n", 1) == 1;
  if (!is_mended) refuse(fmt::format("ends in an unfinished line that cannot be mended: {}", std::strerror(errno)));
}

RecordWriter::~RecordWriter() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

void RecordWriter::append(const Record& record) {
  const std::string line = record_line(record);
  const off_t end = size_of(descriptor_);
  const ssize_t written = write(descriptor_, line.data(), line.size());
  if (written == static_cast<ssize_t>(line.size()) && fsync(descriptor_) == 0) return;

  // A short write means a full disk or a limit; nothing is gained by trying the rest.
  const std::string why = written >= 0 && written < static_cast<ssize_t>(line.size())
                              ? fmt::format("only {} of {} bytes fit", written, line.size())
                              : std::strerror(errno);
  const bool is_whole = written <= 0 || ftruncate(descriptor_, end) == 0;
  throw Error("the record of {} {} could not be written: {}; in {}{}", record.technique, record.job, why, file_.string(),
              is_whole ? "" : ", which now ends in an unfinished line");
}

void RecordWriter::replace(std::span<const Record> records) {
  std::string lines;
  for (const Record& record : records) lines += record_line(record);
  // The new file is locked before anybody can open it by its name, and the old one is let go last: no other writer gets
  // between.
  const fs::path fresh = part_of(file_);
  write_file(fresh, lines, Durable::yes);
  const int descriptor = open(fresh.c_str(), O_RDWR | O_APPEND | O_CLOEXEC);
  if (descriptor < 0 || flock(descriptor, LOCK_EX | LOCK_NB) != 0 || std::rename(fresh.c_str(), file_.c_str()) != 0) {
    const int why = errno;
    if (descriptor >= 0) ::close(descriptor);
    unlink(fresh.c_str());
    throw Error("{} cannot be replaced: {}", file_.string(), std::strerror(why));
  }
  sync_folder_of(file_);
  ::close(std::exchange(descriptor_, descriptor));
}

void RecordWriter::close() {
  if (descriptor_ < 0) return;
  if (::close(std::exchange(descriptor_, -1)) != 0)
    throw Error("the last records may be missing: closing {} failed: {}", file_.string(), std::strerror(errno));
}

}  // namespace gnomon
