#pragma once
// How responsive the window is: delays of a timer on its event loop, and for each event the processor time it took and the time it spent asleep. On a
// virtual machine all of them hold time that the host gave to others; the kernel reports it as stolen. Each figure is kept twice: as it was measured
// (raw), and with that time subtracted (corrected). (Measured: events of 55 to 160 ms, each of a kind that takes 10 ms at other times, and each with
// 120 ms and more stolen while it ran.)
#include <QApplication>
#include <QElapsedTimer>
#include <QTimer>
#include <string>
#include <vector>

namespace hl::ui {

/// Time that a virtual machine's host kept its processors from running, as the kernel counts it (proc(5), /proc/stat, "steal", in ticks of 10 ms).
class StolenTime {
 public:
  StolenTime();
  ~StolenTime();
  StolenTime(const StolenTime&) = delete;
  StolenTime& operator=(const StolenTime&) = delete;
  /// [ms] since the last call or construction, of the processor that lost most; 0 where the kernel tells nothing.
  double take();

 private:
  int file_;
  std::vector<long> ticks_;  ///< by processor
};

enum class Figure { Raw, Corrected };  ///< corrected: stolen time subtracted

/// A time [ms] in both forms.
struct MeasuredTime {
  double raw = 0, corrected = 0;
  double of(Figure f) const { return f == Figure::Raw ? raw : corrected; }
};

/// What a thread has done so far, by the kernel's account.
struct ThreadTimes {
  double wallMs = 0;
  double runningMs = 0;  ///< on a processor
  double readyMs = 0;    ///< able to run, while others did (/proc/thread-self/schedstat; 0 where the kernel does not tell)
  long sleeps = 0;       ///< times it gave up the processor by itself: for a lock, a fence, a file or a timer
};

/// The times of the thread that made it. Only that thread may ask.
class ThreadClock {
 public:
  ThreadClock();
  ~ThreadClock();
  ThreadClock(const ThreadClock&) = delete;
  ThreadClock& operator=(const ThreadClock&) = delete;
  ThreadTimes now() const;

 private:
  int file_;
};

/// A timer that notes by how much each of its beats came late.
class Heartbeat : public QObject {
  Q_OBJECT
 public:
  explicit Heartbeat(int intervalMs = 5, QObject* parent = nullptr);
  void start();
  void stop() { timer_.stop(); }
  size_t beats() const { return late_.size(); }
  /// Lateness [ms] that `share` of the beats stay under; 0 without beats.
  double quantile(double share, Figure) const;

 private:
  int interval_;
  QTimer timer_;
  QElapsedTimer clock_;
  std::vector<MeasuredTime> late_;
  StolenTime stolen_;
};

/// An application that measures each event, nested ones included: the thread's processor time, and how long the event was asleep. A thread sleeps where it
/// waits for a lock, a fence, a file or another thread; one that could have run while other programs did is not asleep, and that is told apart.
class MeasuredApplication : public QApplication {
 public:
  /// The longest time of all events, in each form its own, and the event that took it: "QTimer: event 1".
  struct Longest {
    MeasuredTime ms;
    std::string raw, corrected;
  };

  using QApplication::QApplication;
  bool notify(QObject*, QEvent*) override;
  void startMeasuring();
  void stopMeasuring() { measuring_ = false; }
  size_t events() const { return events_; }
  /// Stolen while events ran [ms].
  double stolenMs() const { return stolenMs_; }
  const Longest& longestEvent() const { return longestEvent_; }
  /// Painting apart: Qt hands parts of it to threads of its own, down to the lines of a scroll bar, and waits for each.
  const Longest& longestSleep() const { return longestSleep_; }
  const Longest& longestSleepInPainting() const { return longestSleepInPainting_; }
  size_t eventsOver(double ms, Figure) const;
  size_t sleepsOver(double ms, Figure) const;  ///< painting included

 private:
  bool measuring_ = false;
  int depth_ = 0;
  size_t events_ = 0;
  double stolenMs_ = 0;
  StolenTime stolen_;
  ThreadClock clock_;
  Longest longestEvent_, longestSleep_, longestSleepInPainting_;
  std::vector<MeasuredTime> slowEvents_, slowSleeps_;  ///< those above 10 ms, raw
};

/// What both measured, as one JSON object: "raw" and "corrected" have the same figures.
std::string responsivenessJson(const Heartbeat&, const MeasuredApplication&);

}  // namespace hl::ui
