#include "engine/session/session_gate.h"

#include <chrono>

namespace hl {
namespace {

// A cancel makes no noise: it is looked for this often.
constexpr std::chrono::milliseconds kCancelPoll(20);

}  // namespace

bool SessionGate::enter(const std::function<bool()>& stopped, const std::function<bool()>& wantsTurn) {
  std::unique_lock lock(mutex_);
  wantsTurn_ = &wantsTurn;
  changed_.wait(lock, [&] { return !closed_ || turn_ || stopped(); });
  wantsTurn_ = nullptr;
  const bool mayEnter = !closed_ || turn_;
  turn_ = false;
  if (mayEnter) ++inside_;
  changed_.notify_all();
  return mayEnter;
}

void SessionGate::leave() {
  const std::lock_guard lock(mutex_);
  --inside_;
  changed_.notify_all();
}

void SessionGate::wake() {
  const std::lock_guard lock(mutex_);
  changed_.notify_all();
}

void SessionGate::close() {
  const std::lock_guard lock(mutex_);
  closed_ = true;
}

void SessionGate::open() {
  const std::lock_guard lock(mutex_);
  closed_ = turn_ = false;
  changed_.notify_all();
}

void SessionGate::waitUntilEmpty(const Progress& p) const {
  std::unique_lock lock(mutex_);
  while (!changed_.wait_for(lock, kCancelPoll, [&] { return inside_ == 0 && !turn_; })) p.check();
}

void SessionGate::giveTurn(const Progress& p) {
  {
    const std::lock_guard lock(mutex_);
    if (!wantsTurn_ || !(*wantsTurn_)()) return;
    turn_ = true;
    changed_.notify_all();
  }
  try {
    waitUntilEmpty(p);
  } catch (...) {
    const std::lock_guard lock(mutex_);
    turn_ = false;
    throw;
  }
}

bool SessionGate::closed() const {
  const std::lock_guard lock(mutex_);
  return closed_;
}

}  // namespace hl
