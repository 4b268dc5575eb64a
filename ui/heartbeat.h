#pragma once
// How responsive the window is: delays of a timer on its event loop, and the processor time of each event.
#include <QApplication>
#include <QElapsedTimer>
#include <QTimer>
#include <string>
#include <vector>

namespace hl::ui {

/// A timer that notes by how much each of its beats came late.
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
};

/// An application that measures the thread's own processor time for each event, nested ones included.
class MeasuredApplication : public QApplication {
 public:
  using QApplication::QApplication;
  bool notify(QObject*, QEvent*) override;
  void startMeasuring();
  void stopMeasuring() { measuring_ = false; }
  double longestEventMs() const { return longestMs_; }
  /// "QTimer: event 1"
  const std::string& longestEvent() const { return longest_; }
  size_t events() const { return events_; }
  size_t eventsOver(double ms) const;

 private:
  bool measuring_ = false;
  int depth_ = 0;
  size_t events_ = 0;
  double longestMs_ = 0;
  std::string longest_;
  std::vector<double> slow_;  ///< above 10 ms
};

}  // namespace hl::ui
