// The one definition of spherical harmonics: spherical_harmonics.h includes it in single precision for shaders and host, engine/core/spherical_harmonics64.h
// in double. No guard: it is included once for each SH_REAL. SH_VEC3 and SH_MAT3 are the vector types of it.
//
// Real, orthonormal, no Condon-Shortley phase, (l, m) at l^2 + l + m. `order` is the highest l, 0 to kShMaxOrder. Directions are unit vectors; +Z is the axis.
// With q_lm the normalised associated Legendre function without its factor sin^|m|,
//   Y_l0 = q_l0(z),  Y_l,m = sqrt(2) q_lm(z) Re (x + iy)^m,  Y_l,-m = sqrt(2) q_lm(z) Im (x + iy)^m,
// by the recurrences of Sloan, "Efficient Spherical Harmonic Evaluation" (JCGT 2(2), 2013): polynomials all, so the poles are points like any other.

/// Steps through (l, m), m = 0 to order, for each l = m to order, without memory: a shader adds up as many coefficients as it likes.
struct ShWalk {
  SH_VEC3 direction;
  int order;
  int l;
  int m;
  SH_REAL cosine;    ///< sqrt(2) Re (x + iy)^m; 1 at m = 0
  SH_REAL sine;      ///< sqrt(2) Im (x + iy)^m; 0 at m = 0
  SH_REAL diagonal;  ///< q_mm
  SH_REAL previous;  ///< q_(l-1)m
  SH_REAL current;   ///< q_lm
};

HL_INLINE ShWalk shBegin(int order, SH_VEC3 direction) {
  ShWalk w;
  w.direction = direction;
  w.order = order;
  w.l = 0;
  w.m = 0;
  w.cosine = SH_REAL(1);
  w.sine = SH_REAL(0);
  w.diagonal = SH_REAL(0.28209479177387814347);  // sqrt(1 / (4 pi))
  w.previous = SH_REAL(0);
  w.current = w.diagonal;
  return w;
}
HL_INLINE bool shDone(ShWalk w) { return w.m > w.order; }
HL_INLINE SH_REAL shValue(ShWalk w) { return w.current * w.cosine; }           ///< Y_l,m
HL_INLINE SH_REAL shMirroredValue(ShWalk w) { return w.current * w.sine; }     ///< Y_l,-m; asked for where m > 0
HL_INLINE void shNext(HL_INOUT(ShWalk) w) {
  if (w.l < w.order) {
    w.l += 1;
    SH_REAL ll = SH_REAL(w.l) * SH_REAL(w.l);
    SH_REAL mm = SH_REAL(w.m) * SH_REAL(w.m);
    SH_REAL below = SH_REAL(w.l - 1) * SH_REAL(w.l - 1);
    SH_REAL a = sqrt((SH_REAL(4) * ll - SH_REAL(1)) / (ll - mm));
    SH_REAL b = sqrt((below - mm) / (SH_REAL(4) * below - SH_REAL(1)));  // 0 at l = m + 1; below >= 1 but at l = 1, where both are 0 / -1
    SH_REAL next = a * (w.direction.z * w.current - b * w.previous);
    w.previous = w.current;
    w.current = next;
    return;
  }
  w.m += 1;
  w.l = w.m;
  SH_REAL step = w.m == 1 ? SH_REAL(1.41421356237309504880) : SH_REAL(1);
  SH_REAL re = w.cosine * w.direction.x - w.sine * w.direction.y;
  SH_REAL im = w.sine * w.direction.x + w.cosine * w.direction.y;
  w.cosine = step * re;
  w.sine = step * im;
  w.diagonal *= sqrt(SH_REAL(2 * w.m + 1) / SH_REAL(2 * w.m));
  w.previous = SH_REAL(0);
  w.current = w.diagonal;
}

/// All coefficients of one function, those above `order` undefined.
struct ShCoefficients {
  SH_REAL c[kShMaxCoefficients];
};

/// Y_lm(direction): evaluation is the dot product with it; projection of a function the mean over the sphere's directions of value * Y * 4 pi.
HL_INLINE ShCoefficients shBasis(int order, SH_VEC3 direction) {
  ShCoefficients y;
  for (ShWalk w = shBegin(order, direction); !shDone(w); shNext(w)) {
    y.c[shIndex(w.l, w.m)] = shValue(w);
    if (w.m > 0) y.c[shIndex(w.l, -w.m)] = shMirroredValue(w);
  }
  return y;
}

HL_INLINE SH_REAL shEvaluate(int order, ShCoefficients f, SH_VEC3 direction) {
  SH_REAL sum = SH_REAL(0);
  for (ShWalk w = shBegin(order, direction); !shDone(w); shNext(w)) {
    sum += shValue(w) * f.c[shIndex(w.l, w.m)];
    if (w.m > 0) sum += shMirroredValue(w) * f.c[shIndex(w.l, -w.m)];
  }
  return sum;
}

