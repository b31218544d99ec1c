// Argument reduction to a short interval, a polynomial there, and sums of two doubles where one
// would not be exact enough. Muller, Handbook of Floating-Point Arithmetic, 2nd ed., chapters 4
// (sums and products without error) and 10 (reduction). Polynomials are minimax ones for the
// interval at hand; the tables' numbers are exact values rounded.
#include "host_sim/core/elementary.h"

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

namespace screed::portable {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr uint64_t kSignBit = uint64_t{1} << 63;
constexpr double kToWhole = 0x1.8p52;  // added and taken away again, rounds to a whole number

uint64_t bits_of(double x) {
  return std::bit_cast<uint64_t>(x);
}
double from_bits(uint64_t bits) {
  return std::bit_cast<double>(bits);
}
/// 2^exponent, of a normal number.
double power_of_two(int64_t exponent) {
  return from_bits(static_cast<uint64_t>(exponent + 1023) << 52);
}

// ---- sums of two doubles -----------------------------------------------------------------------

/// hi + lo, where |lo| is at most half a unit in the last place of hi.
struct Sum {
  double hi;
  double lo;
};

/// a + b, exactly.
Sum two_sum(double a, double b) {
  const double sum = a + b;
  const double part = sum - a;
  return {sum, (a - (sum - part)) + (b - part)};
}
/// The same where |a| >= |b| or a is 0.
Sum quick_two_sum(double a, double b) {
  const double sum = a + b;
  return {sum, b - (sum - a)};
}
/// The upper half of the digits: products of two such are exact.
double upper_half(double x) {
  return from_bits(bits_of(x) & ~uint64_t{0x7ffffff});
}
/// a b, but for less than 2^-105 of it.
Sum two_product(double a, double b) {
  const double product = a * b;
  const double a_hi = upper_half(a);
  const double b_hi = upper_half(b);
  const double a_lo = a - a_hi;
  const double b_lo = b - b_hi;
  return {product, ((a_hi * b_hi - product) + a_hi * b_lo + a_lo * b_hi) + a_lo * b_lo};
}
Sum operator+(const Sum& a, const Sum& b) {
  const Sum sum = two_sum(a.hi, b.hi);
  return quick_two_sum(sum.hi, sum.lo + (a.lo + b.lo));
}
Sum operator-(const Sum& a) {
  return {-a.hi, -a.lo};
}
Sum operator/(const Sum& a, const Sum& b) {
  const double quotient = a.hi / b.hi;
  const Sum back = two_product(quotient, b.hi);
  return quick_two_sum(quotient, ((a.hi - back.hi) - back.lo + a.lo - quotient * b.lo) / b.hi);
}
/// Of one that is not negative.
Sum square_root(const Sum& a) {
  const double root = std::sqrt(a.hi);
  if (root == 0.0) return {0.0, 0.0};
  const Sum back = two_product(root, root);
  return quick_two_sum(root, ((a.hi - back.hi) - back.lo + a.lo) / (2.0 * root));
}

template <int kCount>
double polynomial(const double (&coefficients)[kCount], double x) {
  double sum = coefficients[kCount - 1];
  for (int i = kCount - 2; i >= 0; --i) sum = sum * x + coefficients[i];
  return sum;
}

// ---- exponential and logarithm -----------------------------------------------------------------

/// 2^(i/128) rounded, and what that leaves out as a share of it.
struct Power {
  double value;
  double rest;
};
constexpr Power kPowers[128] = {
    {0x1p+0, 0x0p+0},
    {0x1.0163da9fb3335p+0, 0x1.b3b4f1a88bf6ep-54},
    {0x1.02c9a3e778061p+0, -0x1.160139cd8dc5dp-56},
    {0x1.04315e86e7f85p+0, -0x1.05e7a108766d1p-54},
    {0x1.059b0d3158574p+0, 0x1.cd2523567f613p-55},
    {0x1.0706b29ddf6dep+0, -0x1.bce8023f98efap-55},
    {0x1.0874518759bc8p+0, 0x1.0f74e61e6c861p-57},
    {0x1.09e3ecac6f383p+0, 0x1.0a3e45b33d399p-54},
    {0x1.0b5586cf9890fp+0, 0x1.79aa65d837b6dp-54},
    {0x1.0cc922b7247f7p+0, 0x1.eb51a92fdeffcp-55},
    {0x1.0e3ec32d3d1a2p+0, 0x1.ebe3d702f9cd1p-60},
    {0x1.0fb66affed31bp+0, -0x1.a033489906e0bp-57},
    {0x1.11301d0125b51p+0, -0x1.556522a2fbd0ep-54},
    {0x1.12abdc06c31ccp+0, -0x1.080ef8c4eea55p-58},
    {0x1.1429aaea92dep+0, -0x1.1c923b9d5f416p-54},
    {0x1.15a98c8a58e51p+0, 0x1.0d3e3e95c55afp-55},
    {0x1.172b83c7d517bp+0, -0x1.01b15eaa59348p-55},
    {0x1.18af9388c8deap+0, -0x1.f1ff055de323dp-55},
    {0x1.1a35beb6fcb75p+0, 0x1.b898c3f1353bfp-55},
    {0x1.1bbe084045cd4p+0, -0x1.6d99c7611eb26p-54},
    {0x1.1d4873168b9aap+0, 0x1.aecf73e3a2f6p-54},
    {0x1.1ed5022fcd91dp+0, -0x1.fe782cb86389dp-55},
    {0x1.2063b88628cd6p+0, 0x1.a6f4144a6c38dp-55},
    {0x1.21f49917ddc96p+0, 0x1.07a05b0e4047dp-55},
    {0x1.2387a6e756238p+0, 0x1.68efde3a8a894p-54},
    {0x1.251ce4fb2a63fp+0, 0x1.75e18f274487dp-55},
    {0x1.26b4565e27cddp+0, 0x1.0472b981fe7f2p-55},
    {0x1.284dfe1f56381p+0, -0x1.6b87b3f71085ep-54},
    {0x1.29e9df51fdee1p+0, 0x1.2f7e16d09ab31p-55},
    {0x1.2b87fd0dad99p+0, -0x1.d219b1a6fbffap-60},
    {0x1.2d285a6e4030bp+0, 0x1.b3782720c0ab4p-55},
    {0x1.2ecafa93e2f56p+0, 0x1.e149289cecb8fp-57},
    {0x1.306fe0a31b715p+0, 0x1.34d754db0abb6p-55},
    {0x1.32170fc4cd831p+0, 0x1.64201e2ac744cp-55},
    {0x1.33c08b26416ffp+0, 0x1.fdd395dd3f84ap-55},
    {0x1.356c55f929ff1p+0, -0x1.6a3803b8e5b04p-55},
    {0x1.371a7373aa9cbp+0, -0x1.24aedcc4b5068p-54},
    {0x1.38cae6d05d866p+0, -0x1.907f81b512d8ep-54},
    {0x1.3a7db34e59ff7p+0, -0x1.1d1e83e9436d2p-56},
    {0x1.3c32dc313a8e5p+0, -0x1.91919b3ce1b15p-54},
    {0x1.3dea64c123422p+0, 0x1.59f48a72a4c6dp-55},
    {0x1.3fa4504ac801cp+0, -0x1.312607a28698ap-54},
    {0x1.4160a21f72e2ap+0, -0x1.8a78f4817895bp-58},
    {0x1.431f5d950a897p+0, -0x1.c2c9b67499a1bp-56},
    {0x1.44e086061892dp+0, 0x1.363ed60c2ac11p-59},
    {0x1.46a41ed1d0057p+0, 0x1.666093b0664efp-54},
    {0x1.486a2b5c13cdp+0, 0x1.ecce1daa10379p-57},
    {0x1.4a32af0d7d3dep+0, 0x1.3ff8e3f0f123p-54},
    {0x1.4bfdad5362a27p+0, 0x1.690cebb7aafbp-56},
    {0x1.4dcb299fddd0dp+0, 0x1.31dbdeb54e077p-54},
    {0x1.4f9b2769d2ca7p+0, -0x1.f94340071a38ep-55},
    {0x1.516daa2cf6642p+0, -0x1.7deccdc93a349p-55},
    {0x1.5342b569d4f82p+0, -0x1.8dec6bd0f385fp-56},
    {0x1.551a4ca5d920fp+0, -0x1.61246ec7b5cf6p-55},
    {0x1.56f4736b527dap+0, 0x1.3350518fdd78ep-54},
    {0x1.58d12d497c7fdp+0, 0x1.b98b72f8a9b05p-56},
    {0x1.5ab07dd485429p+0, 0x1.063e1e21c5409p-54},
    {0x1.5c9268a5946b7p+0, 0x1.4c7855019c6eap-60},
    {0x1.5e76f15ad2148p+0, 0x1.432e62b64c035p-54},
    {0x1.605e1b976dc09p+0, -0x1.ce44a6199769fp-55},
    {0x1.6247eb03a5585p+0, -0x1.c33c53bef4da8p-55},
    {0x1.6434634ccc32p+0, -0x1.45378892be9aep-55},
    {0x1.6623882552225p+0, -0x1.3cedd78565858p-54},
    {0x1.68155d44ca973p+0, 0x1.710aa807e1964p-58},
    {0x1.6a09e667f3bcdp+0, -0x1.3b3efbf5e2228p-54},
    {0x1.6c012750bdabfp+0, -0x1.a12ad8734b982p-57},
    {0x1.6dfb23c651a2fp+0, -0x1.367efb86da9eep-57},
    {0x1.6ff7df9519484p+0, -0x1.0dc3d54e08851p-55},
    {0x1.71f75e8ec5f74p+0, -0x1.81f647e5a3ecfp-56},
    {0x1.73f9a48a58174p+0, -0x1.6ee4ac08b7dbp-55},
    {0x1.75feb564267c9p+0, -0x1.619321e55e68ap-55},
    {0x1.780694fde5d3fp+0, 0x1.09ccb5e09d4d3p-54},
    {0x1.7a11473eb0187p+0, -0x1.b32dcb94da51dp-56},
    {0x1.7c1ed0130c132p+0, 0x1.4ecfd5467c06bp-54},
    {0x1.7e2f336cf4e62p+0, 0x1.5ebe1abd66c55p-57},
    {0x1.80427543e1a12p+0, -0x1.8a1c52fb3cf42p-55},
    {0x1.82589994cce13p+0, -0x1.369b6f13b3734p-54},
    {0x1.8471a4623c7adp+0, -0x1.05e843a19ff1ep-55},
    {0x1.868d99b4492edp+0, -0x1.4d450d872576ep-54},
    {0x1.88ac7d98a6699p+0, 0x1.0ad675b0e8ap-54},
    {0x1.8ace5422aa0dbp+0, 0x1.db72fc1f0eab4p-55},
    {0x1.8cf3216b5448cp+0, -0x1.5b6609cc5e7ffp-57},
    {0x1.8f1ae99157736p+0, 0x1.bf68359f35f44p-56},
    {0x1.9145b0b91ffc6p+0, -0x1.3091fa71e3d83p-54},
    {0x1.93737b0cdc5e5p+0, -0x1.da9b88b6c1e29p-58},
    {0x1.95a44cbc8520fp+0, -0x1.c23f97c90b959p-57},
    {0x1.97d829fde4e5p+0, -0x1.2434322f4f9aap-54},
    {0x1.9a0f170ca07bap+0, -0x1.5ca6cd7668e4bp-55},
    {0x1.9c49182a3f09p+0, 0x1.1affc2b91ce27p-56},
    {0x1.9e86319e32323p+0, 0x1.dd235e10a73bbp-57},
    {0x1.a0c667b5de565p+0, -0x1.7c50422622263p-55},
    {0x1.a309bec4a2d33p+0, 0x1.b1c86e3e231d5p-55},
    {0x1.a5503b23e255dp+0, -0x1.1bbd1d3bcbb15p-54},
    {0x1.a799e1330b358p+0, 0x1.0cc319cee31d2p-54},
    {0x1.a9e6b5579fdbfp+0, 0x1.469846e735ab3p-55},
    {0x1.ac36bbfd3f37ap+0, -0x1.2dfcd978e9db4p-55},
    {0x1.ae89f995ad3adp+0, 0x1.c1a7792cb3387p-55},
    {0x1.b0e07298db666p+0, -0x1.07b8f4ad1d9fap-54},
    {0x1.b33a2b84f15fbp+0, -0x1.5c3d956dcaebap-58},
    {0x1.b59728de5593ap+0, -0x1.0a40e3da6f64p-54},
    {0x1.b7f76f2fb5e47p+0, -0x1.8d6f438ad9334p-57},
    {0x1.ba5b030a1064ap+0, -0x1.1eee26b588a35p-54},
    {0x1.bcc1e904bc1d2p+0, 0x1.4ffd70a5fddcdp-56},
    {0x1.bf2c25bd71e09p+0, -0x1.1bdfbfa9298acp-54},
    {0x1.c199bdd85529cp+0, 0x1.36eae30af0cb3p-56},
    {0x1.c40ab5fffd07ap+0, 0x1.ee3325c9ffd94p-55},
    {0x1.c67f12e57d14bp+0, 0x1.4e08fd10959acp-55},
    {0x1.c8f6d9406e7b5p+0, 0x1.3cdaf384e1a67p-57},
    {0x1.cb720dcef9069p+0, 0x1.76b2c6c921968p-57},
    {0x1.cdf0b555dc3fap+0, -0x1.08a1883ccb5d2p-55},
    {0x1.d072d4a07897cp+0, -0x1.fad5d3ffffa6fp-55},
    {0x1.d2f87080d89f2p+0, -0x1.00dae3875a949p-54},
    {0x1.d5818dcfba487p+0, 0x1.4a385a63d07a7p-56},
    {0x1.d80e316c98398p+0, -0x1.2919e2040220fp-55},
    {0x1.da9e603db3285p+0, 0x1.e5a50d5c192acp-55},
    {0x1.dd321f301b46p+0, 0x1.43a59ac016b4bp-55},
    {0x1.dfc97337b9b5fp+0, -0x1.2d52107b43e1fp-55},
    {0x1.e264614f5a129p+0, -0x1.92ab93b470dc9p-55},
    {0x1.e502ee78b3ff6p+0, 0x1.4b604603a88d3p-56},
    {0x1.e7a51fbc74c83p+0, 0x1.3c5ec519d7271p-55},
    {0x1.ea4afa2a490dap+0, -0x1.ff7128fd391fp-55},
    {0x1.ecf482d8e67f1p+0, -0x1.dae98e223747dp-55},
    {0x1.efa1bee615a27p+0, 0x1.ec3bc41aa2008p-55},
    {0x1.f252b376bba97p+0, 0x1.42b94c3a9eb32p-55},
    {0x1.f50765b6e454p+0, 0x1.a64a931d185eep-55},
    {0x1.f7bfdad9cbe14p+0, -0x1.e37bae43be3edp-55},
    {0x1.fa7c1819e90d8p+0, 0x1.7893b4d91cd9dp-56},
    {0x1.fd3c22b8f71f1p+0, 0x1.305c14160cc89p-58},
};
constexpr double k128OverLn2 = 0x1.71547652b82fep+7;
constexpr double kLn2Over128Hi = 0x1.62e42fefcp-8;
constexpr double kLn2Over128Lo = -0x1.c610ca86c3899p-44;

/// e^(x + rest) = value (1 + less_one) 2^exponent, for |x| < 1100 and a rest below x's last digit.
struct Exponential {
  double value;
  double less_one;
  int64_t exponent;
};
Exponential exponential(double x, double rest) {
  const double whole = (x * k128OverLn2 + kToWhole) - kToWhole;
  const auto steps = static_cast<int64_t>(whole);
  const double r = (x - whole * kLn2Over128Hi) - (whole * kLn2Over128Lo - rest);
  const Power& power = kPowers[steps & 127];
  const double square = r * r;
  const double less_one = (power.rest + r) + square * (0.5 + r * (1.0 / 6.0)) +
                          square * square * (1.0 / 24.0 + r * (1.0 / 120.0));
  return {power.value, less_one, steps >> 7};
}

/// Rounded once, among subnormal numbers too.
double rounded(const Exponential& it) {
  if (it.exponent > -1020 && it.exponent < 1023) {
    const double scale = it.value * power_of_two(it.exponent);
    return scale + scale * it.less_one;
  }
  if (it.exponent > 1024) return kInfinity;
  if (it.exponent < -1100) return 0.0;
  const Sum sum = quick_two_sum(it.value, it.value * it.less_one);
  if (it.exponent > 0) return (sum.hi + sum.lo) * 0x1p1022 * power_of_two(it.exponent - 1022);
  // As a share of the least normal number. One below 1 has beside 1 the digits that it keeps.
  const double scale = power_of_two(it.exponent + 1022);
  const double share = sum.hi * scale;
  if (share >= 1.0) return share * 0x1p-1022;
  const Sum beside = two_sum(1.0, share);
  return ((beside.hi + (beside.lo + sum.lo * scale)) - 1.0) * 0x1p-1022;
}

/// For significands of an interval: a number near the reciprocal of its middle, of 20 digits, and
/// minus its logarithm, the upper part a multiple of 2^-42.
struct Logarithm {
  double reciprocal;
  double hi;
  double lo;
};
// 128 intervals, from the number of these bits (0.706) to twice it; 1 lies inside of the one whose
// reciprocal is 1.
constexpr uint64_t kMinBits = 0x3fe6955500000000;
constexpr Logarithm kLogarithms[128] = {
    {0x1.69be8p+0, -0x1.620ed6447ap-2, -0x1.5f9d91f6c952p-47},
    {0x1.67c22p+0, -0x1.5c6bccd3c5p-2, 0x1.1cfa0055f9c96p-44},
    {0x1.65cb6p+0, -0x1.56d0dff378p-2, -0x1.d07e2a6f8f99ap-45},
    {0x1.63dap+0, -0x1.513d84f359p-2, 0x1.11fdfd85f82eap-44},
    {0x1.61eep+0, -0x1.4bb1e6a96cp-2, 0x1.8d814ba84b1bap-46},
    {0x1.60076p+0, -0x1.462e304554p-2, -0x1.e9a4bb0296f34p-44},
    {0x1.5e25ep+0, -0x1.40b1d223bcp-2, -0x1.325c14802369ap-46},
    {0x1.5c498p+0, -0x1.3b3cf521c9p-2, 0x1.36ba4b89d601p-44},
    {0x1.5a722p+0, -0x1.35cf63db4dp-2, 0x1.1820e4c4a0e1fp-47},
    {0x1.589fcp+0, -0x1.30694653abp-2, -0x1.9eaa9ad68bcbcp-45},
    {0x1.56d24p+0, -0x1.2b0a654973p-2, -0x1.b2ee50b0fdaa3p-47},
    {0x1.5509ap+0, -0x1.25b2e7df5bp-2, -0x1.e68e4a2128859p-46},
    {0x1.5345ap+0, -0x1.2062345aa6p-2, -0x1.33dc74b81adabp-44},
    {0x1.51864p+0, -0x1.1b186f76d3p-2, 0x1.df95595e43625p-46},
    {0x1.4fcb8p+0, -0x1.15d5be396dp-2, 0x1.b89fe2bb07846p-46},
    {0x1.4e156p+0, -0x1.109a45f089p-2, 0x1.e81a71033be04p-44},
    {0x1.4c638p+0, -0x1.0b65047149p-2, -0x1.0201236ca42ddp-45},
    {0x1.4ab62p+0, -0x1.0636e14117p-2, -0x1.a23f52f61ec7fp-45},
    {0x1.490d2p+0, -0x1.010f9d6992p-2, -0x1.6b9e242945c44p-44},
    {0x1.47684p+0, -0x1.f7dd2843c4p-3, 0x1.c03bc80927796p-46},
    {0x1.45c7ap+0, -0x1.eda8954556p-3, 0x1.45e943d7e6858p-45},
    {0x1.442b2p+0, -0x1.e380fc7446p-3, 0x1.ffb886567aa1bp-45},
    {0x1.4292ap+0, -0x1.d965d4eae8p-3, 0x1.923d40535656bp-45},
    {0x1.40fe2p+0, -0x1.cf575e699cp-3, -0x1.3c8262322966fp-45},
    {0x1.3f6dap+0, -0x1.c555d929ccp-3, -0x1.0d0b7a1bc1806p-45},
    {0x1.3de1p+0, -0x1.bb60b7b0ep-3, 0x1.db3bdd4fe72dbp-45},
    {0x1.3c582p+0, -0x1.b17768f89ap-3, -0x1.ad4b27cb80a13p-44},
    {0x1.3ad32p+0, -0x1.a79af8c234p-3, 0x1.9ecae27b46522p-44},
    {0x1.3951ep+0, -0x1.9dcad4e976p-3, 0x1.2e7e0b943fae2p-44},
    {0x1.37d42p+0, -0x1.9405958d6p-3, 0x1.9000c1a74bc58p-44},
    {0x1.365a2p+0, -0x1.8a4d17e338p-3, -0x1.364930d790633p-45},
    {0x1.34e3ap+0, -0x1.809ff0df58p-3, -0x1.76e0885de1828p-44},
    {0x1.3370cp+0, -0x1.76ff2d5dc4p-3, -0x1.b3da8d5ad40b1p-45},
    {0x1.32014p+0, -0x1.6d695c2046p-3, 0x1.54e37c73c5044p-45},
    {0x1.30952p+0, -0x1.63deb2a1dp-3, 0x1.4750dbe7c0679p-44},
    {0x1.2f2c6p+0, -0x1.5a5f66bf52p-3, 0x1.4dc5510a47e2dp-44},
    {0x1.2dc7p+0, -0x1.50ebaeb5f6p-3, 0x1.c9030da8bcbfep-44},
    {0x1.2c64ep+0, -0x1.4782e6f69ep-3, -0x1.a31e18cc0f13ep-44},
    {0x1.2b06p+0, -0x1.3e25437994p-3, -0x1.e0e87ea0dd16p-50},
    {0x1.29aa6p+0, -0x1.34d2f8921ap-3, 0x1.947e9b269cd64p-44},
    {0x1.2851cp+0, -0x1.2b8a80977ap-3, 0x1.e09fc9509596fp-44},
    {0x1.26fc6p+0, -0x1.224dc6e36cp-3, -0x1.cc4992a7bc86p-50},
    {0x1.25aap+0, -0x1.191b427b24p-3, -0x1.078e10de77e7fp-46},
    {0x1.245aap+0, -0x1.0ff3230ddp-3, 0x1.6abdcf0296bf2p-50},
    {0x1.230e4p+0, -0x1.06d5989db8p-3, -0x1.8ccd82490fc14p-44},
    {0x1.21c4cp+0, -0x1.fb83e2a85p-4, 0x1.f125d3d89fdb6p-45},
    {0x1.207e4p+0, -0x1.e9727bffd4p-4, 0x1.26295eaae4fb8p-44},
    {0x1.1f3a8p+0, -0x1.d773ce7d3cp-4, -0x1.418c2e1d2eae5p-45},
    {0x1.1df9ap+0, -0x1.c589faf698p-4, -0x1.d82d3e2206ffdp-45},
    {0x1.1cbbap+0, -0x1.b3b55e84ccp-4, -0x1.a834c05a6841dp-44},
    {0x1.1b804p+0, -0x1.a1f2ba2b8cp-4, 0x1.78aee34db080ep-45},
    {0x1.1a47ap+0, -0x1.9044308174p-4, 0x1.07d92a1fd1da9p-45},
    {0x1.1911cp+0, -0x1.7eaa1a5844p-4, 0x1.e45ec0a551a5fp-44},
    {0x1.17de8p+0, -0x1.6d22fcba34p-4, -0x1.cf4605c2bfafcp-44},
    {0x1.16adep+0, -0x1.5baf2b927p-4, 0x1.a0afae874aa81p-47},
    {0x1.157fcp+0, -0x1.4a4d22fffp-4, 0x1.adb4ff66d9b51p-46},
    {0x1.14544p+0, -0x1.38ff0c5308p-4, -0x1.97ba9ce725954p-44},
    {0x1.132b2p+0, -0x1.27c18460c8p-4, 0x1.985b5958c76cfp-45},
    {0x1.1204ap+0, -0x1.169891d5c8p-4, 0x1.70ad77f789172p-45},
    {0x1.10e0ap+0, -0x1.0582aadec4p-4, -0x1.499226dda9d47p-47},
    {0x1.0fbeep+0, -0x1.e8f8b7a2a8p-5, -0x1.492b8ca8c0db7p-44},
    {0x1.0e9fap+0, -0x1.c71365a848p-5, 0x1.744ef2775643ap-44},
    {0x1.0d82cp+0, -0x1.a552370fbp-5, 0x1.e1f6c53bb3a73p-44},
    {0x1.0c682p+0, -0x1.83b1f40ap-5, 0x1.219c27a91d6acp-44},
    {0x1.0b4fep+0, -0x1.6236ff098p-5, 0x1.b4cd6c7a00a6dp-44},
    {0x1.0a39ep+0, -0x1.40de1a132p-5, 0x1.2accaf8332869p-46},
    {0x1.09262p+0, -0x1.1fa7d4badp-5, -0x1.1e1a0b72c9aep-49},
    {0x1.0814ap+0, -0x1.fd297eea2p-6, 0x1.262f0a7721051p-45},
    {0x1.07056p+0, -0x1.bb4ad7267p-6, -0x1.6a2a6f84a61fap-48},
    {0x1.05f82p+0, -0x1.79a533d61p-6, -0x1.1e79dd6953597p-45},
    {0x1.04ed2p+0, -0x1.38493da5p-6, -0x1.51c6a8458f0a7p-45},
    {0x1.03e44p+0, -0x1.ee6075c9ap-7, 0x1.b8d1b420a0e78p-44},
    {0x1.02dd8p+0, -0x1.6cb679b52p-7, 0x1.ca3bbd0aabadap-44},
    {0x1.01d8cp+0, -0x1.d70d9439p-8, -0x1.fd49cf77b3b49p-46},
    {0x1.00d6p+0, -0x1.ab4d7f738p-9, 0x1.c9347e373182p-45},
    {0x1p+0, 0x0p+0, 0x0p+0},
    {0x1.fb602p-1, 0x1.295040918p-7, 0x1.fc4227f8a0de4p-45},
    {0x1.f77a4p-1, 0x1.1303969a2p-6, 0x1.b831c9a578699p-44},
    {0x1.f3a3ap-1, 0x1.90665bf63p-6, -0x1.91bd13254ea07p-44},
    {0x1.efdbep-1, 0x1.066a93831p-5, 0x1.42420d7bcf7d4p-44},
    {0x1.ec22ap-1, 0x1.442a7c574p-5, 0x1.0d49562b869c3p-45},
    {0x1.e877ap-1, 0x1.817375b02p-5, 0x1.b0ca4b23a9d74p-45},
    {0x1.e4da8p-1, 0x1.be483f321p-5, 0x1.bf31429c88bc1p-45},
    {0x1.e14aep-1, 0x1.faabbe9p-5, -0x1.86310599f2d91p-44},
    {0x1.ddc8ap-1, 0x1.1b4e5b404cp-4, 0x1.fe379dfe3f43ep-47},
    {0x1.da536p-1, 0x1.390f20d86p-4, -0x1.d87cf7ea35653p-44},
    {0x1.d6eaep-1, 0x1.5698ba8454p-4, 0x1.c2953672ac00ep-44},
    {0x1.d38ecp-1, 0x1.73ecd6a20cp-4, 0x1.cfa84b7231204p-44},
    {0x1.d03eep-1, 0x1.910b02994cp-4, 0x1.941c233fcf51ep-45},
    {0x1.ccfaep-1, 0x1.adf508502p-4, 0x1.3ec58c2c9141bp-44},
    {0x1.c9c2ap-1, 0x1.caaa88f38p-4, 0x1.7d07754242806p-44},
    {0x1.c695cp-1, 0x1.e72d6a698cp-4, 0x1.0f1cd0e3847cp-45},
    {0x1.c3742p-1, 0x1.01beb10c0ep-3, 0x1.c43de7e1fbf2cp-44},
    {0x1.c05d8p-1, 0x1.0fcda6ffe2p-3, 0x1.13120704f2372p-48},
    {0x1.bd518p-1, 0x1.1dc49f6adcp-3, -0x1.b994f556c6f08p-44},
    {0x1.ba502p-1, 0x1.2ba2f063ecp-3, -0x1.4794931a04527p-44},
    {0x1.b759p-1, 0x1.3969adca62p-3, 0x1.1e4df80cae373p-44},
    {0x1.b46cp-1, 0x1.4718c97c72p-3, -0x1.eb60730b6d8b1p-46},
    {0x1.b188ep-1, 0x1.54b0cee27ap-3, -0x1.8ca607e008082p-45},
    {0x1.aeaf8p-1, 0x1.6231b7a4b6p-3, -0x1.3b32a3354613dp-46},
    {0x1.abdfcp-1, 0x1.6f9b7fe086p-3, 0x1.ea06b822a0de3p-44},
    {0x1.a9194p-1, 0x1.7cef5a880cp-3, -0x1.a892a944ab1ddp-46},
    {0x1.a65bep-1, 0x1.8a2d4ec16ep-3, -0x1.b7a721fe3af5fp-47},
    {0x1.a3a78p-1, 0x1.97556645d8p-3, -0x1.02406b3d4a034p-44},
    {0x1.a0fcp-1, 0x1.a467ad6ac2p-3, 0x1.88d3eb4bf813ap-46},
    {0x1.9e59p-1, 0x1.b1656f804cp-3, 0x1.b9022d37f4a17p-46},
    {0x1.9bbeap-1, 0x1.be4d85da08p-3, 0x1.a4d94435c4f16p-45},
    {0x1.992c8p-1, 0x1.cb21452cb6p-3, 0x1.6dba9b8fc0211p-44},
    {0x1.96a2ap-1, 0x1.d7e0296bdcp-3, -0x1.9bc2df602ea3cp-46},
    {0x1.9420ap-1, 0x1.e48b93d1a4p-3, -0x1.7c3b96c4c0903p-44},
    {0x1.91a6ap-1, 0x1.f12263bc04p-3, -0x1.f3133a9ae365ep-46},
    {0x1.8f344p-1, 0x1.fda604096ep-3, 0x1.90964912357ffp-47},
    {0x1.8cc98p-1, 0x1.050afd7abcp-2, 0x1.c35fea8906e2p-44},
    {0x1.8a664p-1, 0x1.0b3939e542p-2, -0x1.6fb5cf9a4ddefp-47},
    {0x1.880a4p-1, 0x1.115e21f444p-2, 0x1.aac83ad70ded3p-45},
    {0x1.85b56p-1, 0x1.1779cfbb34p-2, 0x1.6f0e9c91ed2cfp-44},
    {0x1.8367ap-1, 0x1.1d8c0a3429p-2, 0x1.ab1ba773a8596p-45},
    {0x1.8120ep-1, 0x1.2394eceda7p-2, 0x1.8c29660cac26bp-44},
    {0x1.7ee0ep-1, 0x1.2994ea8da8p-2, -0x1.48bd0fa7b443dp-45},
    {0x1.7ca78p-1, 0x1.2f8c2329dbp-2, -0x1.37160ec3d3e6cp-44},
    {0x1.7a74cp-1, 0x1.357a61ca82p-2, -0x1.1f14c243b5044p-45},
    {0x1.78488p-1, 0x1.3b5fc817dep-2, -0x1.ecbb5d422a3d6p-46},
    {0x1.7622ap-1, 0x1.413c79478cp-2, -0x1.9f8f0d9407f45p-44},
    {0x1.7402ep-1, 0x1.4710f23472p-2, -0x1.b57b9277ef677p-45},
    {0x1.71e96p-1, 0x1.4cdca98bf9p-2, -0x1.92bf868523b1ep-44},
    {0x1.6fd5ep-1, 0x1.52a01ed08p-2, -0x1.c2fdfa84060c2p-44},
    {0x1.6dc84p-1, 0x1.585b7b866dp-2, -0x1.dd78bc47c1cap-45},
    {0x1.6bc08p-1, 0x1.5e0e90b683p-2, -0x1.b7ef236b4581fp-44},
};
constexpr double kLn2Hi = 0x1.62e42fefa38p-1;
constexpr double kLn2Lo = 0x1.ef35793c7673p-45;

/// Logarithm of a positive number that is a normal one or a subnormal one times 2^52, with
/// `exponent` added to its exponent; but for some 2^-66 of it.
Sum log_of(double x, int64_t exponent) {
  const uint64_t bits = bits_of(x);
  const uint64_t above = bits - kMinBits;
  const double significand = from_bits(bits - (above & (uint64_t{0xfff} << 52)));
  const Logarithm& at = kLogarithms[(above >> 45) & 127];
  const auto power = static_cast<double>((static_cast<int64_t>(above) >> 52) + exponent);

  // significand = (1 + r) / reciprocal, |r| < 2^-7.5; both products are exact.
  const double upper = from_bits(bits_of(significand) & ~uint64_t{0x1fffff});
  const Sum r = quick_two_sum(upper * at.reciprocal - 1.0, (significand - upper) * at.reciprocal);
  // log(1 + r) = r - r^2/2 + r^3/3 - ...
  const double r_hi = upper_half(r.hi);
  const double r_lo = r.hi - r_hi;
  const Sum linear = two_sum(power * kLn2Hi + at.hi, r.hi);
  const Sum quadratic = quick_two_sum(linear.hi, -0.5 * r_hi * r_hi);
  constexpr double kSeries[] = {1.0 / 3, -1.0 / 4, 1.0 / 5, -1.0 / 6, 1.0 / 7, -1.0 / 8, 1.0 / 9};
  const double rest = (power * kLn2Lo + at.lo) + (linear.lo + quadratic.lo) +
                      (r.lo - 0.5 * r_lo * (r.hi + r_hi)) - r.hi * r.lo +
                      r.hi * r.hi * r.hi * polynomial(kSeries, r.hi);
  return quick_two_sum(quadratic.hi, rest);
}
/// The same of any positive number.
Sum log_of(double x) {
  return x < 0x1p-1022 ? log_of(x * 0x1p52, -52) : log_of(x, 0);
}

// ---- angles ------------------------------------------------------------------------------------

constexpr double kTwoOverPi = 0x1.45f306dc9c883p-1;
// Pi / 2 in parts of 33 digits, whose products with numbers below 2^20 are exact.
constexpr double kHalfPi1 = 0x1.921fb544p+0;
constexpr double kHalfPi2 = 0x1.0b4611a6p-34;
constexpr double kHalfPi3 = 0x1.3198a2ep-69;
constexpr double kHalfPi4 = 0x1.b839a252049c1p-104;
constexpr Sum kHalfPi = {0x1.921fb54442d18p+0, 0x1.1a62633145c07p-54};
constexpr Sum kPi = {0x1.921fb54442d18p+1, 0x1.1a62633145c07p-53};
// Digits of 2 / pi behind the point.
constexpr uint64_t kTwoOverPiBits[20] = {
    0xa2f9836e4e441529U, 0xfc2757d1f534ddc0U, 0xdb6295993c439041U, 0xfe5163abdebbc561U,
    0xb7246e3a424dd2e0U, 0x06492eea09d1921cU, 0xfe1deb1cb129a73eU, 0xe88235f52ebb4484U,
    0xe99c7026b45f7e41U, 0x3991d639835339f4U, 0x9c845f8bbdf9283bU, 0x1ff897ffde05980fU,
    0xef2f118b5a0a6d1fU, 0x6d367ecf27cb09b7U, 0x4f463f669e5fea2dU, 0x7527bac7ebe5f17bU,
    0x3d0739f78a5292eaU, 0x6bfb5fb11f8d5d08U, 0x56033046fc7b6babU, 0xf0cfbc209af4361dU,
};

/// An angle less whole quarter turns, within an eighth of a turn, and the last two bits of their
/// number.
struct Reduced {
  Sum angle;
  unsigned quarters;
};

uint64_t product_hi(uint64_t a, uint64_t b) {
  const uint64_t a_hi = a >> 32, a_lo = a & 0xffffffff, b_hi = b >> 32, b_lo = b & 0xffffffff;
  const uint64_t middle = a_hi * b_lo + ((a_lo * b_lo) >> 32);
  return a_hi * b_hi + (middle >> 32) + ((a_lo * b_hi + (middle & 0xffffffff)) >> 32);
}

/// Payne and Hanek: of the product with 2 / pi only the digits that matter, the last two before the
/// point and 126 behind it.
Reduced reduce_large(double x) {
  const uint64_t bits = bits_of(x);
  const uint64_t significand = (bits & 0xfffffffffffff) | (uint64_t{1} << 52);
  // x = significand * 2^exponent. Digits of 2 / pi before `first` give whole turns.
  const int exponent = static_cast<int>((bits >> 52) & 0x7ff) - 1075;
  const int first = exponent - 2 < 0 ? 0 : exponent - 2;
  const auto word = [first](int i) {
    const int shift = first % 64;
    const uint64_t* at = kTwoOverPiBits + first / 64 + i;
    return shift == 0 ? at[0] : (at[0] << shift) | (at[1] >> (64 - shift));
  };
  // The product of three words with the significand, without its uppermost word.
  uint64_t digits[3];
  const uint64_t w0 = word(0), w1 = word(1), w2 = word(2);
  digits[2] = w2 * significand;
  const uint64_t carry2 = product_hi(w2, significand);
  digits[1] = w1 * significand + carry2;
  const uint64_t carry1 = product_hi(w1, significand) + (digits[1] < carry2 ? 1 : 0);
  digits[0] = w0 * significand + carry1;
  // It begins with the last two digits before the point, or, where the exponent is below 2,
  // `missing` digits further down: those stand at the end of the uppermost word.
  const int missing = 2 - (exponent - first);
  uint64_t hi = digits[0], lo = digits[1], last = digits[2];
  if (missing > 0) {
    const uint64_t above = product_hi(w0, significand) + (digits[0] < carry1 ? 1 : 0);
    last = (last >> missing) | (lo << (64 - missing));
    lo = (lo >> missing) | (hi << (64 - missing));
    hi = (hi >> missing) | (above << (64 - missing));
  }
  auto quarters = static_cast<unsigned>(hi >> 62);
  hi = (hi << 2) | (lo >> 62);
  lo = (lo << 2) | (last >> 62);
  last <<= 2;
  const bool negative = (bits & kSignBit) != 0;
  const bool up = (hi >> 63) != 0;  // to the next quarter
  if (up) {
    ++quarters;
    hi = ~hi;
    lo = ~lo;
    last = ~last;
  }
  // hi, lo, last are a fraction of a quarter turn; its first digit may stand far down.
  int shift = 0;
  while (shift < 64 && (hi >> 63) == 0) {
    hi = (hi << 1) | (lo >> 63);
    lo = (lo << 1) | (last >> 63);
    last <<= 1;
    ++shift;
  }
  const double unit = power_of_two(-64 - shift);
  const Sum fraction =
      quick_two_sum(static_cast<double>(hi & ~uint64_t{0x7ff}) * unit,
                    (static_cast<double>(hi & 0x7ff) + static_cast<double>(lo) * 0x1p-64) * unit);
  Sum angle = two_product(fraction.hi, kHalfPi.hi);
  angle = quick_two_sum(angle.hi, angle.lo + (fraction.hi * kHalfPi.lo + fraction.lo * kHalfPi.hi));
  if (up != negative) angle = -angle;
  return {angle, (negative ? 0U - quarters : quarters) & 3U};
}

/// Of a finite angle.
Reduced reduce(double x) {
  const double size = std::abs(x);
  if (size <= 0x1.921fb54442d18p-1) return {{x, 0.0}, 0};
  if (size >= 0x1p20) return reduce_large(x);
  const double quarters = (x * kTwoOverPi + kToWhole) - kToWhole;
  const Sum first = two_sum(x - quarters * kHalfPi1, -(quarters * kHalfPi2));
  const Sum second = two_sum(first.hi, -(quarters * kHalfPi3));
  return {quick_two_sum(second.hi, (first.lo + second.lo) - quarters * kHalfPi4),
          static_cast<unsigned>(static_cast<int64_t>(quarters)) & 3U};
}

constexpr double kSine[] = {-0x1.5555555555549p-3, 0x1.111111110f87ap-7,   -0x1.a01a019c11996p-13,
                            0x1.71de3577b69cp-19,  -0x1.ae5e663a8ea59p-26, 0x1.5d9300fb26d44p-33};
constexpr double kCosine[] = {0x1.5555555555552p-5,  -0x1.6c16c16c15fc8p-10,
                              0x1.a01a019e15593p-16, -0x1.27e4f9082c7d7p-22,
                              0x1.1eea96507b9dcp-29, -0x1.90056c4af2aa3p-37};

/// Of an angle within an eighth of a turn.
Sum sine_of(const Sum& angle) {
  const double square = angle.hi * angle.hi;
  return quick_two_sum(
      angle.hi, angle.hi * square * polynomial(kSine, square) + angle.lo * (1.0 - 0.5 * square));
}
Sum cosine_of(const Sum& angle) {
  const double square = angle.hi * angle.hi;
  const double half = 0.5 * square;
  const Sum begin = quick_two_sum(1.0, -half);
  return quick_two_sum(
      begin.hi, begin.lo + (square * square * polynomial(kCosine, square) - angle.hi * angle.lo));
}
double sine_of(const Reduced& it, unsigned quarters) {
  const double value = (quarters & 1U) != 0 ? cosine_of(it.angle).hi : sine_of(it.angle).hi;
  return (quarters & 2U) != 0 ? -value : value;
}

/// Arctangents of sixteenths.
constexpr Sum kArctangents[17] = {
    {0x0p+0, 0x0p+0},
    {0x1.ff55bb72cfdeap-5, -0x1.c934d86d23f1dp-60},
    {0x1.fd5ba9aac2f6ep-4, -0x1.cd37686760c17p-59},
    {0x1.7b97b4bce5b02p-3, 0x1.347b0b4f881cap-58},
    {0x1.f5b75f92c80ddp-3, 0x1.8ab6e3cf7afbdp-57},
    {0x1.362773707ebccp-2, -0x1.963a544b672d8p-57},
    {0x1.6f61941e4def1p-2, -0x1.c63aae6f6e918p-56},
    {0x1.a64eec3cc23fdp-2, -0x1.24dec1b50b7ffp-56},
    {0x1.dac670561bb4fp-2, 0x1.a2b7f222f65e2p-56},
    {0x1.0657e94db30dp-1, -0x1.d5b495f6349e6p-56},
    {0x1.1e00babdefeb4p-1, -0x1.928df287a668fp-58},
    {0x1.345f01cce37bbp-1, 0x1.1021137c71102p-55},
    {0x1.4978fa3269ee1p-1, 0x1.2419a87f2a458p-56},
    {0x1.5d58987169b18p-1, 0x1.0028e4bc5e7cap-57},
    {0x1.700a7c5784634p-1, -0x1.8c34d25aadef6p-56},
    {0x1.819d0b7158a4dp-1, -0x1.bf76229d3b917p-56},
    {0x1.921fb54442d18p-1, 0x1.1a62633145c07p-55},
};
// Up to 3/32, and up to 1/32.
constexpr double kArctangent[] = {-0x1.5555555555551p-2, 0x1.9999999994c2dp-3,
                                  -0x1.24924916a4d3ep-3, 0x1.c71c4ce686837p-4,
                                  -0x1.744461ee06cccp-4, 0x1.32e94cb58681p-4};
constexpr double kArctangentNear[] = {-0x1.55555555554bep-2, 0x1.99999996fb069p-3,
                                      -0x1.24922c5e4812ep-3, 0x1.c6233d3e453dp-4};

/// Arctangent of one from 0 to 1.
Sum arctangent_of(const Sum& x) {
  const double sixteenths = (x.hi * 16.0 + kToWhole) - kToWhole;
  const auto at = static_cast<int>(sixteenths);
  if (at <= 1) {
    const double square = x.hi * x.hi;
    return quick_two_sum(x.hi,
                         x.hi * square * polynomial(kArctangent, square) + x.lo * (1.0 - square));
  }
  // atan x = atan c + atan((x - c) / (1 + x c))
  const double middle = sixteenths * 0.0625;
  const double t = ((x.hi - middle) + x.lo) / (1.0 + x.hi * middle);
  const double square = t * t;
  const Sum sum = quick_two_sum(kArctangents[at].hi, t);
  return quick_two_sum(
      sum.hi, sum.lo + (kArctangents[at].lo + t * square * polynomial(kArctangentNear, square)));
}

/// The angle at which (x, y) lies, both not negative and not both 0.
Sum angle_of(const Sum& y, const Sum& x) {
  if (y.hi > x.hi) return kHalfPi + -arctangent_of(x / y);
  return arctangent_of(y / x);
}
/// sqrt(1 - x^2), |x| <= 1.
Sum other_leg(double x) {
  const Sum square = two_product(x, x);
  const Sum rest = quick_two_sum(1.0, -square.hi);
  return square_root(quick_two_sum(rest.hi, rest.lo - square.lo));
}

bool is_whole(double x) {
  return std::trunc(x) == x;
}
bool is_odd(double x) {
  return is_whole(x) && !is_whole(0.5 * x);
}

constexpr double kTanh[] = {-0x1.55555555554f6p-2, 0x1.11111110fdee5p-3,  -0x1.ba1ba190b2fp-5,
                            0x1.664f333fa9fa8p-6,  -0x1.22685bddfc5f6p-7, 0x1.d50d37e67ce5ap-9,
                            -0x1.5985a058609dbp-10};

}  // namespace

