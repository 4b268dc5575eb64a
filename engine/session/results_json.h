#pragma once
// The results of a run as the JSON of DESIGN.md section 10, and as image attributes.
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "engine/session/session.h"

namespace hl {

class JsonWriter;

struct RunResults {
  std::shared_ptr<const FrameResult> frame;
  std::vector<ErrorValue> errors;
  std::optional<std::pair<std::string, StepReport>> step;  ///< what was changed, and what followed
  std::string imageHash;           ///< of the linear final picture
  std::vector<std::string> files;  ///< written, relative to `folder`
  std::string folder;
  bool cancelled = false;
};

std::string resultsJson(const RunResults&);
/// Its members, into an object that is open: a run of a sweep adds more.
void writeResultMembers(JsonWriter&, const RunResults&);

void writeError(JsonWriter&, const ErrorValue&);

/// Provenance as one JSON object, with the picture's hash where there is one.
std::string provenanceJson(const Provenance&, const std::string& imageHash = "");
/// The preset and its provenance, for Image::metadata.
std::map<std::string, std::string> imageAttributes(const Preset&, const Provenance&);
/// Of an image's values, for RunResults::imageHash.
std::string hashOfImage(const Image&);

}  // namespace hl
