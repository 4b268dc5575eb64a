#pragma once
// Errors that carry who must act on them. The programs' exit codes follow from the kind.
#include <stdexcept>
#include <string>
#include <vector>

namespace hl {

enum class ErrorKind {
  Run,        ///< the work itself failed (exit code 1)
  TooLarge,   ///< more than this device takes, or than it has memory left for: smaller settings work (exit code 1)
  BadInput,   ///< files, parameters or usage are wrong (exit code 2)
  Device,     ///< no device, driver missing, device lost (exit code 3)
  Cancelled,  ///< the person stopped it (exit code 130)
};

/// One readable line: what is wrong, where, and what would be right.
class Error : public std::runtime_error {
 public:
  Error(ErrorKind kind, const std::string& message) : std::runtime_error(message), kind_(kind) {}
  ErrorKind kind() const { return kind_; }
  int exitCode() const;

 private:
  ErrorKind kind_;
};

inline Error badInput(const std::string& message) { return Error(ErrorKind::BadInput, message); }

/// The candidate closest to `word` by edit distance, or "" where none is near; for "did you mean" in messages.
std::string nearest(const std::string& word, const std::vector<std::string>& candidates);

}  // namespace hl
