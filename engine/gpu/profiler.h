#pragma once
// What each pass took, and its statistics over frames.
#include <cstdint>
#include <deque>
#include <map>
#include <string>
#include <vector>

namespace hl {

struct PassTiming {
  std::string name;
  bool host = false;  ///< ran on the host, between submissions
  double ms = 0;
  double creationMs = 0;  ///< pipeline creation that this execute had to do, apart from `ms`
  std::string skipped;    ///< why it was not recorded, or ""
};

struct BatchTimings {
  std::vector<PassTiming> passes;
  double wallMs = 0;        ///< from first submission to last fence, host passes included
  bool serialised = false;  ///< passes were submitted apart and timed by the wall clock (a CPU device's timestamps say little)
  /// Share of the wall time that is in no pass (MEASURES.md section 4 wants it below a tenth); negative where passes
  /// overlapped.
  double unaccounted() const;
};

struct PassStatistics {
  std::string name, where;  ///< "gpu" or "host"
  double medianMs = 0, p5Ms = 0, p95Ms = 0, lastMs = 0;  ///< over the latest frames in which it ran, as many as the profiler's window
  std::string skipped;
  double meanMs = 0;  ///< over the same
  double share = 1;   ///< of the window's frames, less warm-up, those in which it ran
  double frameMs = 0; ///< its time in the window's frames over their number: what it costs a frame on average
};

/// Keeps the last `window` frames; order of passes is that of the newest frame, and what ran in the window's other frames only stands where it stood there.
/// The first time a pass runs is warm-up and left out.
class Profiler {
 public:
  explicit Profiler(size_t window = 120) : window_(window) {}
  void add(const BatchTimings&);
  void clear();
  /// Forgets the times so far, and not what has run already: the next frame counts.
  void forgetTimes();
  std::vector<PassStatistics> passes() const;
  PassStatistics frame() const;  ///< wall time of whole batches, named "frame"
  double unaccounted() const;    ///< median of BatchTimings::unaccounted over the frames kept
  uint64_t frames() const { return frames_; }

 private:
  /// How many of the window's frames count for a pass, in how many of them it ran, and its time in these [ms].
  struct InWindow {
    uint64_t frames = 0, ran = 0;
    double ms = 0;
  };
  InWindow inWindow(const std::string& pass) const;
  size_t window_;
  uint64_t frames_ = 0;
  std::vector<PassTiming> order_;
  std::map<std::string, std::deque<double>> history_;
  std::map<std::string, std::deque<uint64_t>> ran_;  ///< numbers of history_'s frames
  std::map<std::string, uint64_t> seen_;
  std::map<std::string, uint64_t> warm_;  ///< the first frame that counts
  std::deque<double> wall_, unaccounted_;
};

}  // namespace hl
