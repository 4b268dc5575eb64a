#pragma once
// One batch of passes: recorded in order, run in order, with barriers derived from what each pass binds (DESIGN.md
// section 3).
//
//   graph.compute("surfels: trace", "surfels/shade_hits.comp")
//       .bind("surfels", buffer, Access::ReadWrite).push(constants).dispatch(groups);
//   graph.host("surfels: cast rays").read(rays).write(hits).run([&](HostAccess& memory) {
//     ... memory.span<Ray>(rays) ...
//   });
//
// A pass is its name: timer, debug label, and prefix of its errors. Bindings go by name: that of the variable or instance,
// of a block's sole member, or of the block; binding numbers in shaders mean nothing. A binding that the shader has and
// nobody bound, or that was bound and the shader has not, throws Error(BadInput) naming pass, shader and binding.
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "engine/gpu/device.h"
#include "engine/gpu/profiler.h"
#include "engine/gpu/shader_library.h"

namespace hl {

enum class Access { Read, Write, ReadWrite };

/// What a host pass sees: its declared buffers, mapped (or staged copies of them, where the device's memory is not
/// host-visible).
class HostAccess {
 public:
  virtual ~HostAccess() = default;
  template <class T>
  std::span<T> span(const Buffer& b) {
    return {static_cast<T*>(map(b)), static_cast<size_t>(b.size() / sizeof(T))};
  }

 protected:
  virtual void* map(const Buffer&) = 0;
};

class FrameGraph;

class ComputePass {
 public:
  ComputePass& bind(const char* name, const Buffer&, Access);
  ComputePass& bind(const char* name, const GpuImage&, Access);  ///< storage image
  ComputePass& sample(const char* name,
                      const GpuImage&);  ///< combined image sampler, linear, clamped (repeat for arrays)
  template <class T>
  ComputePass& uniform(const char* name, const T& block) {  ///< a small uniform block, copied now
    static_assert(std::is_trivially_copyable_v<T>);
    return uniformBytes(name, &block, sizeof block);
  }
  template <class T>
  ComputePass& push(const T& constants) {  ///< up to 128 bytes
    static_assert(std::is_trivially_copyable_v<T> && sizeof(T) <= 128);
    return pushBytes(&constants, sizeof constants);
  }
  ComputePass& specialize(const char* name, uint32_t value);  ///< by the constant's name; bools are 0 and 1
  /// Groups; or threads, rounded up to the shader's group size. More groups along x than the device takes in one go are
  /// dispatched in pieces: gl_WorkGroupID and gl_GlobalInvocationID go on counting, gl_NumWorkGroups is the piece's.
  void dispatch(uint32_t x, uint32_t y = 1, uint32_t z = 1);
  void dispatchThreads(uint32_t x, uint32_t y = 1, uint32_t z = 1);

 private:
  friend class FrameGraph;
  ComputePass& uniformBytes(const char* name, const void* data, size_t size);
  ComputePass& pushBytes(const void* data, size_t size);
  FrameGraph* graph_ = nullptr;
  size_t index_ = 0;
};

struct RasterTargets {
  std::vector<GpuImage> color;  ///< cleared to zero, in the fragment shader's order of locations
  GpuImage depth;               ///< D32F, reversed z, cleared to 0; compared with GREATER
};

class RasterPass {
 public:
  RasterPass& bind(const char* name, const Buffer&, Access);
  RasterPass& sample(const char* name, const GpuImage&);
  template <class T>
  RasterPass& push(const T& constants) {
    static_assert(std::is_trivially_copyable_v<T> && sizeof(T) <= 128);
    return pushBytes(&constants, sizeof constants);
  }
  RasterPass& specialize(const char* name, uint32_t value);
  /// Vertices are pulled from bound buffers by gl_VertexIndex; no culling.
  void draw(uint32_t vertices, uint32_t instances = 1);

