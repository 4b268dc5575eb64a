// Rays cast on the host between submissions, by Embree.
#include "engine/trace/backends.h"

namespace hl {
namespace {

constexpr size_t kPiece = 4096;  // rays a task takes: some milliseconds at most, so that few pieces wait for the last

class EmbreeTracer final : public Tracer {
 public:
  EmbreeTracer(std::shared_ptr<EmbreeScene> scene, TaskPool& pool) : scene_(std::move(scene)), pool_(pool) {}

  const char* id() const override { return "embree"; }

  void record(FrameGraph& graph, const std::string& name, const Buffer& rays, const Buffer& out, uint32_t count,
              Query query) override {
    checkBatch(name, rays, out, count, query);
    if (count == 0) return graph.skip(name, "no rays");
    graph.host(name).read(rays).write(out).run(
        [scene = std::shared_ptr<const EmbreeScene>(scene_), &pool = pool_, rays, out, count, query](HostAccess& memory) {
          const auto in = memory.span<shared::Ray>(rays).first(count);
          if (query == Query::Closest) {
            const auto hits = memory.span<shared::Hit>(out).first(count);
            pool.parallelFor(count, kPiece, [&](size_t begin, size_t end, unsigned) {
              scene->closest(in.subspan(begin, end - begin), hits.subspan(begin, end - begin));
            });
          } else {
            const auto flags = memory.span<uint32_t>(out).first(count);
            pool.parallelFor(count, kPiece, [&](size_t begin, size_t end, unsigned) {
              scene->occluded(in.subspan(begin, end - begin), flags.subspan(begin, end - begin));
            });
          }
        });
  }

  void recordUpdate(FrameGraph& graph) override {
    graph.host("embree: refit").run([scene = scene_](HostAccess&) { scene->update(); });
  }

  bool onHost() const override { return true; }
  void closest(RayPacket& packet, size_t count) const override { scene_->closest(packet, count); }

  std::vector<std::pair<std::string, uint64_t>> memory() const override { return {{"embree: tree", scene_->bytes()}}; }

 private:
  std::shared_ptr<EmbreeScene> scene_;
  TaskPool& pool_;
};

}  // namespace

std::unique_ptr<Tracer> makeEmbreeTracer(std::shared_ptr<EmbreeScene> scene, TaskPool& pool) {
  return std::make_unique<EmbreeTracer>(std::move(scene), pool);
}

}  // namespace hl
