#pragma once
// Experiments one after the other, on a thread of their own (nice 10) with a session of their own, through the same Sweep as `halflight-cli bench`. While one
// runs, the window's session rests: its gate is closed. Between two runs it has a turn for edits that wait, and so has the window, for tables and plots: while
// a frame is timed, neither does anything unless a person does.
#include <QObject>
#include <QString>
#include <condition_variable>
#include <deque>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "engine/session/session_gate.h"
#include "engine/sweep/curves.h"

namespace hl::ui {

using SharedSweep = std::shared_ptr<const SweepView>;

struct SweepJob {
  enum class State { Waiting, Running, Done, Cancelled, Failed };
  int id = 0;
  QString name, folder;
  State state = State::Waiting;
  SweepStatus status;  ///< of the last step
  QString message;     ///< why it failed, or what came of it
  bool over() const { return state != State::Waiting && state != State::Running; }
};

class SweepRunner : public QObject {
  Q_OBJECT
 public:
  SweepRunner(const SessionOptions&, std::shared_ptr<SessionGate>, QObject* parent = nullptr);
  /// Cancels, and waits for at most about one unit of work.
  ~SweepRunner() override;

  /// Into the line; it starts once those before it are through. Returns its id.
  int add(const QString& name, const Experiment&, const QString& folder);
  /// Takes it out of the line, or stops it; what is done stays in its folder, and the same experiment into the same folder goes on.
  void cancel(int id);
  void cancelAll();
  /// Out of the list, once it is over.
  void forget(int id);
  /// One runs or waits.
  bool busy() const;
  const std::vector<SweepJob>& jobs() const { return jobs_; }
  const SweepJob* job(int id) const;

 signals:
  void changed(int id);
  void listChanged();
  /// What the experiment has so far; at most ten times a second, and seldom enough to cost a twentieth of its time at most.
  void results(int id, const hl::ui::SharedSweep& sweep);
  void finished(int id);
  void busyChanged(bool busy);

 private:
  struct Order {
    int id = 0;
    Experiment experiment;
    std::filesystem::path folder;
    std::shared_ptr<Progress> progress;
  };
  class Turn;  // of the window, between two runs

  void work();                 // the thread
  void run(const Order&);      // likewise
  void post(std::function<void()>);
  void update(int id, std::function<void(SweepJob&)>);
  void announceBusy();

  SessionOptions options_;
  std::shared_ptr<SessionGate> gate_;
  std::vector<SweepJob> jobs_;
  int lastId_ = 0;
  bool wasBusy_ = false;

  std::mutex mutex_;
  std::condition_variable wake_;
  std::deque<Order> orders_;               // guarded; the first is the one that runs
  bool stop_ = false;                      // guarded
  std::thread thread_;
};

}  // namespace hl::ui
Q_DECLARE_METATYPE(hl::ui::SharedSweep)
