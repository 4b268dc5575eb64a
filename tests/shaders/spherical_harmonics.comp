#version 460
#extension GL_GOOGLE_include_directive : require
// Spherical harmonics at given directions and rotations, for comparison with double precision on the host.
#include "shaders/shared/spherical_harmonics.h"
layout(local_size_x = 64) in;

struct Question {
  int order;  // read, so that no compiler unrolls all loops
  vec3 direction;
  mat3 rotation;
  float c[kShMaxCoefficients];
};
struct Answer {
  float basis[kShMaxCoefficients];
  float turned[kShMaxCoefficients];
  float value;
  float clampedCosine[kShMaxOrder + 1];
  float hann[kShMaxOrder + 1];
  float lanczos[kShMaxOrder + 1];
};
layout(scalar) readonly buffer questions_block { Question questions[]; };
layout(scalar) writeonly buffer answers_block { Answer answers[]; };

void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i >= questions.length()) return;
  ShCoefficients f;
  for (int k = 0; k < kShMaxCoefficients; ++k) f.c[k] = questions[i].c[k];
  const ShCoefficients y = shBasis(questions[i].order, questions[i].direction);
  const ShCoefficients g = shRotate(questions[i].order, f, questions[i].rotation);
  for (int k = 0; k < kShMaxCoefficients; ++k) {
    answers[i].basis[k] = y.c[k];
    answers[i].turned[k] = g.c[k];
  }
  answers[i].value = shEvaluate(questions[i].order, f, questions[i].direction);
  for (int l = 0; l <= kShMaxOrder; ++l) {
    answers[i].clampedCosine[l] = shClampedCosine(l);
    answers[i].hann[l] = shWindow(kShWindowHann, l, kShMaxOrder);
    answers[i].lanczos[l] = shWindow(kShWindowLanczos, l, kShMaxOrder);
  }
}
