#pragma once
// The tracers behind makeTracer, one file each.
#include <memory>
#include <string>

#include "engine/trace/tracer.h"

namespace hl {

std::unique_ptr<Tracer> makeEmbreeTracer(std::shared_ptr<EmbreeScene>, TaskPool&);
std::unique_ptr<Tracer> makeBvhTracer(Device&, const Scene&, const GpuScene&, TaskPool&, Progress*);

/// @throws Error(Device) where the device has no ray tracing pipelines.
std::unique_ptr<Tracer> makePipelineTracer(Device&, const Scene&, const GpuScene&);

/// @throws Error(BadInput) naming the pass, where a buffer is too small for the batch.
void checkBatch(const std::string& pass, const Buffer& rays, const Buffer& out, uint32_t count, Query);

}  // namespace hl
