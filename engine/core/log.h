#pragma once
// Logging, without spdlog's headers: those are in log.cpp. Format with fmt::format where a message has values.
#include <functional>
#include <string_view>

namespace hl {

enum class LogLevel { Debug, Info, Warning, Error };

void log(LogLevel level, std::string_view message);
inline void logInfo(std::string_view m) { log(LogLevel::Info, m); }
inline void logWarning(std::string_view m) { log(LogLevel::Warning, m); }
inline void logError(std::string_view m) { log(LogLevel::Error, m); }

/// Least level that reaches stderr; stdout is never written.
void setLogLevel(LogLevel level);
/// One more receiver (the window's Log dock); called from any thread. An empty function removes it.
void setLogSink(std::function<void(LogLevel, std::string_view)> sink);

}  // namespace hl
