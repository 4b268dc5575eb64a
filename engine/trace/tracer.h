#pragma once
// One interface to cast a batch of rays from device buffers, whatever does the casting (DESIGN.md section 6).
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "engine/core/task_pool.h"
#include "engine/gpu/frame_graph.h"
#include "engine/scene/gpu_scene.h"
#include "engine/scene/scene.h"
#include "engine/trace/embree_scene.h"
#include "engine/trace/ray_packet.h"

namespace hl {

enum class Query { Closest, Any };

class Tracer {
 public:
  virtual ~Tracer() = default;
  virtual const char* id() const = 0;  ///< "embree", "bvh", "pipeline"
  /// Adds the pass `name` to the graph. rays: `count` shared::Ray. Closest: `out` holds `count` shared::Hit. Any: `out` holds `count` uints, 1 where
  /// something lies between tMin and tMax, else 0. Alpha-tested surfaces count only where they are opaque.
  virtual void record(FrameGraph&, const std::string& name, const Buffer& rays, const Buffer& out, uint32_t count, Query) = 0;
  /// Vertices of moving objects are elsewhere now, in the Scene that this was made of and in its GpuScene: brings the tracer's structures up to them, as
  /// passes. Costs by what moves, not by what there is; nothing where nothing can move.
  virtual void recordUpdate(FrameGraph&) {}
  /// Whether rays are cast on the host. Then a host pass may cast its own by closest(), and spare the buffers.
  virtual bool onHost() const { return false; }
  /// Closest hits of the packet's first `count` rays, at once. Thread-safe. @throws Error(Run) where rays are not cast on the host
  virtual void closest(RayPacket&, size_t count) const;
  virtual std::vector<std::pair<std::string, uint64_t>> memory() const { return {}; }
};

struct TracerListing {
  std::string id;
  bool available = false;
  std::string reason;  ///< why not
};
std::vector<TracerListing> listTracers(const Device&);

/// What the rule for "auto" looks at.
struct TracerFeatures {
  bool cpu = false;           ///< the device is a processor
  bool rayPipelines = false;  ///< VK_KHR_ray_tracing_pipeline
  bool rayQueries = false;    ///< VK_KHR_ray_query: nothing here uses them, but drivers leave them out where a device has no units of its own for rays
};
TracerFeatures tracerFeatures(const Device&);
/// Fixed, so that the same device always traces alike: embree on a processor; pipeline where the device reports pipelines and queries; else bvh. README.md says why.
const char* automaticTracer(const TracerFeatures&);

/// `id` "auto": automaticTracer(). `embree` may be shared with the reference.
/// The tracer keeps handles of the GpuScene; the Scene has to outlive it where objects move. @throws Error(BadInput) for an unknown or unavailable id, with those that are.
std::unique_ptr<Tracer> makeTracer(const std::string& id, Device&, ShaderLibrary&, const Scene&, const GpuScene&, std::shared_ptr<EmbreeScene> embree,
                                   TaskPool&, Progress* = nullptr);

}  // namespace hl
