#include "engine/core/task_pool.h"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <exception>
#include <mutex>
#include <stdexcept>
#include <thread>
#include <vector>

namespace hl {

namespace {

constexpr int kWorkerNice = 10;  // the window's and the session's threads go first

thread_local const void* poolOfThisThread = nullptr;

}  // namespace

struct TaskPool::Impl {
  using Body = std::function<void(size_t, size_t, unsigned)>;

  std::vector<std::thread> workers;
  std::mutex callers;  // one parallelFor at a time

  std::mutex mutex;  // guards what follows, next apart
  std::condition_variable wake, finished;
  uint64_t round = 0;
  bool stopping = false;
  unsigned busy = 0;
  const Body* body = nullptr;
  size_t count = 0, grain = 1;
  std::exception_ptr failure;
  std::atomic<size_t> next{0};

  void work(unsigned worker) {
    // On Linux a niceness belongs to a thread. A refusal costs priority, never a result.
    setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), kWorkerNice);
    poolOfThisThread = this;
    uint64_t seen = 0;
    std::unique_lock lock(mutex);
    while (true) {
      wake.wait(lock, [&] { return stopping || round != seen; });
      if (stopping) return;
      seen = round;
      lock.unlock();
      runPieces(worker);
      lock.lock();
      if (--busy == 0) finished.notify_one();
    }
  }

  void runPieces(unsigned worker) {
    try {
      while (true) {
        const size_t begin = next.fetch_add(grain, std::memory_order_relaxed);
        if (begin >= count) return;
        (*body)(begin, begin + std::min(grain, count - begin), worker);
      }
    } catch (...) {
      std::lock_guard lock(mutex);
      if (!failure) failure = std::current_exception();
      next = count;  // what has not begun is not begun
    }
  }
};

TaskPool::TaskPool(unsigned threads) : impl_(std::make_unique<Impl>()) {
  if (threads == 0) threads = std::max(1u, std::thread::hardware_concurrency());
  impl_->workers.reserve(threads);
  for (unsigned i = 0; i < threads; ++i) impl_->workers.emplace_back([impl = impl_.get(), i] { impl->work(i); });
}

TaskPool::~TaskPool() {
  {
    std::lock_guard lock(impl_->mutex);
    impl_->stopping = true;
  }
  impl_->wake.notify_all();
  for (std::thread& worker : impl_->workers) worker.join();
}

unsigned TaskPool::threads() const { return static_cast<unsigned>(impl_->workers.size()); }

void TaskPool::parallelFor(size_t count, size_t grain,
                           const std::function<void(size_t begin, size_t end, unsigned worker)>& body) {
  if (poolOfThisThread == impl_.get()) throw std::logic_error("TaskPool::parallelFor called from inside a piece");
  if (count == 0) return;
  std::lock_guard oneCaller(impl_->callers);
  std::exception_ptr failure;
  {
    std::unique_lock lock(impl_->mutex);
    impl_->body = &body;
    impl_->count = count;
    // A larger grain than the work would let `next` run over its end.
    impl_->grain = std::clamp<size_t>(grain, 1, count);
    impl_->next = 0;
    impl_->busy = threads();
    ++impl_->round;
    impl_->wake.notify_all();
    impl_->finished.wait(lock, [&] { return impl_->busy == 0; });
    failure = std::move(impl_->failure);
    impl_->failure = nullptr;
    impl_->body = nullptr;
  }
  if (failure) std::rethrow_exception(failure);
}

}  // namespace hl
