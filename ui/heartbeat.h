#pragma once
// How responsive the window is: delays of a timer on its event loop, and the processor time of each event. On a virtual machine both hold time that the
// host gave to others; the kernel reports it as stolen, and it is subtracted here. (Measured: events of 55 to 160 ms, each of a kind that takes 10 ms
// at other times, and each with 120 ms and more stolen while it ran.)
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

/// A timer that notes by how much each of its beats came late, stolen time apart.
class Heartbeat : public QObject {
  Q_OBJECT
 public:
  explicit Heartbeat(int intervalMs = 5, QObject* parent = nullptr);
  void start();
  void stop() { timer_.stop(); }
  size_t beats() const { return lateMs_.size(); }
  /// Lateness [ms] that `share` of the beats stay under; 0 without beats.
  double quantile(double share) const;

 private:
  int interval_;
  QTimer timer_;
  QElapsedTimer clock_;
  std::vector<double> lateMs_;
  StolenTime stolen_;
};

/// An application that measures the thread's own processor time for each event, nested ones included and stolen time apart.
class MeasuredApplication : public QApplication {
 public:
  using QApplication::QApplication;
  bool notify(QObject*, QEvent*) override;
  void startMeasuring();
  void stopMeasuring() { measuring_ = false; }
  double longestEventMs() const { return longestMs_; }
  /// Stolen while events ran [ms].
  double stolenMs() const { return stolenMs_; }
  /// "QTimer: event 1"
  const std::string& longestEvent() const { return longest_; }
  size_t events() const { return events_; }
  size_t eventsOver(double ms) const;

 private:
  bool measuring_ = false;
  int depth_ = 0;
  size_t events_ = 0;
  double longestMs_ = 0, stolenMs_ = 0;
  StolenTime stolen_;
  std::string longest_;
  std::vector<double> slow_;  ///< above 10 ms
};

}  // namespace hl::ui
