#include "measure/worker/protocol.h"

#include "measure/printable.h"

namespace gnomon {

SupportReply reply_of(const Support& support) { return {support.kind(), support.why()}; }

Support support_of(const SupportReply& reply) {
  switch (reply.support) {
    case Support::Kind::full:
      return Support::full();
    case Support::Kind::approximate:
      return Support::approximate(printable(reply.why));
    case Support::Kind::unsupported:
      return Support::unsupported(printable(reply.why));
  }
  return Support::full();
}

}  // namespace gnomon
