#pragma once
// Runs the built halflight-cli as a person would, and keeps what it said.
#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "tests/temporary_folder.h"

extern char** environ;

namespace hl::test {

struct CliResult {
  int code = -1;  ///< exit code; 128 + signal where one ended it
  std::string out, err;
};

inline std::string contentOf(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

inline void writeText(const std::filesystem::path& file, const std::string& text) {
  std::ofstream(file, std::ios::binary) << text;
}

/// `interruptAfter`: Ctrl-C after so many seconds. Variables (NAME=VALUE) replace those of the environment.
inline CliResult runCli(const std::vector<std::string>& arguments, const std::vector<std::string>& variables = {},
                        double interruptAfter = 0) {
  const TemporaryFolder folder;
  const std::string out = folder / "out", err = folder / "err";
  std::vector<std::string> words = {HALFLIGHT_CLI};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& w : words) argv.push_back(w.data());
  argv.push_back(nullptr);

  std::vector<std::string> settings = variables;
  for (char** e = environ; *e; ++e) {
    const std::string setting = *e, name = setting.substr(0, setting.find('=') + 1);
    bool replaced = false;
    for (const std::string& v : variables) replaced |= v.rfind(name, 0) == 0;
    if (!replaced) settings.push_back(setting);
  }
  std::vector<char*> envp;
  for (std::string& s : settings) envp.push_back(s.data());
  envp.push_back(nullptr);

  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, 1, out.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  posix_spawn_file_actions_addopen(&actions, 2, err.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  pid_t child = 0;
  const int failed = posix_spawn(&child, HALFLIGHT_CLI, &actions, nullptr, argv.data(), envp.data());
  posix_spawn_file_actions_destroy(&actions);
  if (failed) throw std::runtime_error("cannot start " HALFLIGHT_CLI);
  if (interruptAfter > 0) {
    std::this_thread::sleep_for(std::chrono::duration<double>(interruptAfter));
    ::kill(child, SIGINT);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  CliResult r;
  r.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  r.out = contentOf(out);
  r.err = contentOf(err);
  return r;
}

}  // namespace hl::test