 private:
  friend class FrameGraph;
  RasterPass& pushBytes(const void* data, size_t size);
  FrameGraph* graph_ = nullptr;
  size_t index_ = 0;
};

class HostPass {
 public:
  HostPass& read(const Buffer&);
  HostPass& write(const Buffer&);
  HostPass& readWrite(const Buffer&);
  void run(std::function<void(HostAccess&)>);

 private:
  friend class FrameGraph;
  FrameGraph* graph_ = nullptr;
  size_t index_ = 0;
};

/// Names of the shaders of a ray tracing pipeline.
struct RayShaders {
  std::string generation, miss;
  std::string closestHit, anyHit;  ///< or ""
};

class RayPass {
 public:
  RayPass& bind(const char* name, const Buffer&, Access);
  RayPass& bind(const char* name, const AccelerationStructure&);
  RayPass& sample(const char* name, const GpuImage&);
  template <class T>
  RayPass& push(const T& constants) {
    static_assert(std::is_trivially_copyable_v<T> && sizeof(T) <= 128);
    return pushBytes(&constants, sizeof constants);
  }
  RayPass& specialize(const char* name, uint32_t value);
  /// Runs the ray generation shader so many times. @throws Error(TooLarge) beyond what the device launches at once
  void launch(uint32_t width, uint32_t height = 1);

 private:
  friend class FrameGraph;
  RayPass& pushBytes(const void* data, size_t size);
  FrameGraph* graph_ = nullptr;
  size_t index_ = 0;
};

/// A barrier as the graph derived it; for the unit tests on its record.
struct BarrierRecord {
  std::string pass, resource, hazard;  ///< hazard: "RAW", "WAR", "WAW", "layout"
};

class FrameGraph {
 public:
  FrameGraph(Device&, ShaderLibrary&);
  ~FrameGraph();

  ComputePass compute(const std::string& name, const std::string& shader);
  RasterPass raster(const std::string& name, const std::string& vertexShader, const std::string& fragmentShader,
                    const RasterTargets&);
  /// @throws Error(Device) where the device has no ray tracing pipelines (Device::rayPipelines).
  RayPass rays(const std::string& name, const RayShaders&);
  HostPass host(const std::string& name);
  void clear(const std::string& name, const Buffer&, uint32_t value = 0);
  void clear(const std::string& name, const GpuImage&);
  void copy(const std::string& name, const GpuImage& from, const GpuImage& to);
  /// Brings a structure to where the vertices of its moving geometry are now. @throws Error(BadInput) where nothing in it moves
  void update(const std::string& name, const AccelerationStructure&);
  /// Listed with the timings, not recorded.
  void skip(const std::string& name, const std::string& reason);

  /// An image that keeps its content from one execute to the next; `fresh` (where given) tells that it was made anew
  /// and holds zeros.
  GpuImage history(const std::string& name, const ImageDesc&, bool* fresh = nullptr);
  Buffer historyBuffer(const std::string& name, uint64_t bytes, bool* fresh = nullptr);
  /// Forgets histories whose name starts with `prefix` ("" for all).
  void resetHistory(const std::string& prefix = "");
  /// A device resource that lives until the same name is asked with another size; contents undefined between executes.
  GpuImage transient(const std::string& name, const ImageDesc&);
  Buffer transientBuffer(const std::string& name, uint64_t bytes);

  /// Submits everything recorded since the last call, waits for it, and returns what each pass took. The graph is then
  /// empty.
  /// @throws Error(Device) when the device is lost; exceptions of host passes come through, the rest of the batch is
  /// dropped.
  BatchTimings execute();
  /// Forgets what was recorded since the last execute. An error thrown while recording does the same.
  void drop();

  const std::vector<BarrierRecord>& barriers() const;  ///< of the last execute
  /// For the test that plants a fault: leaves out the barriers (changes of layout apart) before the named pass of the
  /// next execute.
  void omitBarriersBefore(const std::string& pass);
  struct Impl;

 private:
  friend class ComputePass;
  friend class RasterPass;
  friend class RayPass;
  friend class HostPass;
  std::unique_ptr<Impl> impl_;
};

}  // namespace hl
