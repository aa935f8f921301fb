#include "report/site/page.h"

#include <gnomon/error.h>

#include <algorithm>

#include "measure/json.h"
#include "measure/scene/blob.h"
#include "report/html/html_parts.h"

namespace gnomon::site {

namespace {

/// Whether a byte may be in an address as it is.
bool is_plain(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
         std::string_view("-_.~/").find(c) != std::string_view::npos;
}

std::string escaped(std::string_view text) {
  std::string address;
  for (const char c : text) address += is_plain(c) ? std::string(1, c) : fmt::format("%{:02X}", static_cast<unsigned char>(c));
  return address;
}

constexpr std::pair<const char*, const char*> places[] = {{"index.html", "Results"},
                                                          {"techniques/index.html", "Techniques"},
                                                          {"scenes/index.html", "Scenes"},
                                                          {"machines/index.html", "Machines"},
                                                          {"docs/README.html", "Documentation"}};

std::string navigation(std::string_view from) {
  std::string html = "<nav aria-label=\"Site\">\n";
  for (const auto& [path, name] : places)
    html += fmt::format("<a href=\"{}{}\"{}>{}</a>\n", root_of(from), path, path == from ? " aria-current=\"page\"" : "", name);
  return html + fmt::format(
                    "<form class=\"find\" action=\"{}search.html\" role=\"search\" aria-label=\"Whole site\">"
                    "<input type=\"search\" name=\"q\" placeholder=\"Search\" aria-label=\"Search the site\"></form>\n</nav>\n",
                    root_of(from));
}

/// Only scripts and pictures of the site's own files, and no text that is a script.
constexpr std::string_view policy =
    "default-src 'none'; script-src 'self'; style-src 'self' 'unsafe-inline'; img-src 'self' data: blob:; base-uri 'none'; "
    "form-action 'self'";

constexpr std::string_view icon =
    "data:image/svg+xml,%3Csvg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 32 32'%3E%3Ccircle cx='16' cy='16' r='15' "
    "fill='%23f4b740'/%3E%3Cpath d='M16 25V6l9 19z' fill='%231c2430'/%3E%3C/svg%3E";

}  // namespace

std::string root_of(std::string_view path) {
  std::string root;
  for (const char c : path)
    if (c == '/') root += "../";
  return root;
}

std::string address_text(std::string_view path) {
  const std::size_t part = path.find('#');
  if (part == path.npos) return escaped(path);
  const std::string_view state = path.substr(part);  // written by state_text, or the name of a heading
  return escaped(path.substr(0, part)) + (state.starts_with("#?") ? std::string(state) : "#" + escaped(state.substr(1)));
}

std::string link_html(std::string_view from, std::string_view to, std::string_view text) {
  return fmt::format("<a href=\"{}{}\">{}</a>", root_of(from), html_text(address_text(to)), html_text(text));
}

std::string state_text(const std::vector<std::pair<std::string, std::string>>& state) {
  std::string text;
  for (const auto& [name, value] : state)
    if (!value.empty()) text += fmt::format("{}{}={}", text.empty() ? "#?" : "&", name, escaped(value));
  return text;
}

void Folder::write(const std::string& path, std::string_view bytes) {
  write_file(stage_ / path, std::span(reinterpret_cast<const std::byte*>(bytes.data()), bytes.size()));
  bytes_ += bytes.size();
}

void Folder::add(const Page& page) {
  const std::string root = root_of(page.path);
  std::string html = fmt::format(
      "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"{}\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<meta name=\"color-scheme\" content=\"light dark\">\n<title>{} - Gnomon</title>\n<link rel=\"icon\" href=\"{}\">\n"
      "<link rel=\"stylesheet\" href=\"{}assets/site.css\">\n"
      "<link rel=\"alternate\" type=\"application/atom+xml\" title=\"Changes\" href=\"{}feed.xml\">\n",
      policy, html_text(page.title), icon, root, root);
  for (const std::string& script : page.scripts)
    html += fmt::format("<script src=\"{}assets/{}\" defer></script>\n", root, script);
  html += fmt::format("<script src=\"{}assets/site.js\" defer></script>\n</head>\n<body data-root=\"{}\">\n", root, root);
  html += "<a class=\"skip\" href=\"#main\">Skip to the content</a>\n" + navigation(page.path);
  html += "<header>\n";
  if (!page.kicker.empty()) html += fmt::format("<p class=\"kicker\">{}</p>\n", html_text(page.kicker));
  html += fmt::format("<h1>{}</h1>\n{}\n</header>\n", html_text(page.title), page.lead);
  if (!page.parts.empty()) html += fmt::format("<nav class=\"parts\" aria-label=\"Parts of the page\">{}</nav>\n", page.parts);
  html += fmt::format("<main id=\"main\">\n{}\n</main>\n", page.body);
  if (!page.data.empty()) html += fmt::format("<script type=\"application/json\" id=\"data\">{}</script>\n", page.data);
  write(page.path, html + "</body>\n</html>\n");
  ++pages_;
}

void Folder::index(const std::string& path, const std::string& heading, const std::string& kind, const std::string& words) {
  found_.push_back(script_text(Json::array({address_text(path), heading, kind, words})));
}

void Folder::write_index() { write("assets/search.js", fmt::format("gnomonFound([\n{}\n]);\n", joined(found_, ",\n"))); }

}  // namespace gnomon::site
