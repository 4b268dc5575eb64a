#include "ui/heartbeat.h"

#include <fmt/format.h>

#include <QEvent>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <ctime>

#include <fcntl.h>
#include <sys/resource.h>
#include <unistd.h>

namespace hl::ui {
namespace {

constexpr double kSlowMs = 10;
constexpr double kLimitMs = 50;  // what the window promises for each event and for the heartbeat's 99th percentile

double milliseconds(clockid_t clock) {
  timespec t{};
  clock_gettime(clock, &t);
  return static_cast<double>(t.tv_sec) * 1e3 + static_cast<double>(t.tv_nsec) * 1e-6;
}

MeasuredTime measured(double raw, double stolen) { return {std::max(0.0, raw), std::max(0.0, raw - stolen)}; }

void keep(const MeasuredTime& ms, const std::string& name, MeasuredApplication::Longest& longest, std::vector<MeasuredTime>& slow) {
  if (ms.raw > kSlowMs) slow.push_back(ms);
  if (ms.raw > longest.ms.raw) longest.ms.raw = ms.raw, longest.raw = name;
  if (ms.corrected > longest.ms.corrected) longest.ms.corrected = ms.corrected, longest.corrected = name;
}

size_t countOver(const std::vector<MeasuredTime>& slow, double ms, Figure figure) {
  return static_cast<size_t>(std::count_if(slow.begin(), slow.end(), [&](const MeasuredTime& v) { return v.of(figure) > ms; }));
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

ThreadClock::ThreadClock() : file_(open("/proc/thread-self/schedstat", O_RDONLY | O_CLOEXEC)) {}

ThreadClock::~ThreadClock() {
  if (file_ >= 0) close(file_);
}

ThreadTimes ThreadClock::now() const {
  ThreadTimes t;
  char text[128];
  const ssize_t n = file_ < 0 ? -1 : pread(file_, text, sizeof text - 1, 0);
  if (n > 0) {
    text[n] = 0;
    if (const char* second = std::strchr(text, ' ')) t.readyMs = static_cast<double>(std::strtoull(second, nullptr, 10)) * 1e-6;
  }
  rusage usage{};
  getrusage(RUSAGE_THREAD, &usage);
  t.sleeps = usage.ru_nvcsw;
  t.runningMs = milliseconds(CLOCK_THREAD_CPUTIME_ID);
  t.wallMs = milliseconds(CLOCK_MONOTONIC);
  return t;
}

Heartbeat::Heartbeat(int intervalMs, QObject* parent) : QObject(parent), interval_(intervalMs) {
  timer_.setTimerType(Qt::PreciseTimer);
  timer_.setInterval(interval_);
  connect(&timer_, &QTimer::timeout, this, [this] {
    const double passed = static_cast<double>(clock_.nsecsElapsed()) * 1e-6;
    clock_.restart();
    late_.push_back(measured(passed - interval_, stolen_.take()));
  });
}

void Heartbeat::start() {
  late_.clear();
  stolen_.take();
  clock_.start();
  timer_.start();
}

double Heartbeat::quantile(double share, Figure figure) const {
  if (late_.empty()) return 0;
  std::vector<double> sorted;
  for (const MeasuredTime& t : late_) sorted.push_back(t.of(figure));
  std::sort(sorted.begin(), sorted.end());
  return sorted[static_cast<size_t>(std::floor(share * static_cast<double>(sorted.size() - 1)))];
}

void MeasuredApplication::startMeasuring() {
  measuring_ = true;
  events_ = 0;
  stolenMs_ = 0;
  longestEvent_ = longestSleep_ = longestSleepInPainting_ = {};
  slowEvents_.clear();
  slowSleeps_.clear();
}

bool MeasuredApplication::notify(QObject* receiver, QEvent* event) {
  if (!measuring_ || depth_ > 0) return QApplication::notify(receiver, event);
  // Both may be gone when it returns.
  const std::string name = std::string(receiver->metaObject()->className()) + ": event " + std::to_string(static_cast<int>(event->type()));
  const bool painting = event->type() == QEvent::UpdateRequest;
  stolen_.take();
  const ThreadTimes before = clock_.now();
  ++depth_;
  const bool result = QApplication::notify(receiver, event);
  --depth_;
  const ThreadTimes after = clock_.now();
  const double stolen = stolen_.take(), running = after.runningMs - before.runningMs, ready = after.readyMs - before.readyMs;
  // A thread that never slept has waited for nothing: what is missing then is an interrupt's, or the host's.
  const bool slept = after.sleeps > before.sleeps;
  const double asleep = slept ? after.wallMs - before.wallMs - running - ready : 0;
  stolenMs_ += stolen;
  ++events_;
  keep(measured(running, stolen), name, longestEvent_, slowEvents_);
  keep(measured(asleep, stolen), name, painting ? longestSleepInPainting_ : longestSleep_, slowSleeps_);
  return result;
}

size_t MeasuredApplication::eventsOver(double ms, Figure figure) const { return countOver(slowEvents_, ms, figure); }
size_t MeasuredApplication::sleepsOver(double ms, Figure figure) const { return countOver(slowSleeps_, ms, figure); }

std::string responsivenessJson(const Heartbeat& heartbeat, const MeasuredApplication& app) {
  const auto figures = [&](Figure f) {
    const bool raw = f == Figure::Raw;
    const auto &event = app.longestEvent(), &sleep = app.longestSleep();
    return fmt::format(
        R"({{"late_ms_p50": {:.2f}, "late_ms_p99": {:.2f}, "late_ms_max": {:.2f}, "event_thread_ms_max": {:.2f}, "longest_event": "{}", )"
        R"("events_over_{:.0f}_ms": {}, "event_asleep_ms_max": {:.2f}, "longest_sleep": "{}", "painting_asleep_ms_max": {:.2f}}})",
        heartbeat.quantile(0.5, f), heartbeat.quantile(0.99, f), heartbeat.quantile(1, f), event.ms.of(f), raw ? event.raw : event.corrected, kLimitMs,
        app.eventsOver(kLimitMs, f), sleep.ms.of(f), raw ? sleep.raw : sleep.corrected, app.longestSleepInPainting().ms.of(f));
  };
  return fmt::format(R"({{"beats": {}, "events": {}, "stolen_ms": {:.0f}, "raw": {}, "corrected": {}}})", heartbeat.beats(), app.events(), app.stolenMs(),
                     figures(Figure::Raw), figures(Figure::Corrected));
}

}  // namespace hl::ui
