#pragma once
// What is thrown where a run took longer than its caller allows: a finding about the run, where other errors have causes to mend.
#include "engine/core/error.h"

namespace hl {

class LimitError : public Error {
 public:
  explicit LimitError(const std::string& message) : Error(ErrorKind::Run, message) {}
};

}  // namespace hl
