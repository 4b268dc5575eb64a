#pragma once
// Runs a Session on a thread of its own: the window posts edits and reads published results, and never waits for a frame.
#include <functional>
#include <memory>
#include <string>

#include "engine/session/session.h"
#include "engine/session/session_gate.h"

namespace hl {

class SessionThread {
 public:
  /// Starts the thread; the session is made there (a failure reaches onError, with ErrorKind::Device where it is the device's). Frames begin with the
  /// first edit, so that the owner chooses what is loaded. After an Error of kind Device the thread is done: make a new SessionThread.
  /// While `gate` (null: none) is closed, the thread waits with its edits and frames.
  explicit SessionThread(const SessionOptions&, std::shared_ptr<SessionGate> gate = nullptr);
  /// Cancels what runs and joins; at most about one unit of work.
  ~SessionThread();

  /// Runs `edit` on the session's thread before the next frame. Edits posted with the same non-empty `key` replace one another while they wait.
  /// An Error thrown by it reaches `onError` (see setCallbacks), and the session stays as it was.
  void post(std::function<void(Session&)> edit, const std::string& key = {});
  /// Cancels the running import, bake or reference at once, from any thread.
  void cancel();

  /// The newest result; null before the first. Never blocks for longer than a pointer copy.
  std::shared_ptr<const FrameResult> latest() const;
  /// Progress of the load or rebuild that runs now (thread-safe to read), for the status bar.
  std::shared_ptr<const Progress> progress() const;

  /// Both are called on the session's thread; forward them to the window's event loop by a queued call. Errors raised before anyone listened are
  /// delivered here, on the caller's thread.
  void setCallbacks(std::function<void()> onFrame, std::function<void(const Error&)> onError);
  /// While the viewport is hidden frames go on only as long as there is work between them; both pause when `paused`.
  void setVisible(bool);
  void setPaused(bool);
  /// One frame more, even where paused or unseen: someone needs what is published with it.
  void renderOnce();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace hl
