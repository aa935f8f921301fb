#pragma once
#include <filesystem>

#include "report/site/page.h"

namespace gnomon::site {

/// The documentation of a source tree as pages: README.md, CONTRIBUTING.md, every page below docs but docs/source, and what
/// these lead to within the tree: further pages, pictures, and texts such as headers and tables as pages of their own. Each is
/// at its place in the tree, `docs/method.html`. What is no regular file of the tree, or too large, is noted. Throws Error
/// where the tree has no docs/README.md.
void add_documents(Folder& folder, const std::filesystem::path& tree);

/// Where a link of the tree leads in the site: "docs/method.md#part" is "docs/method.html#part", another text than a page
/// "docs/answer.cpp.html", and a picture stays what it is.
std::string document_place(const std::string& link);

/// What README.md says before its second heading, as HTML with links from the top of the site; empty where there is none.
std::string introduction(const std::filesystem::path& tree);

}  // namespace gnomon::site
