// Elementary functions against MPFR, over all that a double can be.
//
// ELEMENTARY_ARGUMENTS=10000000 takes so many arguments of each kind, in place of some thousand,
// and prints a table: function, greatest error and the C library's, ulp; nanoseconds a call, of
// both.
#include "host_sim/core/elementary.h"

#include <dlfcn.h>
#include <gtest/gtest.h>
#include <mpfr.h>

#include <algorithm>
#include <array>
#include <bit>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "host_sim/core/random.h"

namespace screed {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kMinSubnormal = std::numeric_limits<double>::denorm_min();
constexpr double kMinNormal = std::numeric_limits<double>::min();
constexpr double kMax = std::numeric_limits<double>::max();

/// Digits of the reference: enough that rounding it once more is as good as rounding the exact
/// value.
constexpr mpfr_prec_t kDigits = 200;

class Exact {
 public:
  Exact() { mpfr_init2(value_, kDigits); }
  explicit Exact(double x) : Exact() { mpfr_set_d(value_, x, MPFR_RNDN); }
  ~Exact() { mpfr_clear(value_); }
  Exact(const Exact&) = delete;
  Exact& operator=(const Exact&) = delete;
  mpfr_ptr get() { return value_; }
  double rounded() const { return mpfr_get_d(value_, MPFR_RNDN); }
  /// How far `got` is off, ulp of the exact value.
  double error_ulp(double got) {
    const double nearest = rounded();
    if (std::isnan(got) || std::isnan(nearest))
      return std::isnan(got) == std::isnan(nearest) ? 0.0 : kInfinity;
    if (std::isinf(got) || std::isinf(nearest)) return got == nearest ? 0.0 : kInfinity;
    const int exponent = nearest == 0.0 ? -1074 : std::max(std::ilogb(nearest) - 52, -1074);
    Exact difference(got);
    mpfr_sub(difference.get(), difference.get(), value_, MPFR_RNDN);
    mpfr_mul_2si(difference.get(), difference.get(), -exponent, MPFR_RNDN);
    return std::abs(difference.rounded());
  }

 private:
  mpfr_t value_;
};

using Unary = double (*)(double);
using Binary = double (*)(double, double);

struct Function {
  const char* name;
  Unary ours;
  int (*exact)(mpfr_ptr, mpfr_srcptr, mpfr_rnd_t);
  double bound_ulp;
  /// Arguments lie between these, and between plus and minus 2^these.
  double least, most;
  double least_power, most_power;
};
struct FunctionOfTwo {
  const char* name;
  Binary ours;
  int (*exact)(mpfr_ptr, mpfr_srcptr, mpfr_srcptr, mpfr_rnd_t);
  double bound_ulp;
};

const std::array kFunctions = {
    Function{"exp", portable::exp, mpfr_exp, 0.57, -746.0, 710.0, -60.0, 10.0},
    Function{"log", portable::log, mpfr_log, 0.51, 0.0, 3.0, -1074.0, 1024.0},
    Function{"sin", portable::sin, mpfr_sin, 0.8, -10.0, 10.0, -60.0, 1024.0},
    Function{"cos", portable::cos, mpfr_cos, 0.81, -10.0, 10.0, -60.0, 1024.0},
    Function{"tan", portable::tan, mpfr_tan, 1.03, -10.0, 10.0, -60.0, 1024.0},
    Function{"asin", portable::asin, mpfr_asin, 0.95, -1.0, 1.0, -60.0, 0.0},
    Function{"acos", portable::acos, mpfr_acos, 0.93, -1.0, 1.0, -60.0, 0.0},
    Function{"atan", portable::atan, mpfr_atan, 0.9, -2.0, 2.0, -1074.0, 1024.0},
    Function{"tanh", portable::tanh, mpfr_tanh, 0.65, -2.0, 2.0, -1074.0, 6.0},
};
const std::array kFunctionsOfTwo = {
    FunctionOfTwo{"pow", portable::pow, mpfr_pow, 0.56},
    FunctionOfTwo{"atan2", portable::atan2, mpfr_atan2, 0.95},
    FunctionOfTwo{"hypot", portable::hypot, mpfr_hypot, 0.76},
};

/// Arguments a kind; whether the table is asked for.
int arguments() {
  const char* asked = std::getenv("ELEMENTARY_ARGUMENTS");
  return asked != nullptr ? std::atoi(asked) : 2000;
}
bool table_is_asked_for() {
  return std::getenv("ELEMENTARY_ARGUMENTS") != nullptr;
}

/// The C library's function of this name, even where the program has put its own before it.
template <typename Call>
Call in_library(const char* name) {
  static void* const kLibrary = dlopen("libm.so.6", RTLD_NOW);
  return reinterpret_cast<Call>(dlsym(kLibrary, name));
}

class Arguments {
 public:
  double between(double least, double most) { return random_.uniform(least, most); }
  double power(double least, double most) {
    const double size = std::exp2(between(least, most));
    return random_.uniform() < 0.5 ? -size : size;
  }
  /// Bits of no meaning.
  double any() {
    const uint64_t high = random_.next();
    return std::bit_cast<double>((high << 32U) | random_.next());
  }

