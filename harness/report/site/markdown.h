#pragma once
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace gnomon::site {

/// A page of Markdown as HTML.
struct RenderedPage {
  struct Section {
    std::string heading, id;  ///< of what is above the first heading empty
    int level = 0;            ///< of its heading, from 1; 0 where it has none
    std::string text;         ///< its words, without those of code blocks
  };
  std::string title;  ///< the first heading; empty where there is none
  std::string html;   ///< what is inside an element
  std::vector<Section> sections;
};

/// What a link or a picture leads to, for the address as written; an empty answer leads nowhere.
using LinkOf = std::function<std::string(const std::string& address)>;

/// GitHub's Markdown: tables, links that stand by themselves, text that is struck through. Headings have the names that links
/// to them use there. HTML in the text is left out, and so are addresses that run something. Tables and code blocks scroll by
/// themselves. `text` is UTF-8; other bytes are replaced.
RenderedPage render_markdown(std::string_view text, const LinkOf& link);

/// The part of a link that leads to a heading: small letters, digits, `_`, `-`, blanks as `-`.
std::string heading_id(std::string_view heading);

}  // namespace gnomon::site
