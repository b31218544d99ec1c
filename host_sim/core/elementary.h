// Elementary functions whose bits no processor, compiler or C library changes: made of IEEE
// additions, multiplications, divisions and square roots alone, in one order. For what a run's
// bytes depend on.
//
// Special values as in C (annex F), without errno and floating-point exceptions. The greatest
// error found is below one unit in the last place, of tan() 1.03; docs/determinism.md has each.
#pragma once

namespace screed::portable {

double exp(double x);
double log(double x);
double pow(double base, double exponent);

/// Angles in rad, of any size.
double sin(double x);
double cos(double x);
double tan(double x);
struct SineCosine {
  double sine;
  double cosine;
};
/// The same bits as sin() and cos(), for little more than one of them.
SineCosine sine_cosine(double x);

/// rad
double asin(double x);
double acos(double x);
double atan(double x);
double atan2(double y, double x);

double tanh(double x);
double hypot(double x, double y);

}  // namespace screed::portable
