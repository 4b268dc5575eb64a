#pragma once
// Who may work now: the window's session, or a sweep. While a sweep measures, the session neither renders nor takes edits; between two runs it is given a
// turn for those that wait (DESIGN.md section 3: nothing else of ours runs while a frame is timed).
#include <condition_variable>
#include <functional>
#include <mutex>

#include "engine/core/progress.h"

namespace hl {

/// Any thread may call any of it. Open at first.
class SessionGate {
 public:
  // The session's side.
  /// Waits while the gate is closed. False, without having entered, once `stopped` says so: wake() after whatever makes it say so. `wantsTurn`: whether
  /// there is something that should not wait for the gate to open; asked by whoever gives turns. Neither may call the gate.
  bool enter(const std::function<bool()>& stopped, const std::function<bool()>& wantsTurn);
  void leave();
  void wake();

  // The sweep's side.
  void close();
  void open();
  /// Until nobody is inside; at once where nobody is. @throws Error(Cancelled)
  void waitUntilEmpty(const Progress&) const;
  /// Of a closed gate: lets in who waits in enter() and wants a turn, and comes back when it has left; at once where nobody does.
  /// @throws Error(Cancelled), with the gate still closed; who is inside then leaves when it is through.
  void giveTurn(const Progress&);
  bool closed() const;

 private:
  mutable std::mutex mutex_;
  mutable std::condition_variable changed_;
  bool closed_ = false, turn_ = false;
  int inside_ = 0;
  const std::function<bool()>* wantsTurn_ = nullptr;  // of who waits
};

}  // namespace hl
