#include "engine/core/log.h"

#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <memory>
#include <mutex>
#include <utility>

namespace hl {

namespace {

spdlog::level::level_enum levelOf(LogLevel level) {
  switch (level) {
    case LogLevel::Debug:
      return spdlog::level::debug;
    case LogLevel::Info:
      return spdlog::level::info;
    case LogLevel::Warning:
      return spdlog::level::warn;
    case LogLevel::Error:
      return spdlog::level::err;
  }
  return spdlog::level::err;
}

spdlog::logger& logger() {
  static const std::unique_ptr<spdlog::logger> instance = [] {
    auto made = std::make_unique<spdlog::logger>("halflight", std::make_shared<spdlog::sinks::stderr_color_sink_mt>());
    made->set_pattern("%^%l%$: %v");
    made->flush_on(spdlog::level::warn);
    return made;
  }();
  return *instance;
}

std::mutex sinkMutex;
std::function<void(LogLevel, std::string_view)> sink;  // guarded by sinkMutex
thread_local bool insideSink = false;

}  // namespace

void log(LogLevel level, std::string_view message) {
  logger().log(levelOf(level), spdlog::string_view_t(message.data(), message.size()));
  // A receiver that logs would wait for itself; what it says reaches stderr alone.
  if (insideSink) return;
  // Held during the call, so that a receiver that was removed is never called again.
  std::lock_guard lock(sinkMutex);
  if (!sink) return;
  insideSink = true;
  try {
    sink(level, message);
  } catch (...) {
    insideSink = false;
    throw;
  }
  insideSink = false;
}

void setLogLevel(LogLevel level) { logger().set_level(levelOf(level)); }

void setLogSink(std::function<void(LogLevel, std::string_view)> receiver) {
  std::lock_guard lock(sinkMutex);
  sink = std::move(receiver);
}

}  // namespace hl
