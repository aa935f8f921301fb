#pragma once

namespace gnomon {

/// Adds the named members of one struct of counts to those of another: add_up(sum, part, &Work::cuts, &Work::lit).
template <class Counts, class... Member>
Counts& add_up(Counts& sum, const Counts& part, Member Counts::*... members) {
  ((sum.*members += part.*members), ...);
  return sum;
}

}  // namespace gnomon
