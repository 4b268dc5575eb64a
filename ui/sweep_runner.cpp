#include "ui/sweep_runner.h"

#include <QMetaObject>
#include <QTimer>
#include <algorithm>
#include <chrono>
#include <new>
#include <utility>

#include "engine/core/error.h"
#include "ui/background.h"

namespace hl::ui {
namespace {

using Clock = std::chrono::steady_clock;
using namespace std::chrono_literals;

constexpr auto kShowInterval = 100ms;   // ten times a second at most
constexpr int kShowShare = 20;          // and a twentieth of the time at most
constexpr int kPaintMs = 150;           // after results were handed over: plots are drawn a tenth of a second later
constexpr auto kLongestTurn = 500ms;    // a window that is slower than this is not waited for
constexpr auto kCancelPoll = 20ms;

/// The exception in flight, with a line for the person.
std::pair<ErrorKind, QString> currentFailure() {
  try {
    throw;
  } catch (const Error& e) {
    return {e.kind(), QString::fromUtf8(e.what())};
  } catch (const std::bad_alloc&) {
    return {ErrorKind::Run, SweepRunner::tr("out of memory")};
  } catch (const std::exception& e) {
    return {ErrorKind::Run, QString::fromUtf8(e.what())};
  }
}

}  // namespace

/// Ends when the window says so, or takes too long.
class SweepRunner::Turn {
 public:
  void end() {
    {
      const std::lock_guard lock(mutex_);
      over_ = true;
    }
    changed_.notify_all();
  }
  void wait(const Progress& p) {
    std::unique_lock lock(mutex_);
    const auto until = Clock::now() + kLongestTurn;
    while (!over_ && !p.cancelled() && Clock::now() < until) changed_.wait_for(lock, kCancelPoll);
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  bool over_ = false;
};

SweepRunner::SweepRunner(const SessionOptions& options, std::shared_ptr<SessionGate> gate, QObject* parent) : QObject(parent), options_(options), gate_(std::move(gate)) {
  qRegisterMetaType<SharedSweep>();
}

SweepRunner::~SweepRunner() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
    for (const Order& order : orders_) order.progress->cancel();
  }
  wake_.notify_all();
  if (thread_.joinable()) thread_.join();
}

int SweepRunner::add(const QString& name, const Experiment& experiment, const QString& folder) {
  SweepJob job;
  job.id = ++lastId_, job.name = name, job.folder = folder;
  jobs_.push_back(job);
  {
    const std::lock_guard lock(mutex_);
    orders_.push_back({job.id, experiment, folder.toStdString(), std::make_shared<Progress>()});
  }
  if (!thread_.joinable()) thread_ = std::thread([this] { work(); });
  wake_.notify_all();
  emit listChanged();
  announceBusy();
  return job.id;
}

void SweepRunner::cancel(int id) {
  bool waited = false;
  {
    const std::lock_guard lock(mutex_);
    for (size_t i = 0; i < orders_.size(); ++i) {
      if (orders_[i].id != id) continue;
      orders_[i].progress->cancel();
      const SweepJob* known = job(id);
      waited = known && known->state == SweepJob::State::Waiting && i > 0;
      if (waited) orders_.erase(orders_.begin() + static_cast<std::ptrdiff_t>(i));
      break;
    }
  }
  if (waited) update(id, [](SweepJob& j) { j.state = SweepJob::State::Cancelled, j.message = tr("not started"); });
}

void SweepRunner::cancelAll() {
  std::vector<int> ids;
  for (const SweepJob& j : jobs_)
    if (!j.over()) ids.push_back(j.id);
  for (auto id = ids.rbegin(); id != ids.rend(); ++id) cancel(*id);  // what waits first, so that none of it starts
}

void SweepRunner::forget(int id) {
  if (std::erase_if(jobs_, [id](const SweepJob& j) { return j.id == id && j.over(); }) > 0) emit listChanged();
}

bool SweepRunner::busy() const {
  return std::any_of(jobs_.begin(), jobs_.end(), [](const SweepJob& j) { return !j.over(); });
}

const SweepJob* SweepRunner::job(int id) const {
  const auto at = std::find_if(jobs_.begin(), jobs_.end(), [id](const SweepJob& j) { return j.id == id; });
  return at == jobs_.end() ? nullptr : &*at;
}

