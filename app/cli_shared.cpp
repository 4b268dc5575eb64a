// What several commands do alike: printing, progress, interruption, and edits of the preset from the command line.
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <mutex>
#include <thread>

#include "app/cli_commands.h"
#include "engine/core/error.h"
#include "engine/core/files.h"
#include "engine/core/log.h"
#include "engine/experiment/open_target.h"

namespace hl::cli {

namespace fs = std::filesystem;

namespace {

std::shared_ptr<Progress> interrupted;  // what Ctrl-C cancels

extern "C" void onInterrupt(int) {
  interrupted->cancel();  // one lock-free store
  std::signal(SIGINT, SIG_DFL);
}

/// A line that a thread of its own rewrites until it is destroyed.
class ProgressLine {
 public:
  explicit ProgressLine(std::shared_ptr<Progress> progress)
      : progress_(std::move(progress)), thread_([this](const std::stop_token& stop) { show(stop); }) {}
  ~ProgressLine() {
    thread_.request_stop();
    thread_.join();
    if (shown_) std::fputs("\r\033[K", stderr);
  }

 private:
  void show(const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
      const uint64_t total = progress_->total();
      if (total == 0) continue;
      const double share = 100.0 * static_cast<double>(std::min(progress_->done(), total)) / static_cast<double>(total);
      std::fputs(fmt::format("\r\033[K{}: {:.0f} %", progress_->what(), share).c_str(), stderr);
      shown_ = true;
    }
  }

  std::shared_ptr<Progress> progress_;
  bool shown_ = false;
  std::jthread thread_;
};

std::unique_ptr<ProgressLine> progressLine;

}  // namespace

std::shared_ptr<Progress> interruptibleProgress(const GlobalOptions& global) {
  interrupted = std::make_shared<Progress>();
  std::signal(SIGINT, onInterrupt);
  std::signal(SIGTERM, onInterrupt);
  if (isatty(STDERR_FILENO) && !global.json) progressLine = std::make_unique<ProgressLine>(interrupted);
  return interrupted;
}

void finishProgress() { progressLine.reset(); }

void print(std::string_view text) {
  if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() || std::fflush(stdout) != 0)
    throw Error(ErrorKind::Run, "standard output cannot be written");
}

void note(std::string_view text) {
  finishProgress();
  std::fputs(fmt::format("halflight-cli: {}\n", text).c_str(), stderr);
}

void sayRebuilds(const GlobalOptions& global, Session& session) {
  constexpr double kWorthSaying = 1;  // [s]
  if (global.json && !global.verbose) return;
  session.tellRebuilds([verbose = global.verbose](const RebuildForecast& f) {
    if (!verbose && f.seconds < kWorthSaying) return;
    std::fputs(fmt::format("{}halflight-cli: precomputation: {}\n", isatty(STDERR_FILENO) ? "\r\033[K" : "", forecastText(f)).c_str(), stderr);
  });
}

int validationVerdict(const GlobalOptions& global, Device& device, int code) {
  if (!global.validation) return code;
  const std::vector<std::string> messages = device.takeValidationMessages();
  for (const std::string& m : messages) note(m);
  return messages.empty() ? code : std::max(code, 1);
}

void setResolution(Preset& preset, const std::string& text) {
  if (text.empty()) return;
  const size_t x = text.find('x');
  const auto side = [&](std::string_view part, int& v) {
    const auto end = std::from_chars(part.data(), part.data() + part.size(), v);
    return !part.empty() && end.ec == std::errc() && end.ptr == part.data() + part.size() && v >= 1 && v <= 8192;
  };
  const std::string_view all(text);
  if (x == std::string::npos || !side(all.substr(0, x), preset.width) || !side(all.substr(x + 1), preset.height))
    throw badInput(fmt::format("--resolution {}: WIDTHxHEIGHT is wanted, each from 1 to 8192, as in 640x360", text));
}

void setParameters(Preset& preset, const std::vector<std::string>& pairs) {
  for (const std::string& pair : pairs) {
    const size_t equals = pair.find('=');
    if (equals == std::string::npos || equals == 0)
      throw badInput(fmt::format("--set {}: KEY=VALUE is wanted, as in lightmap.resolution=512", pair));
    preset.parameters[pair.substr(0, equals)] = pair.substr(equals + 1);
  }
  checkParameters(preset);
}

void checkOutputFolder(const std::string& option, const fs::path& folder) {
  std::error_code failed;
  fs::path there = folder;  // the deepest folder of the path that exists: the others would be made in it
  while (!there.empty() && !fs::exists(there, failed) && there != there.parent_path()) there = there.parent_path();
  if (there.empty()) there = ".";
  if (!fs::is_directory(there, failed))
    throw badInput(fmt::format("{} {}: {} is no folder", option, folder.string(), there.string()));
  // Permissions say less than a try: the file system may be read-only, or refuse files.
  try {
    const fs::path probe = temporaryBeside(there / "probe");
    writeFileAtomically(probe, "");
    fs::remove(probe, failed);
  } catch (const Error& e) {
    throw badInput(fmt::format("{} {}: nothing can be written there: {}", option, folder.string(), e.what()));
  }
}

void checkOutputImage(const std::string& option, const fs::path& file, const std::vector<std::string>& extensions) {
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (std::find(extensions.begin(), extensions.end(), extension) == extensions.end())
    throw badInput(fmt::format("{} {}: a file {} is wanted", option, file.string(), fmt::join(extensions, " or ")));
  std::error_code failed;
  if (fs::is_directory(file, failed)) throw badInput(fmt::format("{} {}: this is a folder", option, file.string()));
  const fs::path folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
  if (!fs::exists(folder, failed))
    throw badInput(fmt::format("{} {}: there is no folder {}", option, file.string(), folder.string()));
  checkOutputFolder(option, folder);
}

}  // namespace hl::cli
