#pragma once
// The commands of halflight-cli. Each prints to stdout and returns the exit code; bad input and failures are thrown as
// hl::Error.
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/progress.h"
#include "engine/experiment/open_target.h"
#include "engine/session/session.h"
#include "engine/sweep/sweep.h"

namespace hl::cli {

struct GlobalOptions {
  std::string device, tracer = "auto";
  bool verbose = false, validation = false, json = false;

  SessionOptions session() const { return {{device, validation}, tracer}; }
};

struct RenderOptions {
  std::string target, technique, camera, resolution;
  std::vector<std::string> set, metrics, errorTargets{"image"};
  std::optional<int> frames;
  std::optional<uint32_t> seed;
  std::string view;
  std::optional<float> exposure;
  bool play = false;
  std::optional<float> time, rate;
  std::string cameraPath;
  std::optional<int> flicker;
  std::string step;
  std::string out;
};

struct ReferenceOptions {
  std::string target, camera, resolution;
  std::vector<std::string> set;
  std::optional<int> samples;
  std::string bounces;
  bool diffuseOnly = false, lightmap = false;
  std::string out;
};

struct CompareOptions {
  std::string value, reference;
  std::vector<std::string> metrics, regions;
  float exposure = 0;
  std::string toneMap = "linear";
  std::string map;
};

struct PackOptions {
  std::string target, camera, resolution;
  std::vector<std::string> set;
  bool references = false;
  std::string out;
};

struct BenchOptions {
  std::string experiment, out;
};

struct TuneArguments {
  std::string target, camera, resolution, out = "tune", metric = "relmse", reference = "full";
  std::vector<std::string> techniques, set;
  double budgetMs = 0;
  bool perFrame = false;
  int amortiseFrames = 60, candidates = 16;
  uint32_t seed = 1;
};

int list(const GlobalOptions&, const std::string& what);
int doctor(const GlobalOptions&, const std::string& scene);
int render(const GlobalOptions&, const RenderOptions&);
int reference(const GlobalOptions&, const ReferenceOptions&);
int compare(const GlobalOptions&, const CompareOptions&);
int pack(const GlobalOptions&, const PackOptions&);
int bench(const GlobalOptions&, const BenchOptions&);
int tune(const GlobalOptions&, const TuneArguments&);
int describe(bool markdown, bool schema);

/// The kinds that `list` knows.
const std::vector<std::string>& listKinds();

/// Progress that Ctrl-C cancels (a second one ends the program), shown on stderr where that is a terminal.
std::shared_ptr<Progress> interruptibleProgress(const GlobalOptions&);
/// Where a sweep stands, as a line on stderr.
void showStatus(const SweepStatus&);
/// Ends the line on the terminal.
void finishProgress();

/// Writes all of it to stdout. @throws Error(Run) where it cannot (a full disk).
void print(std::string_view text);
/// One line on stderr, e.g. a warning.
void note(std::string_view text);
/// Precomputation of a second and more is said as it begins, any of it with --verbose: what it casts and keeps, and how long that takes.
void sayRebuilds(const GlobalOptions&, Session&);
/// Messages of the validation layers, where they are on: printed, and the run has failed. Returns the exit code.
int validationVerdict(const GlobalOptions&, Device&, int code);

/// "640x360". @throws Error(BadInput)
void setResolution(Preset&, const std::string& text);
/// KEY=VALUE pairs into the preset's parameters, checked. @throws Error(BadInput)
void setParameters(Preset&, const std::vector<std::string>& pairs);

/// Before any work is done for it: that files can be written into the folder, or that it could be made. Leaves nothing
/// behind. @throws Error(BadInput)
void checkOutputFolder(const std::string& option, const std::filesystem::path& folder);
/// Likewise for one image, by the extension (of those given, in any case) and the folder, which has to be there.
void checkOutputImage(const std::string& option, const std::filesystem::path& file,
                      const std::vector<std::string>& extensions);

}  // namespace hl::cli
