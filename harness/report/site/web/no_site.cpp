#include "report/site/page.h"

namespace gnomon::site {

/// Built with GNOMON_REPORT=OFF.
Assets assets() { return {}; }

}  // namespace gnomon::site
