// The tuner's evidence, as JSON and for people.
#include <fmt/format.h>

#include <cmath>

#include "engine/core/json_writer.h"
#include "engine/sweep/tune.h"

namespace hl {
namespace {

void writeTrial(JsonWriter& w, const Trial& t) {
  w.beginObject().member("label", t.label).member("cost_ms", t.costMs).member("cost_p95_ms", t.costP95Ms);
  w.key("error").beginObject().member("mean", t.error.mean).member("ci95", t.error.halfWidth).member("samples", t.error.samples).endObject();
  w.member("within_budget", t.withinBudget).member("default", t.isDefault).key("failed");
  t.failure.empty() ? w.null() : w.text(t.failure);
  w.key("preset").raw(presetJson(t.preset)).endObject();
}

std::string costName(const TuneOptions& o) {
  return o.perFrame ? fmt::format("a frame, with preparation and bake spread over {} frames", o.amortiseFrames)
                    : std::string("preparation, bake and frames until the first that shows the finished work");
}

}  // namespace

std::string tuneJson(const TuneOptions& o, const TuneResult& r) {
  JsonWriter w;
  w.beginObject().member("version", 1).member("budget_ms", o.budgetMs).member("cost", costName(o)).member("metric", o.metric);
  w.member("reference", o.reference).member("drawing_seed", static_cast<int64_t>(o.seed)).key("winner");
  if (const Trial* t = r.winner())
    writeTrial(w, *t);
  else
    w.null();
  w.key("rungs").beginArray();
  for (const Rung& rung : r.rungs) {
    w.beginObject().member("folder", rung.folder).key("seeds").beginArray();
    for (const uint32_t s : rung.seeds) w.whole(s);
    w.endArray().key("trials").beginArray();
    for (const Trial& t : rung.trials) writeTrial(w, t);
    w.endArray().endObject();
  }
  return w.endArray().endObject().str() + "\n";
}

std::string tuneReport(const TuneOptions& o, const TuneResult& r) {
  std::string out = fmt::format("# Least {} against the {} reference within {:g} ms\n\nThe budget is for {}.\n\n", o.metric, o.reference, o.budgetMs, costName(o));
  if (const Trial* t = r.winner())
    out += fmt::format("**{}**: {:.4g} in {:.4g} ms, in `best.json`.\n\n", t->label, t->error.mean, t->costMs);
  else
    out += "Nothing that was tried stays within it.\n\n";
  for (auto rung = r.rungs.rbegin(); rung != r.rungs.rend(); ++rung) {
    out += fmt::format("## {}: {} candidates, {} {}\n\n| candidate | {} | ms (95th percentile) | |\n| --- | --- | --- | --- |\n", rung->folder, rung->trials.size(),
                       rung->seeds.size(), rung->seeds.size() == 1 ? "seed" : "seeds", o.metric);
    for (const Trial& t : rung->trials) {
      std::string remark = !t.failure.empty() ? t.failure : t.withinBudget ? "" : "over the budget";
      if (t.isDefault) remark = remark.empty() ? "as it comes" : fmt::format("as it comes; {}", remark);
      const bool measured = t.error.samples > 0;
      out += fmt::format("| {} | {}{} | {} | {} |\n", t.label, measured ? fmt::format("{:.4g}", t.error.mean) : "",
                         measured && std::isfinite(t.error.halfWidth) ? fmt::format(" ± {:.2g}", t.error.halfWidth) : "",
                         measured ? fmt::format("{:.4g} ({:.4g})", t.costMs, t.costP95Ms) : "", remark);
    }
    out += "\n";
  }
  return out + "Errors are of indirect irradiance; ± is half of a 95 % confidence interval over seeds. Each rung's seeds are new ones.\n";
}

}  // namespace hl
