#pragma once
// An experiment as it is being typed: texts that may be wrong. It becomes one through the same reader as the command line's files, so that what the window
// refuses is what `bench` refuses, in the same words. Nothing here belongs to a thread; checkDraft() reads the file system.
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "engine/experiment/experiment.h"
#include "engine/params/param.h"

namespace hl::ui {

/// What is varied: a dotted parameter key, "technique", "camera" or "resolution"; a list ("16, 64"), or a range.
struct DraftAxis {
  std::string key;
  std::string values;    ///< separated by commas; numbers also by blanks. Of a resolution "640x360"
  bool range = false;    ///< then by the following, in place of `values`
  std::string from, to;
  int count = 4;
  bool log = false;
  bool operator==(const DraftAxis&) const = default;
};

struct SweepDraft {
  Preset base;
  std::vector<std::vector<DraftAxis>> permute = {{}};  ///< sets of axes: the combinations of each are added up
  std::string seeds = "1";                             ///< "1, 2, 3" or "1..4"
  std::string metrics = "relmse";                      ///< the first is that of the fronts
  bool matched = true, full = true;
  StopRule stop;
  double limitMs = 0;
  int repeats = 1, amortiseFrames = 60;
  bool pathTracer = true, images = false, lightmap = false;  ///< lightmap: its errors too
  double targetError = 0;
  std::vector<std::pair<std::string, std::string>> compareWith;  ///< as in Experiment: kept, and not edited here
};

/// As an experiment's file; base in place, ranges as ranges.
std::string draftJson(const SweepDraft&);
/// Ranges of the file stand as the lists they made.
SweepDraft draftOf(const Experiment&);

/// The declaration of an axis's parameter; null for technique, camera, resolution, and for what none of the set's techniques has.
const ParamInfo* declarationOf(const SweepDraft&, size_t set, const std::string& key);
/// Those that the axes of the set can be of: the axis "technique", or the base's.
std::vector<std::string> techniquesOf(const SweepDraft&, size_t set);

/// Where what is wrong was typed.
struct DraftField {
  std::string name;  ///< a key of the experiment's file ("seeds", "stop"), "axis", "folder", or "" for the whole
  size_t set = 0;    ///< of an axis
  std::string key;   ///< likewise
  bool operator==(const DraftField&) const = default;
};
struct DraftProblem {
  DraftField field;
  std::string message;  ///< one line
};

struct DraftCheck {
  std::optional<Experiment> experiment;  ///< without one, `problem` says why
  std::optional<DraftProblem> problem;
  size_t configurations = 0, runs = 0;
  size_t present = 0;                    ///< runs that the folder holds already
};
/// `folder`: for the results; "" is refused.
DraftCheck checkDraft(const SweepDraft&, const std::filesystem::path& folder);

}  // namespace hl::ui
