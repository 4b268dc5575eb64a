#pragma once
// How fast a device moves memory and a tracer traces, measured the way passes use them. Once warm: compiled, and a GPU's clocks up; the median of some runs.
#include "engine/core/progress.h"
#include "engine/gpu/frame_graph.h"
#include "engine/trace/tracer.h"

namespace hl {

/// [GB/s] copied, buffer to buffer by a compute shader, of more than caches hold: every byte is read once and written once. @throws Error(Cancelled)
double copyRate(Device&, ShaderLibrary&, Progress&);
/// [1e6 rays/s] of a batch: `out` as Tracer::record() wants it. By the passes' own times: submission and waiting are no part of a tracer's rate. @throws Error(Cancelled)
double traceRate(const Device&, FrameGraph&, Tracer&, const Buffer& rays, const Buffer& out, uint32_t count, Query, Progress&);

}  // namespace hl
