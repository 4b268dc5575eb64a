#ifndef HALFLIGHT_PREFIX_GROUP_GLSL
#define HALFLIGHT_PREFIX_GROUP_GLSL
// Exclusive prefix sum of one value an invocation over a work group of 256, in shared memory: no assumption on subgroups.
#extension GL_EXT_scalar_block_layout : require
layout(local_size_x = 256) in;

const uint kGroup = 256u;
const uint kEach = 4u;  ///< values an invocation: PrefixSum::kChunk / kGroup

shared uint sharedSums[2u * kGroup];

/// Returns the sum of the invocations before this one; `total` of all. Every invocation of the group must come here.
uint groupPrefix(uint value, out uint total) {
  const uint i = gl_LocalInvocationIndex;
  uint from = 0u;
  sharedSums[i] = value;
  barrier();
  for (uint reach = 1u; reach < kGroup; reach *= 2u) {
    uint sum = sharedSums[from + i];
    if (i >= reach) sum += sharedSums[from + i - reach];
    from = kGroup - from;
    sharedSums[from + i] = sum;
    barrier();
  }
  const uint inclusive = sharedSums[from + i];
  total = sharedSums[from + kGroup - 1u];
  barrier();
  return inclusive - value;
}
#endif