double exp(double x) {
  if (!(std::abs(x) < 1000.0)) return std::isnan(x) ? x : x > 0.0 ? kInfinity : 0.0;
  return rounded(exponential(x, 0.0));
}

double log(double x) {
  if (!(x > 0.0)) return x == 0.0 ? -kInfinity : std::isnan(x) ? x : kNan;
  if (x == kInfinity) return x;
  return log_of(x).hi;
}

double pow(double base, double exponent) {
  if (exponent == 0.0 || base == 1.0) return 1.0;
  if (std::isnan(base) || std::isnan(exponent)) return kNan;
  double sign = 1.0;
  double size = base;
  if (std::signbit(base)) {
    size = -base;
    if (is_odd(exponent)) sign = -1.0;
  }
  if (std::isinf(exponent)) {
    if (size == 1.0) return 1.0;
    return (size > 1.0) == (exponent > 0.0) ? kInfinity : 0.0;
  }
  if (size == 0.0 || size == kInfinity)
    return sign * ((size == 0.0) == (exponent > 0.0) ? 0.0 : kInfinity);
  if (size != base && !is_whole(exponent)) return kNan;
  const Sum logarithm = log_of(size);
  const double rough = exponent * logarithm.hi;
  if (!(std::abs(rough) < 1000.0)) return sign * (rough > 0.0 ? kInfinity : 0.0);
  // An exponent whose product is so small gives 1, rounded; its halves would not be exact.
  if (std::abs(rough) < 0x1p-65) return sign * (1.0 + rough);
  const Sum product = two_product(exponent, logarithm.hi);
  return sign * rounded(exponential(product.hi, product.lo + exponent * logarithm.lo));
}

