#ifndef HALFLIGHT_HEMISPHERE_BASIS_H
#define HALFLIGHT_HEMISPHERE_BASIS_H
// Radiance over a hemisphere as polynomials, for shaders and host. A direction (x, y, z) about the normal is the point (x, y) of the unit disc: a function that is even in z is one
// of x and y alone, and spherical harmonics up to band n with l + m even span the polynomials of degree n in them. So radiance is thought to go on below the surface as its mirror
// image, there is no jump at the horizon, and (n + 1)(n + 2) / 2 numbers hold what (n + 1)^2 would.
//
// Which of these polynomials are orthonormal is a choice: here those for the weight sqrt(z) per solid angle, which is (1 - r^2)^(-1/4) on the disc. With r^|m| P_k^(-1/4, |m|)(2 r^2 - 1)
// for n = |m| + 2k (Jacobi; -1/2 would be spherical harmonics, 0 Zernike's polynomials),
//   Z_nm = N_mk r^|m| P_k cos(m phi), and sin(|m| phi) for m < 0,
// at index (n (n + 2) + m) / 2, so that fewer degrees are the beginning of more.
#include "shaders/shared/interop.h"
HL_BEGIN

HL_CONST int kHemisphereMaxDegree = 8;
HL_CONST int kHemisphereMaxTerms = 45;
/// Power of 1 - r^2 in the weight.
HL_CONST float kHemispherePower = -0.25f;

HL_INLINE int hemisphereTerms(int degree) { return (degree + 1) * (degree + 2) / 2; }
HL_INLINE int hemisphereIndex(int degree, int m) { return (degree * (degree + 2) + m) / 2; }

/// Functions of one |m|, from n = |m| upwards by twos, without their norms.
struct HemisphereColumn {
  int m;            ///< |m|
  int k;
  float s;          ///< 2 r^2 - 1
  float cosine;     ///< Re (x + iy)^m
  float sine;       ///< Im (x + iy)^m
  float previous;   ///< P_(k-1)
  float current;    ///< P_k
};

/// The column of m = 0 at the point (x, y) of the unit disc.
HL_INLINE HemisphereColumn hemisphereBegin(float x, float y) {
  HemisphereColumn c;
  c.m = 0;
  c.k = 0;
  c.s = 2.0f * (x * x + y * y) - 1.0f;
  c.cosine = 1.0f;
  c.sine = 0.0f;
  c.previous = 0.0f;
  c.current = 1.0f;
  return c;
}
/// The column of m + 1, at the same point.
HL_INLINE void hemisphereNextColumn(HL_INOUT(HemisphereColumn) c, float x, float y) {
  float cosine = c.cosine * x - c.sine * y;
  c.sine = c.sine * x + c.cosine * y;
  c.cosine = cosine;
  c.m += 1;
  c.k = 0;
  c.previous = 0.0f;
  c.current = 1.0f;
}
/// From P_k to P_(k+1).
HL_INLINE void hemisphereNextDegree(HL_INOUT(HemisphereColumn) c) {
  float a = kHemispherePower;
  float b = float(c.m);
  float next = a + 1.0f + 0.5f * (a + b + 2.0f) * (c.s - 1.0f);
  if (c.k > 0) {
    float k = float(c.k + 1);
    float t = 2.0f * k + a + b;
    next = ((t - 1.0f) * (t * (t - 2.0f) * c.s + a * a - b * b) * c.current - 2.0f * (k + a - 1.0f) * (k + b - 1.0f) * t * c.previous) / (2.0f * k * (k + a + b) * (t - 2.0f));
  }
  c.previous = c.current;
  c.current = next;
  c.k += 1;
}

/// N_mk.
HL_INLINE float hemisphereNorm(int m, int k) {
  float a = kHemispherePower;
  float g = 1.0f;  // Gamma(k + a + 1) Gamma(k + m + 1) / (k! Gamma(k + a + m + 1))
  for (int i = 1; i <= m; ++i) g *= float(i) / (float(i) + a);
  for (int i = 1; i <= k; ++i) g *= (float(i) + a) * float(i + m) / (float(i) * (float(i + m) + a));
  return sqrt((m > 0 ? 2.0f : 1.0f) * (float(2 * k + m) + a + 1.0f) / (3.14159265358979323846f * g));
}

/// One of the functions.
struct HemisphereTerm {
  int m;       ///< negative: sine
  int k;
  float norm;
};
HL_INLINE HemisphereTerm hemisphereTerm(int index) {
  HemisphereTerm t;
  int degree = 0;
  while (hemisphereTerms(degree) <= index) ++degree;
  t.m = 2 * index - degree * (degree + 2);
  int column = t.m < 0 ? -t.m : t.m;
  t.k = (degree - column) / 2;
  t.norm = hemisphereNorm(column, t.k);
  return t;
}
/// Z at the point (x, y) of the unit disc.
HL_INLINE float hemisphereValue(HemisphereTerm t, float x, float y) {
  HemisphereColumn c = hemisphereBegin(x, y);
  int column = t.m < 0 ? -t.m : t.m;
  for (int i = 0; i < column; ++i) hemisphereNextColumn(c, x, y);
  for (int i = 0; i < t.k; ++i) hemisphereNextDegree(c);
  return t.norm * c.current * (t.m < 0 ? c.sine : c.cosine);
}
/// What a cosine distributed sample's radiance counts in coefficient t = integral of L Z sqrt(z) over solid angle, over what it counts in irradiance. `z`: its height; as that at
/// least `least`, so that no sample along the horizon decides.
HL_INLINE float hemisphereFactor(HemisphereTerm t, float x, float y, float z, float least) { return hemisphereValue(t, x, y) * inversesqrt(max(z, least)); }
/// Mean of hemisphereFactor over cosine distributed samples: 0 but for the constant function.
HL_INLINE float hemisphereMeanFactor(int index) { return index == 0 ? 1.0f / (3.14159265358979323846f * hemisphereNorm(0, 0)) : 0.0f; }

HL_END
#endif
