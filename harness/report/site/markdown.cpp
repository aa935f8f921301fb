#include "report/site/markdown.h"

#include <cmark-gfm-core-extensions.h>
#include <cmark-gfm.h>
#include <gnomon/error.h>

#include <cstdlib>
#include <map>
#include <memory>
#include <mutex>

#include "report/html/html_parts.h"

namespace gnomon::site {

namespace {

struct FreesNode {
  void operator()(cmark_node* node) const { cmark_node_free(node); }
};
using Document = std::unique_ptr<cmark_node, FreesNode>;

constexpr const char* extensions[] = {"table", "strikethrough", "autolink"};

Document parse(std::string_view text) {
  static std::once_flag is_ready;
  std::call_once(is_ready, cmark_gfm_core_extensions_ensure_registered);
  const std::unique_ptr<cmark_parser, decltype(&cmark_parser_free)> parser(
      cmark_parser_new(CMARK_OPT_DEFAULT | CMARK_OPT_VALIDATE_UTF8), cmark_parser_free);
  for (const char* const name : extensions) {
    cmark_syntax_extension* const extension = cmark_find_syntax_extension(name);
    if (!extension) throw Error("the Markdown library has no extension {}", name);
    cmark_parser_attach_syntax_extension(parser.get(), extension);
  }
  cmark_parser_feed(parser.get(), text.data(), text.size());
  return Document(cmark_parser_finish(parser.get()));
}

/// Calls `visit` for each node before its children; `visit` may take the node out.
template <class Visit>
void for_each_node(cmark_node* root, Visit&& visit) {
  const std::unique_ptr<cmark_iter, decltype(&cmark_iter_free)> nodes(cmark_iter_new(root), cmark_iter_free);
  for (cmark_event_type event; (event = cmark_iter_next(nodes.get())) != CMARK_EVENT_DONE;)
    if (event == CMARK_EVENT_ENTER) visit(cmark_iter_get_node(nodes.get()));
}

std::string text_or_empty(const char* text) { return text ? text : ""; }

/// The words of a node and of all within it.
std::string words_of(cmark_node* root) {
  std::string words;
  for_each_node(root, [&](cmark_node* node) {
    const cmark_node_type type = cmark_node_get_type(node);
    if (type == CMARK_NODE_TEXT || type == CMARK_NODE_CODE) words += text_or_empty(cmark_node_get_literal(node));
    if (type == CMARK_NODE_SOFTBREAK || type == CMARK_NODE_LINEBREAK) words += ' ';
  });
  return words;
}

/// HTML goes: notes in comments mean nothing to readers, and nothing else is trusted.
void remove_html(cmark_node* root) {
  std::vector<cmark_node*> gone;
  for_each_node(root, [&](cmark_node* node) {
    const cmark_node_type type = cmark_node_get_type(node);
    if (type == CMARK_NODE_HTML_BLOCK || type == CMARK_NODE_HTML_INLINE) gone.push_back(node);
  });
  for (cmark_node* const node : gone) {
    cmark_node_unlink(node);
    cmark_node_free(node);
  }
}

void replace_links(cmark_node* root, const LinkOf& link) {
  for_each_node(root, [&](cmark_node* node) {
    const cmark_node_type type = cmark_node_get_type(node);
    if (type == CMARK_NODE_LINK || type == CMARK_NODE_IMAGE)
      cmark_node_set_url(node, link(text_or_empty(cmark_node_get_url(node))).c_str());
  });
}

/// Splits the page at its headings and gives each heading its name.
void find_sections(cmark_node* root, RenderedPage& page) {
  std::map<std::string, int> counts;
  page.sections.emplace_back();
  for (cmark_node* block = cmark_node_first_child(root); block; block = cmark_node_next(block)) {
    if (cmark_node_get_type(block) == CMARK_NODE_HEADING) {
      const std::string heading = words_of(block), plain = heading_id(heading);
      const int count = counts[plain]++;
      const std::string id = count == 0 ? plain : fmt::format("{}-{}", plain, count);
      if (page.title.empty()) page.title = heading;
      page.sections.push_back({.heading = heading, .id = id, .level = cmark_node_get_heading_level(block), .text = {}});
      cmark_node* const mark = cmark_node_new(CMARK_NODE_CUSTOM_INLINE);
      cmark_node_set_on_enter(mark, fmt::format("<span class=\"anchor\" id=\"{}\"></span>", html_text(id)).c_str());
      cmark_node_prepend_child(block, mark);
    } else if (cmark_node_get_type(block) != CMARK_NODE_CODE_BLOCK) {
      for_each_node(block, [&](cmark_node* node) {
        const cmark_node_type type = cmark_node_get_type(node);
        std::string& text = page.sections.back().text;
        if (type == CMARK_NODE_TEXT || type == CMARK_NODE_CODE) text += text_or_empty(cmark_node_get_literal(node));
        // Words of different cells, lines and paragraphs are different words.
        if (type != CMARK_NODE_TEXT && type != CMARK_NODE_CODE && !text.empty() && text.back() != ' ') text += ' ';
      });
    }
  }
}

std::string replaced_all(std::string_view text, std::string_view what, std::string_view by) {
  std::string replaced;
  for (std::size_t at; (at = text.find(what)) != text.npos; text.remove_prefix(at + what.size()))
    replaced.append(text.substr(0, at)).append(by);
  return replaced.append(text);
}

/// What is wide scrolls, and cells of long tables are short: a cell ends where the next one or its row does. `<table>`, `<td>`
/// and `<pre>` come from the library alone: those of the text are written with `&lt;`.
std::string for_site(std::string html) {
  html = replaced_all(html, "<table>", "<div class=\"wide\" tabindex=\"0\"><table>");
  html = replaced_all(html, "</table>", "</table></div>");
  html = replaced_all(html, "<th></th>", "<td></td>");
  html = replaced_all(html, "<td align=\"right\">", "<td class=r>");
  html = replaced_all(html, "</td>\n", "");
  html = replaced_all(html, "<pre>", "<pre tabindex=\"0\">");
  return html;
}

}  // namespace

std::string heading_id(std::string_view heading) {
  std::string id;
  for (const char c : heading) {
    const auto byte = static_cast<unsigned char>(c);
    if (c >= 'A' && c <= 'Z')
      id += static_cast<char>(c - 'A' + 'a');
    else if ((c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_' || c == '-' || byte >= 0x80)
      id += c;
    else if (c == ' ')
      id += '-';
  }
  return id;
}

RenderedPage render_markdown(std::string_view text, const LinkOf& link) {
  const Document document = parse(text);
  RenderedPage page;
  remove_html(document.get());
  replace_links(document.get(), link);
  find_sections(document.get(), page);
  const std::unique_ptr<char, decltype(&std::free)> html(cmark_render_html(document.get(), CMARK_OPT_DEFAULT, nullptr),
                                                         std::free);
  page.html = for_site(html.get());
  return page;
}

}  // namespace gnomon::site