double sin(double x) {
  if (!std::isfinite(x)) return kNan;
  if (std::abs(x) < 0x1p-27) return x;
  const Reduced it = reduce(x);
  return sine_of(it, it.quarters);
}

double cos(double x) {
  if (!std::isfinite(x)) return kNan;
  const Reduced it = reduce(x);
  return sine_of(it, it.quarters + 1);
}

SineCosine sine_cosine(double x) {
  if (!std::isfinite(x)) return {kNan, kNan};
  if (std::abs(x) < 0x1p-27) return {x, 1.0};
  const Reduced it = reduce(x);
  return {sine_of(it, it.quarters), sine_of(it, it.quarters + 1)};
}

double tan(double x) {
  if (!std::isfinite(x)) return kNan;
  if (std::abs(x) < 0x1p-27) return x;
  const Reduced it = reduce(x);
  const Sum sine = sine_of(it.angle);
  const Sum cosine = cosine_of(it.angle);
  return (it.quarters & 1U) != 0 ? (-cosine / sine).hi : (sine / cosine).hi;
}

double asin(double x) {
  const double size = std::abs(x);
  if (!(size <= 1.0)) return kNan;
  if (size < 0x1p-27) return x;
  return std::copysign(angle_of({size, 0.0}, other_leg(x)).hi, x);
}

