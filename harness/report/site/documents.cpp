#include "report/site/documents.h"

#include <gnomon/error.h>

#include <deque>
#include <set>

#include "measure/part_file.h"
#include "report/html/html_parts.h"
#include "report/site/markdown.h"
#include "report/site/source.h"

namespace gnomon::site {

namespace fs = std::filesystem;

namespace {

constexpr std::uintmax_t most_page_bytes = 4 << 20, most_text_bytes = 1 << 19, most_picture_bytes = 4 << 20;

bool ends_in(const fs::path& path, std::initializer_list<std::string_view> endings) {
  return std::ranges::find(endings, path.extension().string()) != endings.end();
}

bool is_elsewhere(std::string_view address) {
  const std::size_t colon = address.find(':');
  return colon != address.npos && address.substr(0, colon).find_first_of("/#?") == address.npos;
}

class Documents {
 public:
  Documents(Folder& folder, fs::path tree) : folder_(folder), tree_(std::move(tree)) {}

  void add_all() {
    for (const char* const name : {"README.md", "CONTRIBUTING.md", "docs/README.md"})
      if (fs::exists(tree_ / name)) want(name);
    std::set<fs::path> pages;
    for (const auto& entry : fs::recursive_directory_iterator(tree_ / "docs"))
      if (entry.path().extension() == ".md") pages.insert(entry.path().lexically_relative(tree_));
    for (const fs::path& page : pages)
      if (page.parent_path() != "docs/source") want(page);
    for (; !wanted_.empty(); wanted_.pop_front()) add(wanted_.front());
  }

 private:
  void want(const fs::path& file) {
    if (known_.insert(file).second) wanted_.push_back(file);
  }

  /// The file of the tree that an address in a page leads to; empty where there is none.
  fs::path target(const fs::path& page, const std::string& path) const {
    fs::path file = (page.parent_path() / path).lexically_normal();
    if (file.empty() || file.is_absolute() || *file.begin() == "..") return {};
    if (fs::is_directory(tree_ / file)) file = (file / "README.md").lexically_normal();
    return is_plain_file(tree_ / file) ? file : fs::path();
  }

  std::string link(const fs::path& page, const std::string& address) {
    if (address.empty() || address.starts_with('#') || is_elsewhere(address)) return address;
    const std::size_t part = address.find('#');
    const fs::path file = target(page, address.substr(0, part));
    if (file.empty()) {
      if (!address.ends_with('/'))
        folder_.notes.push_back(fmt::format("{} links to {}, which is no file of the tree", page.string(), address));
      return "";
    }
    want(file);
    return root_of(page.generic_string()) + address_text(document_place(file.generic_string())) +
           (part == address.npos ? "" : address.substr(part));
  }

  void add(const fs::path& file) {
    try {
      if (ends_in(file, {".md"}))
        add_page(file);
      else if (ends_in(file, {".png", ".svg", ".jpg"}))
        folder_.write(file.generic_string(), small_file(tree_ / file, most_picture_bytes));
      else
        add_text(file);
    } catch (const Error& error) {
      folder_.notes.push_back(fmt::format("documentation: {}", error.what()));
    }
  }

  void add_page(const fs::path& file) {
    const RenderedPage page = render_markdown(small_file(tree_ / file, most_page_bytes),
                                              [&](const std::string& address) { return link(file, address); });
    const std::string path = document_place(file.generic_string()), title = page.title.empty() ? file.string() : page.title;
    // Tables of results are found as rows.
    const bool is_table = *file.begin() == "results";
    std::string parts;
    for (const RenderedPage::Section& section : page.sections) {
      if (section.level == 2)
        parts += fmt::format("<a href=\"#{}\">{}</a>\n", html_text(section.id), html_text(section.heading));
      const bool is_top = section.level <= 1;
      if ((section.level == 0 && section.text.empty()) || (is_table && !is_top)) continue;
      folder_.index(is_top ? path : path + "#" + section.id, is_top ? title : fmt::format("{}: {}", title, section.heading),
                    "documentation", is_table ? "" : section.text);
    }
    if (!parts.empty())
      parts = fmt::format("<details class=\"contents\"><summary>On this page</summary>\n{}</details>\n", parts);
    folder_.add({.path = path,
                 .title = title,
                 .kicker = file.generic_string(),
                 .body = fmt::format("<article class=\"document\">\n{}{}</article>", parts, without_title(page.html))});
  }

  /// The title is above the page already.
  static std::string without_title(const std::string& html) {
    const std::size_t begin = html.find("<h1>"), end = html.find("</h1>");
    if (begin != 0 || end == html.npos) return html;
    const std::size_t mark = html.find("<span class=\"anchor\""), mark_end = html.find("</span>", mark);
    return html.substr(mark, mark_end + 7 - mark) + html.substr(end + 5);
  }

  void add_text(const fs::path& file) {
    const std::string text = small_file(tree_ / file, most_text_bytes), path = document_place(file.generic_string());
    folder_.add({.path = path,
                 .title = file.filename().string(),
                 .kicker = file.generic_string(),
                 .body = fmt::format("<pre tabindex=\"0\" class=\"file\">{}</pre>", html_text(text))});
    folder_.index(path, file.generic_string(), "file");
  }

  Folder& folder_;
  const fs::path tree_;
  std::set<fs::path> known_;
  std::deque<fs::path> wanted_;
};

}  // namespace

std::string document_place(const std::string& link) {
  const std::size_t part = link.find('#');
  const fs::path file = link.substr(0, part);
  std::string place = file.generic_string();
  if (ends_in(file, {".md"}))
    place = fs::path(file).replace_extension(".html").generic_string();
  else if (!place.empty() && !ends_in(file, {".png", ".svg", ".jpg"}))
    place += ".html";
  return part == link.npos ? place : place + link.substr(part);
}

void add_documents(Folder& folder, const fs::path& tree) {
  if (!fs::exists(tree / "docs/README.md")) throw Error("{} has no documentation: there is no docs/README.md", tree.string());
  Documents(folder, tree).add_all();
}

std::string introduction(const fs::path& tree) {
  if (!is_plain_file(tree / "README.md")) return "";
  std::string text = small_file(tree / "README.md", most_page_bytes);
  text = text.substr(0, text.find("\n## "));
  const auto link = [&](const std::string& address) {
    return is_elsewhere(address) ? address
                                 : address_text(document_place(fs::path(address).lexically_normal().generic_string()));
  };
  const std::string html = render_markdown(text, link).html;
  const std::size_t end = html.find("</h1>");
  return end == html.npos ? html : html.substr(end + 5);
}

}  // namespace gnomon::site
