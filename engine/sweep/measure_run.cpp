// One run of a sweep: load, bring the reference, work until the stop rule says so, measure, time.
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <chrono>
#include <new>
#include <thread>

#include "engine/core/error.h"
#include "engine/core/image_io.h"
#include "engine/session/run_limit.h"
#include "engine/sweep/sweep.h"

namespace hl {
namespace {

// Frames that are timed after the picture is made, at least and at most, and how long at most (MEASURES.md section 4).
constexpr int kLeastTimedFrames = 8, kTimedFrames = 32;
constexpr double kTimingBudgetMs = 2000;
// How often the clock is looked at where a run is limited. By the clock it also measures and times frames: what that may take, of the limit and besides.
constexpr int kLimitPollMs = 5;
constexpr double kLimitSlack = 0.5, kLimitSlackMs = 3000;

double nowMs() { return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

using FramePointer = std::shared_ptr<const FrameResult>;

double usedMs(const FrameResult& f) { return f.prepareMs + f.sinceResetMs; }

/// What the plot of error over time shows: indirect light of the whole picture.
ErrorAt pointOf(uint32_t frames, double ms, const std::vector<ErrorValue>& errors, const std::vector<std::string>& metrics) {
  ErrorAt out{frames, ms, {}};
  for (const ErrorValue& e : errors)
    if (e.roi.empty() && e.component == "indirect" && std::find(metrics.begin(), metrics.end(), e.metric) != metrics.end()) out.errors.push_back(e);
  return out;
}

/// Until the stop rule says so. Errors on the way, at frame counts that double, go to the record.
FramePointer runUntilStop(Session& session, const Experiment& e, const std::vector<std::string>& metrics, RunRecord& record, Progress& p) {
  if (e.stop.kind == StopRule::Kind::Settled) {
    session.setReferenceWanted(true);  // it is there already: the session then follows the error while long work runs
    FramePointer f = session.settle(&p, e.limitMs);
    session.setReferenceWanted(false);
    for (const ConvergencePoint& c : *f->convergence)
      record.convergence.push_back(pointOf(static_cast<uint32_t>(c.frame), f->prepareMs + c.shownMs, c.errors, metrics));
    record.frames = f->settledFrames;
    record.totalMs = f->prepareMs + f->settledMs;
    return f;
  }
  const bool frames = e.stop.kind == StopRule::Kind::Frames;
  if (frames) session.finishWork(&p, e.limitMs);  // by slices of time, how far the work is after N frames would depend on the machine
  FramePointer f;
  do {
    p.check();
    f = session.frame(&p);
    if (std::has_single_bit(f->frame)) record.convergence.push_back(pointOf(f->frame, usedMs(*f), session.measureErrors(metrics), metrics));
  } while (!f->techniqueFailed && !(e.limitMs > 0 && usedMs(*f) > e.limitMs) && (frames ? f->frame < static_cast<uint32_t>(e.stop.amount) : usedMs(*f) < e.stop.amount));
  record.frames = f->frame;
  record.totalMs = usedMs(*f);
  return f;
}

/// Cancels `inner` when `outer` is cancelled, or when the time is up.
class TimeLimit {
 public:
  TimeLimit(Progress& outer, Progress& inner, double ms)
      : watch_([this, &outer, &inner, ms](const std::stop_token& stop) {
          const double start = nowMs();
          while (!stop.stop_requested() && !inner.cancelled()) {
            if (outer.cancelled()) inner.cancel();
            if (ms > 0 && nowMs() - start > ms) up_ = true, inner.cancel();
            std::this_thread::sleep_for(std::chrono::milliseconds(kLimitPollMs));
          }
        }) {}
  bool up() const { return up_; }

 private:
  std::atomic<bool> up_{false};
  std::jthread watch_;
};

/// Where runs are limited, ended by the clock as well: a unit of work, or a frame, could take for ever.
FramePointer runWithin(Session& session, const Experiment& e, const std::vector<std::string>& metrics, RunRecord& record, Progress& p) {
  if (!(e.limitMs > 0)) return runUntilStop(session, e, metrics, record, p);
  const double most = (1 + kLimitSlack) * e.limitMs + kLimitSlackMs;
  Progress inner;
  const TimeLimit limit(p, inner, most);
  try {
    return runUntilStop(session, e, metrics, record, inner);
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::Cancelled || !limit.up() || p.cancelled()) throw;
    throw LimitError(fmt::format("ended after {:.0f} ms by the clock; the limit is {:.0f} ms", most, e.limitMs));
  }
}

/// More frames of what is there, for their times alone.
FramePointer timeFrames(Session& session, Progress& p) {
  session.setWorkPaused(true);
  session.forgetTimes();  // of a cache that has settled in the meantime, say
  FramePointer f;
  const double start = nowMs();
  for (int i = 0; i < kTimedFrames && (i < kLeastTimedFrames || nowMs() - start < kTimingBudgetMs); ++i) {
    p.check();
    f = session.frame(&p);
  }
  session.setWorkPaused(false);
  return f;
}

/// Of a frame on average, whatever runs in some frames only.
double ownPasses(const FrameResult& f) {
  double sum = 0;
  for (const PassStatistics& pass : f.passes)
    if (pass.name.starts_with(f.preset.technique + ":")) sum += pass.frameMs;
  return sum;
}

void takeMemory(const FrameResult& f, RunRecord& record) {
  for (const MemoryItem& m : f.memory) {
    if (m.name == "device: all blocks") record.deviceBytes = m.bytes;
    if (m.name.starts_with(f.preset.technique + ":")) record.techniqueBytes += m.bytes;
  }
}

void writePicture(const std::filesystem::path& file, Image image, const FrameResult& f) {
  std::filesystem::create_directories(file.parent_path());
  image.metadata = imageAttributes(f.preset, f.provenance);
  writeImage(file, image);
}

void measure(Session& session, const Experiment& e, const PlannedRun& run, const std::filesystem::path& variancePicture,
             const std::filesystem::path& picture, const std::filesystem::path& comparedWith, Progress& p, RunRecord& record, RunResults& results) {
  const std::vector<std::string> metrics = measuredMetrics(e);
  session.setReferenceWanted(false);
  session.load(run.preset, &p);
  // Not the run's own work, so no part of its limit. Where the scene's time runs, of what is seen when it has stopped, and of nothing on the way.
  const bool plays = run.preset.animation.play;
  if (!plays) session.reference("image", &p);
  const FramePointer made = runWithin(session, e, metrics, record, p);
  const Transport t = session.transport();
  record.transport = fmt::format("{} bounces, {} faces, {} normals", t.bounces, t.frontFacesOnly ? "front" : "all",
                                 t.receiver == ReceiverNormal::Mapped ? "mapped" : t.receiver == ReceiverNormal::Geometric ? "geometric" : "mapped receivers' and geometric");
  record.provenance = made->provenance;
  results.frame = made;
  // What the clock has ended within a frame is no cancelling of the sweep.
  if (made->techniqueFailed && made->failure == ErrorKind::Cancelled && !p.cancelled()) throw LimitError(made->message);
  if (made->techniqueFailed) throw Error(made->failure, made->message);
  if (e.limitMs > 0 && record.totalMs > e.limitMs) throw LimitError(fmt::format("took {:.0f} ms; the limit is {:.0f} ms", record.totalMs, e.limitMs));

  if (plays) session.reference("image", &p);
  record.errors = results.errors = session.measureErrors(metrics);
  if (measuresLightmap(e) && session.technique().needs().lightmap) {
    session.reference("lightmap", &p);
    for (const ErrorValue& v : session.measureErrors(metrics, "lightmap")) record.errors.push_back(v), results.errors.push_back(v);
  }
  if (!comparedWith.empty()) {
    if (!std::filesystem::exists(comparedWith)) throw Error(ErrorKind::Run, fmt::format("{}: there is no picture of the run that this one is compared with; it has failed", comparedWith.string()));
    for (const ErrorValue& v : session.measureErrorsBetween(session.image("indirect_irradiance"), readImage(comparedWith), metrics, kOwnRun)) record.errors.push_back(v), results.errors.push_back(v);
  }
  record.surfacePixels = session.surfacePixels();
  record.imageHash = results.imageHash = hashOfImage(session.image("final"));
  if (!variancePicture.empty()) writePicture(variancePicture, session.image("indirect_irradiance"), *made);
  if (!picture.empty()) writePicture(picture, session.image("final"), *made);
  // Frames after the one that counts only add samples of direct light: the run's own point is the last.
  while (!record.convergence.empty() && record.convergence.back().frames >= record.frames) record.convergence.pop_back();
  record.convergence.push_back(pointOf(record.frames, record.totalMs, record.errors, metrics));

  const FramePointer timed = e.stop.kind == StopRule::Kind::Settled ? made : timeFrames(session, p);
  auto whole = std::make_shared<FrameResult>(*made);
  whole->frameTime = timed->frameTime, whole->passes = timed->passes, whole->unaccounted = timed->unaccounted;
  auto history = std::make_shared<std::vector<ConvergencePoint>>();
  for (const ErrorAt& at : record.convergence) history->push_back({at.frames, at.ms, at.ms, at.errors});
  whole->convergence = history;
  results.frame = whole;
  record.frameTime = whole->frameTime, record.unaccounted = whole->unaccounted;
  record.passes = whole->passes, record.workPasses = whole->workPasses;
  record.techniqueMs = ownPasses(*whole);
  for (const auto& [name, bytes] : whole->bytesMoved) record.passBytes[name] = static_cast<double>(bytes);
  for (const auto& [name, count] : whole->counters) record.counters[name] = count;
  record.prepareMs = whole->prepareMs, record.workMs = whole->workMs;
  takeMemory(*whole, record);
  uint64_t nonFinite = 0;
  for (const ErrorValue& v : record.errors) nonFinite = std::max(nonFinite, v.nonFinite);
  if (nonFinite) throw Error(ErrorKind::Run, fmt::format("{} pixels are NaN or infinite: the comparison fails", nonFinite));
}

}  // namespace

RunRecord measureRun(Session& session, const Experiment& e, const PlannedRun& run, const std::filesystem::path& variancePicture,
                     const std::filesystem::path& picture, Progress& p, RunResults& results, const std::filesystem::path& comparedWith) {
  const double began = nowMs();
  RunRecord record;
  record.key = run.key, record.seed = run.seed, record.repeat = run.repeat;
  record.cpuDevice = session.device().isCpu(), record.hostThreads = session.hostThreads();
  const auto fail = [&](const std::string& why) {
    session.setReferenceWanted(false);
    session.setWorkPaused(false);
    record.failed = why.empty() ? "failed without a message" : why;
    if (record.provenance.commit.empty()) record.provenance = session.provenance();
  };
  try {
    measure(session, e, run, variancePicture, picture, comparedWith, p, record, results);
  } catch (const Error& error) {
    if (error.kind() == ErrorKind::Cancelled || error.kind() == ErrorKind::Device) {
      session.setReferenceWanted(false);
      session.setWorkPaused(false);
      throw;
    }
    record.badInput = error.kind() == ErrorKind::BadInput;
    record.overLimit = dynamic_cast<const LimitError*>(&error) != nullptr;
    fail(error.what());
  } catch (const std::bad_alloc&) {
    fail("out of memory");
  }
  record.seconds = (nowMs() - began) / 1000;
  return record;
}

}  // namespace hl