double acos(double x) {
  const double size = std::abs(x);
  if (!(size <= 1.0)) return kNan;
  if (size < 0x1p-60) return kHalfPi.hi;
  const Sum angle = angle_of(other_leg(x), {size, 0.0});
  return x < 0.0 ? (kPi + -angle).hi : angle.hi;
}

double atan(double x) {
  return atan2(x, 1.0);
}

double atan2(double y, double x) {
  if (std::isnan(x) || std::isnan(y)) return kNan;
  const double up = std::abs(y);
  const double ahead = std::abs(x);
  Sum angle{};
  if (up == 0.0 || ahead == kInfinity) {
    angle = {up == kInfinity ? 0.5 * kHalfPi.hi : 0.0, 0.0};
  } else if (ahead == 0.0 || up == kInfinity) {
    angle = kHalfPi;
  } else {
    // Where the larger is so large or so small that halves of products would leave the range.
    const double larger = up > ahead ? up : ahead;
    const double scale = larger > 0x1p900 ? 0x1p-200 : larger < 0x1p-700 ? 0x1p200 : 1.0;
    const double scaled_up = up * scale, scaled_ahead = ahead * scale;
    const double smaller = up > ahead ? scaled_ahead : scaled_up;
    if (smaller < larger * scale * 0x1p-100) {
      angle = up > ahead ? kHalfPi : Sum{up / ahead, 0.0};
    } else {
      angle = angle_of({scaled_up, 0.0}, {scaled_ahead, 0.0});
    }
  }
  if (std::signbit(x)) angle = kPi + -angle;
  return std::copysign(angle.hi, y);
}

