#include "report/html/html_page.h"

namespace gnomon {

/// Built with GNOMON_REPORT=OFF.
std::string_view page_template() { return {}; }

}  // namespace gnomon
