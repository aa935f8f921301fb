#include "device/stopwatch.h"

#include <epoxy/gl.h>

namespace gnomon {

GlStopwatch::GlStopwatch() {
  GLint bits = 0;
  glGetQueryiv(GL_TIMESTAMP, GL_QUERY_COUNTER_BITS, &bits);
  if (bits > 0) glGenQueries(2, queries_.data());
}

GlStopwatch::~GlStopwatch() {
  if (queries_[0]) glDeleteQueries(2, queries_.data());
}

void GlStopwatch::mark(int which) {
  if (queries_[0]) glQueryCounter(queries_[which], GL_TIMESTAMP);
}

std::optional<double> GlStopwatch::milliseconds() const {
  if (!queries_[0]) return std::nullopt;
  GLuint64 times[2] = {};
  for (int k = 0; k < 2; ++k) glGetQueryObjectui64v(queries_[k], GL_QUERY_RESULT, &times[k]);
  return static_cast<double>(static_cast<GLint64>(times[1] - times[0])) / 1e6;
}

}  // namespace gnomon