double tanh(double x) {
  if (std::isnan(x)) return x;
  const double size = std::abs(x);
  if (size < 0x1p-27) return x;
  double value = 1.0;
  if (size < 0.25) {
    const double square = size * size;
    value = size + size * square * polynomial(kTanh, square);
  } else if (size < 22.0) {
    // (e^2x - 1) / (e^2x + 1)
    const Exponential it = exponential(2.0 * size, 0.0);
    const double scale = it.value * power_of_two(it.exponent);
    const Sum power = quick_two_sum(scale, scale * it.less_one);
    value = ((power + Sum{-1.0, 0.0}) / (power + Sum{1.0, 0.0})).hi;
  }
  return std::copysign(value, x);
}

double hypot(double x, double y) {
  const double a = std::abs(x);
  const double b = std::abs(y);
  if (a == kInfinity || b == kInfinity) return kInfinity;
  if (std::isnan(a) || std::isnan(b)) return kNan;
  const double larger = a > b ? a : b;
  const double smaller = a > b ? b : a;
  const double scale = larger > 0x1p500 ? 0x1p-600 : larger < 0x1p-400 ? 0x1p600 : 1.0;
  const double p = larger * scale;
  const double q = smaller * scale;
  if (q <= p * 0x1p-54) return larger;
  return square_root(two_product(p, p) + two_product(q, q)).hi / scale;
}

}  // namespace screed::portable