/// Coefficient of the clamped cosine, convolved: irradiance has A_l L_lm (Ramamoorthi and Hanrahan 2001, eq. 8, with sqrt(4 pi / (2l + 1)) taken in). pi, 2 pi / 3, pi / 4, 0, -pi / 24, 0, pi / 64 ...
HL_INLINE SH_REAL shClampedCosine(int l) {
  SH_REAL pi = SH_REAL(3.14159265358979323846);
  if (l == 1) return SH_REAL(2) * pi / SH_REAL(3);
  if (l % 2 == 1) return SH_REAL(0);
  // l! / (2^l ((l/2)!)^2) is the product of (2k - 1) / (2k); the sign alternates with l / 2.
  SH_REAL a = SH_REAL(2) * pi / (SH_REAL(l + 2) * SH_REAL(l - 1));
  for (int k = 1; k <= l / 2; ++k) a *= -SH_REAL(2 * k - 1) / SH_REAL(2 * k);
  return -a;
}

/// What a window (kShWindow...) leaves of band l where l <= order is kept; 1 at l = 0.
HL_INLINE SH_REAL shWindow(int window, int l, int order) {
  if (window == kShWindowNone || l == 0) return SH_REAL(1);
  SH_REAL x = SH_REAL(3.14159265358979323846) * SH_REAL(l) / SH_REAL(order + 1);
  if (window == kShWindowHann) return SH_REAL(0.5) * (SH_REAL(1) + cos(x));
  return sin(x) / x;
}

/// P of Ivanic and Ruedenberg (table 2): `one` is a row of band 1's matrix; of band l - 1's, entries of another row: in `column`, in column l - 1 and in column 1 - l.
HL_INLINE SH_REAL shRotationProduct(int l, int column, SH_VEC3 one, SH_REAL inColumn, SH_REAL inLast, SH_REAL inFirst) {
  if (column == l) return one.z * inLast - one.x * inFirst;
  if (column == -l) return one.z * inFirst + one.x * inLast;
  return one.y * inColumn;
}

/// The function turned with `rotation`: g(R d) = f(d). `rotation` is orthonormal with determinant 1. Band l's matrix comes from band 1's and band l - 1's
/// (Ivanic and Ruedenberg 1996, eq. 6.1 to 6.8 with the correction of 1998).
HL_INLINE ShCoefficients shRotate(int order, ShCoefficients f, SH_MAT3 rotation) {
  ShCoefficients g;
  g.c[0] = f.c[0];
  // Band 1 is (y, z, x). Rows of its matrix; a GLSL matrix is indexed by column first.
  SH_VEC3 one[3];
  for (int row = 0; row < 3; ++row) one[row] = SH_VEC3(rotation[1][(row + 1) % 3], rotation[2][(row + 1) % 3], rotation[0][(row + 1) % 3]);
  SH_REAL below[kShMaxBandEntries];
  SH_REAL band[kShMaxBandEntries];
  below[0] = SH_REAL(1);
  for (int l = 1; l <= order; ++l) {
    int width = 2 * l - 1;  // of band l - 1
// A macro, since a function would be handed copies of the arrays.
#define SH_PRODUCT(i, row) shRotationProduct(l, column, one[(i) + 1], below[((row) + l - 1) * width + inner], below[((row) + l) * width - 1], below[((row) + l - 1) * width])
    for (int row = -l; row <= l; ++row) {
      int n = row < 0 ? -row : row;
      SH_REAL d = row == 0 ? SH_REAL(1) : SH_REAL(0);
      SH_REAL root = n == 1 ? SH_REAL(1.41421356237309504880) : SH_REAL(1);
      SH_REAL turned = SH_REAL(0);
      for (int column = -l; column <= l; ++column) {
        int inner = (column < 1 - l ? 1 - l : column > l - 1 ? l - 1 : column) + l - 1;
        SH_REAL whole = column == l || column == -l ? SH_REAL(2 * l) * SH_REAL(2 * l - 1) : SH_REAL(l + column) * SH_REAL(l - column);
        SH_REAL u = sqrt(SH_REAL(l + row) * SH_REAL(l - row) / whole);
        SH_REAL v = SH_REAL(0.5) * sqrt((SH_REAL(1) + d) * SH_REAL(l + n - 1) * SH_REAL(l + n) / whole);
        SH_REAL w = SH_REAL(0.5) * sqrt(SH_REAL(l - n - 1) * SH_REAL(l - n) / whole);
        SH_REAL sum = SH_REAL(0);
        if (l == 1) sum = one[row + 1][column + 1];
        if (l > 1 && n < l) sum += u * SH_PRODUCT(0, row);
        if (l > 1 && row == 0) sum -= v * (SH_PRODUCT(1, 1) + SH_PRODUCT(-1, -1));
        if (l > 1 && row > 0) sum += v * root * SH_PRODUCT(1, row - 1);
        if (row > 1) sum -= v * SH_PRODUCT(-1, 1 - row);
        if (l > 1 && row < 0) sum += v * root * SH_PRODUCT(-1, -row - 1);
        if (row < -1) sum += v * SH_PRODUCT(1, row + 1);
        if (n + 1 < l && row > 0) sum -= w * (SH_PRODUCT(1, row + 1) + SH_PRODUCT(-1, -row - 1));
        if (n + 1 < l && row < 0) sum -= w * (SH_PRODUCT(1, row - 1) - SH_PRODUCT(-1, 1 - row));
        band[(row + l) * (2 * l + 1) + column + l] = sum;
        turned += sum * f.c[shIndex(l, column)];
      }
      g.c[shIndex(l, row)] = turned;
    }
#undef SH_PRODUCT
    for (int k = 0; k < (2 * l + 1) * (2 * l + 1); ++k) below[k] = band[k];
  }
  return g;
}
