#pragma once
// A fixed set of worker threads (nice 10) for host work: path tracing, Embree batches, atlas building.
#include <cstddef>
#include <functional>
#include <memory>

namespace hl {

class TaskPool {
 public:
  explicit TaskPool(unsigned threads = 0);  ///< 0: one worker a hardware thread
  ~TaskPool();
  TaskPool(const TaskPool&) = delete;
  TaskPool& operator=(const TaskPool&) = delete;

  unsigned threads() const;

  /// Calls body(begin, end, worker) over [0, count) in pieces of `grain` and returns when all are done; the caller's thread only waits.
  /// `worker` is in [0, threads()). Which worker gets a piece is not fixed: results must not depend on it. The first exception
  /// thrown by a piece is rethrown here once all workers have stopped. May not be called from inside a piece.
  void parallelFor(size_t count, size_t grain, const std::function<void(size_t begin, size_t end, unsigned worker)>& body);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace hl
