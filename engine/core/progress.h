#pragma once
// Progress of long work, written by the worker, read by anyone; and the way to stop it.
#include <atomic>
#include <cstdint>
#include <memory>
#include <string>

#include "engine/core/error.h"

namespace hl {

class Progress {
 public:
  void begin(const char* what, uint64_t total) { what_ = what, done_ = 0, total_ = total; }  ///< `what`: a literal
  void advance(uint64_t n = 1) { done_.fetch_add(n, std::memory_order_relaxed); }
  const char* what() const { return what_; }
  uint64_t done() const { return done_.load(std::memory_order_relaxed); }
  uint64_t total() const { return total_.load(std::memory_order_relaxed); }
  void cancel() { cancelled_ = true; }
  bool cancelled() const { return cancelled_; }
  /// Call it in inner loops, at least every 50 ms. @throws Error(Cancelled)
  void check() const {
    if (cancelled()) throw Error(ErrorKind::Cancelled, std::string(what()) + ": cancelled");
  }

 private:
  std::atomic<const char*> what_{""};
  std::atomic<uint64_t> done_{0}, total_{0};
  std::atomic<bool> cancelled_{false};
};

}  // namespace hl
