// Numbers of a page of matrices, in single or half precision.
layout(constant_id = 0) const bool kHalf = false;
layout(scalar) readonly buffer page_block { uint page[]; };

float entry(uint i) {
  if (!kHalf) return uintBitsToFloat(page[i]);
  vec2 two = unpackHalf2x16(page[i >> 1u]);
  return (i & 1u) == 0u ? two.x : two.y;
}
