#include "measure/statistics/distributions.h"

#include <boost/math/distributions/binomial.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <cassert>
#include <cmath>

namespace gnomon {

namespace {

using Policy = boost::math::policies::policy<boost::math::policies::promote_double<false>>;
using Student = boost::math::students_t_distribution<double, Policy>;
using Binomial = boost::math::binomial_distribution<double, Policy>;

}  // namespace

double student_tail(double t, double freedom) {
  assert(freedom > 0);
  if (std::isnan(t)) return t;
  return boost::math::cdf(boost::math::complement(Student(freedom), t));
}

double student_quantile(double tail, double freedom) {
  assert(tail > 0 && tail < 1);
  return boost::math::quantile(boost::math::complement(Student(freedom), tail));
}

std::size_t most_by_chance(std::size_t total, double chance, double false_alarm) {
  const Binomial law(static_cast<double>(total), chance);
  std::size_t low = 0, high = total;
  while (low < high) {
    const std::size_t middle = low + (high - low) / 2;
    const bool is_enough = boost::math::cdf(boost::math::complement(law, static_cast<double>(middle))) < false_alarm;
    (is_enough ? high : low) = is_enough ? middle : middle + 1;
  }
  return low;
}

}  // namespace gnomon
