#include "engine/session/session_thread.h"

#include <sys/resource.h>
#include <unistd.h>

#include <condition_variable>
#include <deque>
#include <mutex>
#include <new>
#include <thread>

#include "engine/core/log.h"

namespace hl {
namespace {

// A settled session still renders this many frames, so that pass times are medians; then it sleeps until an edit comes.
constexpr uint64_t kFramesForTiming = 40;
constexpr int kWorkerNice = 10;

/// The exception in flight as one of ours. What an edit or a frame may throw besides, memory that ran out above all, must not end the program.
Error currentError() {
  try {
    throw;
  } catch (const Error& e) {
    return e;
  } catch (const std::bad_alloc&) {
    return Error(ErrorKind::Run, "out of memory");
  } catch (const std::exception& e) {
    return Error(ErrorKind::Run, e.what());
  }
}

struct Edit {
  std::string key;
  std::function<void(Session&)> apply;
};

}  // namespace

struct SessionThread::Impl {
  SessionOptions options;
  std::shared_ptr<SessionGate> gate;
  mutable std::mutex mutex;
  std::condition_variable wake;
  std::deque<Edit> edits;
  std::shared_ptr<const FrameResult> latest;
  std::shared_ptr<Progress> progress = std::make_shared<Progress>();
  std::function<void()> onFrame;
  std::function<void(const Error&)> onError;
  std::vector<Error> undelivered;  ///< raised before anyone listened
  bool stop = false, started = false, visible = true, paused = false, cancelWanted = false, onceMore = false;
  std::thread thread;

  void fail(const Error& error) {
    std::function<void(const Error&)> callback;
    {
      const std::lock_guard lock(mutex);
      callback = onError;
      if (!callback) undelivered.push_back(error);
    }
    if (callback) callback(error);
  }

  void run();
  bool enterGate();
  enum class Drained { Nothing, Edits, DeviceLost };
  Drained drain(Session&);
};

/// Applies the waiting edits. A fresh Progress each round: a cancel stops what ran when it came, and nothing after it.
SessionThread::Impl::Drained SessionThread::Impl::drain(Session& session) {
  std::deque<Edit> taken;
  bool cancelled = false;
  std::shared_ptr<Progress> current;
  {
    const std::lock_guard lock(mutex);
    taken.swap(edits);
    cancelled = std::exchange(cancelWanted, false);
    if (cancelled || progress->cancelled()) progress = std::make_shared<Progress>();
    current = progress;
  }
  session.useProgress(current);
  if (cancelled) session.cancelWork();
  for (const Edit& edit : taken) {
    try {
      edit.apply(session);
    } catch (const std::exception&) {
      const Error error = currentError();
      fail(error);
      if (error.kind() == ErrorKind::Device) return Drained::DeviceLost;
    }
  }
  return cancelled || !taken.empty() ? Drained::Edits : Drained::Nothing;
}

/// False once the thread is to end.
bool SessionThread::Impl::enterGate() {
  const auto stopped = [this] {
    const std::lock_guard lock(mutex);
    return stop;
  };
  const auto editsWait = [this] {
    const std::lock_guard lock(mutex);
    return cancelWanted || onceMore || !edits.empty();
  };
  return gate->enter(stopped, editsWait);
}

void SessionThread::Impl::run() {
  setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), kWorkerNice);  // this thread alone
  std::unique_ptr<Session> session;
  try {
    session = std::make_unique<Session>(options);
  } catch (const std::exception&) {
    fail(currentError());
    return;
  }
  uint64_t idleFrames = 0;
  while (true) {
    // Unseen, frames go on only as long as there is work between them.
    const auto mayRun = [&] { return started && (onceMore || (!paused && idleFrames < (visible ? kFramesForTiming : 1))); };
    {
      std::unique_lock lock(mutex);
      wake.wait(lock, [&] { return stop || cancelWanted || !edits.empty() || mayRun(); });
    }
    if (!enterGate()) break;
    const std::unique_ptr<SessionGate, void (*)(SessionGate*)> inside(gate.get(), [](SessionGate* g) { g->leave(); });
    const Drained drained = drain(*session);
    if (drained == Drained::DeviceLost) return;
    if (drained == Drained::Edits) idleFrames = 0;
    bool render = false;
    std::shared_ptr<Progress> current;
    {
      const std::lock_guard lock(mutex);
      if (stop) break;
      render = edits.empty() && !cancelWanted && mayRun();
      if (render) onceMore = false;
      current = progress;
    }
    if (!render) continue;
    try {
      auto result = session->frame(current.get());
      idleFrames = result->settled ? idleFrames + 1 : 0;
      std::function<void()> callback;
      {
        const std::lock_guard lock(mutex);
        latest = std::move(result);
        callback = onFrame;
      }
      if (callback) callback();
    } catch (const std::exception&) {
      const Error error = currentError();
      fail(error);
      if (error.kind() == ErrorKind::Device) return;  // the device is gone: the owner makes a new SessionThread
      idleFrames = kFramesForTiming;              // wait for an edit rather than fail in a loop
    }
  }
}

SessionThread::SessionThread(const SessionOptions& options, std::shared_ptr<SessionGate> gate) : impl_(std::make_unique<Impl>()) {
  impl_->options = options;
  impl_->gate = gate ? std::move(gate) : std::make_shared<SessionGate>();
  impl_->thread = std::thread([this] { impl_->run(); });
}

SessionThread::~SessionThread() {
  {
    const std::lock_guard lock(impl_->mutex);
    impl_->stop = true;
    impl_->progress->cancel();
  }
  impl_->wake.notify_all();
  impl_->gate->wake();
  impl_->thread.join();
}

void SessionThread::post(std::function<void(Session&)> edit, const std::string& key) {
  {
    const std::lock_guard lock(impl_->mutex);
    bool replaced = false;
    impl_->started = true;
    if (!key.empty())
      for (Edit& waiting : impl_->edits)
        if (waiting.key == key) waiting.apply = edit, replaced = true;
    if (!replaced) impl_->edits.push_back({key, std::move(edit)});
  }
  impl_->wake.notify_all();
}

void SessionThread::cancel() {
  {
    const std::lock_guard lock(impl_->mutex);
    impl_->cancelWanted = true;
    impl_->progress->cancel();
  }
  impl_->wake.notify_all();
}

std::shared_ptr<const FrameResult> SessionThread::latest() const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->latest;
}

std::shared_ptr<const Progress> SessionThread::progress() const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->progress;
}

void SessionThread::setCallbacks(std::function<void()> onFrame, std::function<void(const Error&)> onError) {
  std::vector<Error> early;
  {
    const std::lock_guard lock(impl_->mutex);
    impl_->onFrame = std::move(onFrame);
    impl_->onError = onError;
    if (onError) early.swap(impl_->undelivered);
  }
  for (const Error& e : early) onError(e);
}

void SessionThread::setVisible(bool visible) {
  {
    const std::lock_guard lock(impl_->mutex);
    impl_->visible = visible;
  }
  impl_->wake.notify_all();
}

void SessionThread::renderOnce() {
  {
    const std::lock_guard lock(impl_->mutex);
    impl_->onceMore = true;
  }
  impl_->wake.notify_all();
}

void SessionThread::setPaused(bool paused) {
  {
    const std::lock_guard lock(impl_->mutex);
    impl_->paused = paused;
  }
  impl_->wake.notify_all();
}

}  // namespace hl