 private:
  WorldRandom random_{1, "arguments"};
};

/// An argument of `function`: of where it is used, of all sizes, near what is hard.
double argument_of(const Function& function, Arguments& from, int i) {
  switch (i % 4) {
    case 0:
      return from.between(function.least, function.most);
    case 1:
      return from.power(function.least_power, function.most_power);
    case 2:  // near multiples of a quarter turn
      return std::nearbyint(from.between(0.0, i % 8 == 2 ? 1e3 : 1e15)) * (0.5 * std::numbers::pi);
    default:
      return 1.0 + from.power(-53.0, -1.0);
  }
}
std::array<double, 2> arguments_of(const FunctionOfTwo& function, Arguments& from, int i) {
  const bool is_power = std::string(function.name) == "pow";
  std::array<double, 2> both{};
  switch (i % 4) {
    case 0:
      both = {from.between(-3.0, 3.0), from.between(-3.0, 3.0)};
      break;
    case 1:
      both = {from.power(-1074.0, 1024.0),
              is_power ? from.between(-1.0, 1.0) : from.power(-1074.0, 1024.0)};
      break;
    case 2:
      both = {from.power(-30.0, 30.0), from.power(-30.0, is_power ? 6.0 : 30.0)};
      break;
    default:
      both = {1.0 + from.power(-53.0, -1.0), from.power(-10.0, 50.0)};
  }
  if (is_power && i % 8 != 0) both[0] = std::abs(both[0]);
  if (is_power && i % 8 == 0) both[1] = std::nearbyint(both[1]);
  return both;
}

/// Nanoseconds a call, the least of five times through the arguments.
template <typename Call>
double time_ns(const Call& call, size_t count) {
  double least = kInfinity;
  for (int round = 0; round < 5; ++round) {
    const auto begin = std::chrono::steady_clock::now();
    double sum = 0.0;
    for (size_t i = 0; i < count; ++i) sum += call(i);
    const std::chrono::duration<double, std::nano> taken = std::chrono::steady_clock::now() - begin;
    if (sum == 0.1234) std::puts("");  // so that it is computed
    least = std::min(least, taken.count() / static_cast<double>(count));
  }
  return least;
}

TEST(Elementary, IsWithinItsBoundOfTheExactValue) {
  for (const Function& function : kFunctions) {
    Arguments from;
    double worst = 0.0;
    double worst_library = 0.0;
    const auto library = in_library<Unary>(function.name);
    double at = 0.0;
    for (int i = 0; i < 4 * arguments(); ++i) {
      const double x = argument_of(function, from, i);
      Exact value(x);
      function.exact(value.get(), value.get(), MPFR_RNDN);
      const double error = value.error_ulp(function.ours(x));
      if (error > worst) {
        worst = error;
        at = x;
      }
      if (table_is_asked_for())
        worst_library = std::max(worst_library, value.error_ulp(library(x)));
    }
    EXPECT_LE(worst, function.bound_ulp) << function.name << " of " << at;
    if (!table_is_asked_for()) continue;
    std::vector<double> x(4000);
    for (double& value : x) value = from.between(function.least, function.most);
    std::printf("| %s | %.3f | %.3f | %.1f | %.1f |\n", function.name, worst, worst_library,
                time_ns([&](size_t i) { return function.ours(x[i]); }, x.size()),
                time_ns([&](size_t i) { return library(x[i]); }, x.size()));
  }
}

TEST(Elementary, OfTwoNumbersLikewise) {
  for (const FunctionOfTwo& function : kFunctionsOfTwo) {
    Arguments from;
    double worst = 0.0;
    double worst_library = 0.0;
    const auto library = in_library<Binary>(function.name);
    std::array<double, 2> at{};
    for (int i = 0; i < 4 * arguments(); ++i) {
      const std::array<double, 2> x = arguments_of(function, from, i);
      Exact value(x[0]);
      Exact other(x[1]);
      function.exact(value.get(), value.get(), other.get(), MPFR_RNDN);
      const double error = value.error_ulp(function.ours(x[0], x[1]));
      if (error > worst) {
        worst = error;
        at = x;
      }
      if (table_is_asked_for())
        worst_library = std::max(worst_library, value.error_ulp(library(x[0], x[1])));
    }
    EXPECT_LE(worst, function.bound_ulp) << function.name << " of " << at[0] << ", " << at[1];
    if (!table_is_asked_for()) continue;
    std::vector<std::array<double, 2>> x(4000);
    for (auto& both : x) both = {from.between(0.0, 3.0), from.between(-3.0, 3.0)};
    std::printf("| %s | %.3f | %.3f | %.1f | %.1f |\n", function.name, worst, worst_library,
                time_ns([&](size_t i) { return function.ours(x[i][0], x[i][1]); }, x.size()),
                time_ns([&](size_t i) { return library(x[i][0], x[i][1]); }, x.size()));
  }
}

const std::vector<double>& special_values() {
  static const std::vector<double> values = [] {
    std::vector<double> positive = {0.0,
                                    kMinSubnormal,
                                    3.0 * kMinSubnormal,
                                    kMinNormal,
                                    std::nextafter(kMinNormal, 0.0),
                                    0x1p-600,
                                    0x1p-60,
                                    0.25,
                                    0.5,
                                    std::nextafter(1.0, 0.0),
                                    1.0,
                                    std::nextafter(1.0, 2.0),
                                    2.0,
                                    3.0,
                                    22.0,
                                    708.5,
                                    710.0,
                                    746.0,
                                    1e5,
                                    0x1p20,
                                    0x1p52 - 0.5,
                                    0x1p52 + 1.0,
                                    0x1p53 - 1.0,
                                    0x1p53,
                                    1e22,
                                    0x1p600,
                                    kMax,
                                    kInfinity,
                                    0.25 * std::numbers::pi,
                                    0.5 * std::numbers::pi,
                                    std::numbers::pi,
                                    kNan};
    std::vector<double> both = positive;
    for (const double x : positive) both.push_back(-x);
    return both;
  }();
  return values;
}

/// The same number, the same sign of zero and infinity; up to an ulp where it is neither.
void expect_special(double got, Exact& exact, const std::string& of) {
  const double wanted = exact.rounded();
  if (std::isnan(wanted)) {
    EXPECT_TRUE(std::isnan(got)) << of << ": " << got;
  } else if (wanted == 0.0 || std::isinf(wanted)) {
    EXPECT_TRUE(got == wanted && std::signbit(got) == std::signbit(wanted))
        << of << ": " << got << ", not " << wanted;
  } else {
    EXPECT_LE(exact.error_ulp(got), 1.0) << of << ": " << got << ", not " << wanted;
  }
}

TEST(Elementary, TakesSpecialValuesAsCDoes) {
  for (const double x : special_values()) {
    for (const Function& function : kFunctions) {
      Exact value(x);
      function.exact(value.get(), value.get(), MPFR_RNDN);
      expect_special(function.ours(x), value, function.name + (" of " + std::to_string(x)));
    }
    for (const double y : special_values()) {
      for (const FunctionOfTwo& function : kFunctionsOfTwo) {
        Exact value(x);
        Exact other(y);
        function.exact(value.get(), value.get(), other.get(), MPFR_RNDN);
        expect_special(function.ours(x, y), value,
                       function.name + (" of " + std::to_string(x) + ", " + std::to_string(y)));
      }
    }
  }
}

TEST(Elementary, SineAndCosineTogetherAreThoseAlone) {
  Arguments from;
  for (int i = 0; i < 20000; ++i) {
    const double x = i % 2 == 0 ? from.between(-10.0, 10.0) : from.power(-60.0, 1024.0);
    const portable::SineCosine both = portable::sine_cosine(x);
    ASSERT_EQ(both.sine, portable::sin(x)) << x;
    ASSERT_EQ(both.cosine, portable::cos(x)) << x;
  }
  EXPECT_TRUE(std::isnan(portable::sine_cosine(kInfinity).cosine));
}

// What no processor changes: bits, over arguments that no library has a part in.
TEST(Elementary, HasTheSameBitsEverywhere) {
  Arguments from;
  uint64_t hash = 0;
  const auto take = [&hash](double value) {
    hash = (hash ^ (std::isnan(value) ? 0 : std::bit_cast<uint64_t>(value))) * 0x100000001B3U;
  };
  for (int i = 0; i < 20000; ++i) {
    const double x = i % 2 == 0 ? from.any() : from.between(-1.0, 1.0);
    const double y = i % 2 == 0 ? from.any() : from.between(-1.0, 1.0);
    for (const Function& function : kFunctions) take(function.ours(x));
    for (const FunctionOfTwo& function : kFunctionsOfTwo) take(function.ours(x, y));
  }
  EXPECT_EQ(hash, 7176568758414096761U);
}

}  // namespace
}  // namespace screed