/// To the window's thread; dropped where this is gone by then.
void SweepRunner::post(std::function<void()> what) { QMetaObject::invokeMethod(this, std::move(what), Qt::QueuedConnection); }

void SweepRunner::update(int id, std::function<void(SweepJob&)> change) {
  for (SweepJob& j : jobs_) {
    if (j.id != id) continue;
    const bool wasOver = j.over();
    change(j);
    const bool over = j.over();
    emit changed(id);
    if (over && !wasOver) emit finished(id);
    break;
  }
  announceBusy();
}

void SweepRunner::announceBusy() {
  if (busy() != wasBusy_) emit busyChanged(wasBusy_ = !wasBusy_);
}

void SweepRunner::work() {
  giveWay();
  while (true) {
    Order order;
    {
      std::unique_lock lock(mutex_);
      wake_.wait(lock, [&] { return stop_ || !orders_.empty(); });
      if (stop_) return;
      order = orders_.front();
    }
    run(order);
    const std::lock_guard lock(mutex_);
    if (!orders_.empty()) orders_.pop_front();
  }
}

void SweepRunner::run(const Order& order) {
  const int id = order.id;
  Progress& progress = *order.progress;
  const auto told = [this, id](SweepStatus s) {
    post([this, id, s] { update(id, [&](SweepJob& j) { j.state = SweepJob::State::Running, j.status = s; }); });
  };
  Clock::time_point shown = Clock::now();
  Clock::duration took{};
  const auto show = [&](const SweepResults& r, bool whole) {
    const Clock::time_point begin = Clock::now();
    auto view = std::make_shared<SweepView>();
    view->results = r;
    if (!whole) view->results.folder.clear();  // bias and variance read every picture: once, at the end
    view->summary = summarise(view->results);
    view->results.folder = r.folder;
    const SharedSweep shared = std::move(view);
    const auto turn = std::make_shared<Turn>();
    post([this, id, shared, turn] {
      emit results(id, shared);
      QTimer::singleShot(kPaintMs, this, [turn] { turn->end(); });
    });
    if (!whole) turn->wait(progress);
    shown = Clock::now(), took = shown - begin;
  };
  SweepJob::State state = SweepJob::State::Done;
  QString message;
  size_t done = 0, total = 0, failed = 0;
  try {
    SweepStatus first;
    first.doing = tr("waiting for the window's own work").toStdString();
    told(first);
    gate_->close();
    gate_->waitUntilEmpty(progress);
    Sweep sweep(order.experiment, order.folder);
    const auto count = [&] { done = sweep.results().done(), total = sweep.results().plan.size(), failed = sweep.results().failed(); };
    count();
    sweep.onStatus = [&](const SweepStatus& s) {
      told(s);
      try {
        gate_->giveTurn(progress);
      } catch (const Error&) {
        // cancelled: the sweep sees that by itself, and still writes its tables
      }
    };
    sweep.onRun = [&](const SweepResults& r, size_t) {
      count();
      const auto now = Clock::now();
      if (now - shown >= std::max<Clock::duration>(kShowInterval, took * kShowShare)) show(r, false);
    };
    try {
      Session session(options_);
      session.useProgress(order.progress);
      sweep.run(session, progress);
    } catch (...) {
      count();
      if (done > 0) show(sweep.results(), true);
      throw;
    }
    count();
    show(sweep.results(), true);
    message = failed ? tr("%1 of %2 runs failed; the table says why").arg(failed).arg(total) : tr("%n runs", nullptr, static_cast<int>(total));
  } catch (...) {
    const auto [kind, why] = currentFailure();
    state = kind == ErrorKind::Cancelled ? SweepJob::State::Cancelled : SweepJob::State::Failed;
    message = kind == ErrorKind::Cancelled ? tr("cancelled; %1 of %2 runs are kept: started again into the same folder it goes on").arg(done).arg(total) : why;
  }
  gate_->open();
  post([this, id, state, message, done, total, failed] {
    update(id, [&](SweepJob& j) {
      j.state = state, j.message = message;
      j.status = {std::string(), done, total, failed, 0};
    });
  });
}

}  // namespace hl::ui
