#include "ui/heartbeat.h"

#include <QEvent>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <ctime>

#include <fcntl.h>
#include <unistd.h>

namespace hl::ui {
namespace {

constexpr double kSlowMs = 10;

double threadMs() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) * 1e3 + static_cast<double>(t.tv_nsec) * 1e-6;
}

}  // namespace

StolenTime::StolenTime() : file_(open("/proc/stat", O_RDONLY | O_CLOEXEC)) { take(); }

StolenTime::~StolenTime() {
  if (file_ >= 0) close(file_);
}

double StolenTime::take() {
  constexpr int kStealColumn = 8;
  char text[16384];
  const ssize_t n = file_ < 0 ? -1 : pread(file_, text, sizeof text - 1, 0);
  if (n <= 0) return 0;
  text[n] = 0;
  long most = 0;
  size_t processor = 0;
  for (const char* line = std::strstr(text, "\ncpu"); line; line = std::strstr(line + 1, "\ncpu"), ++processor) {
    char* at = const_cast<char*>(std::strchr(line, ' '));
    long value = 0;
    for (int column = 0; at && column < kStealColumn; ++column) value = std::strtol(at, &at, 10);
    if (processor >= ticks_.size()) ticks_.resize(processor + 1, value);
    most = std::max(most, value - ticks_[processor]);
    ticks_[processor] = value;
  }
  return static_cast<double>(most) * 1000.0 / static_cast<double>(sysconf(_SC_CLK_TCK));
}

Heartbeat::Heartbeat(int intervalMs, QObject* parent) : QObject(parent), interval_(intervalMs) {
  timer_.setTimerType(Qt::PreciseTimer);
  timer_.setInterval(interval_);
  connect(&timer_, &QTimer::timeout, this, [this] {
    const double passed = static_cast<double>(clock_.nsecsElapsed()) * 1e-6;
    clock_.restart();
    lateMs_.push_back(std::max(0.0, passed - interval_ - stolen_.take()));
  });
}

void Heartbeat::start() {
  lateMs_.clear();
  stolen_.take();
  clock_.start();
  timer_.start();
}

double Heartbeat::quantile(double share) const {
  if (lateMs_.empty()) return 0;
  std::vector<double> sorted = lateMs_;
  std::sort(sorted.begin(), sorted.end());
  return sorted[static_cast<size_t>(std::floor(share * static_cast<double>(sorted.size() - 1)))];
}

void MeasuredApplication::startMeasuring() {
  measuring_ = true;
  events_ = 0;
  longestMs_ = stolenMs_ = 0;
  longest_.clear();
  slow_.clear();
}

bool MeasuredApplication::notify(QObject* receiver, QEvent* event) {
  if (!measuring_ || depth_ > 0) return QApplication::notify(receiver, event);
  // Both may be gone when it returns.
  const std::string name = std::string(receiver->metaObject()->className()) + ": event " + std::to_string(static_cast<int>(event->type()));
  stolen_.take();
  const double start = threadMs();
  ++depth_;
  const bool result = QApplication::notify(receiver, event);
  --depth_;
  const double taken = threadMs() - start, stolen = stolen_.take(), ms = std::max(0.0, taken - stolen);
  stolenMs_ += stolen;
  ++events_;
  if (ms > kSlowMs) slow_.push_back(ms);
  if (ms > longestMs_) longestMs_ = ms, longest_ = name;
  return result;
}

size_t MeasuredApplication::eventsOver(double ms) const {
  return static_cast<size_t>(std::count_if(slow_.begin(), slow_.end(), [&](double v) { return v > ms; }));
}

}  // namespace hl::ui
