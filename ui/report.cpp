#include "ui/report.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "engine/core/error.h"
#include "engine/core/files.h"
#include "engine/sweep/results_folder.h"
#include "ui/convergence_plot.h"
#include "ui/notebook.h"
#include "ui/palette.h"
#include "ui/parallel_plot.h"
#include "ui/pass_stack_plot.h"
#include "ui/plot_export.h"
#include "ui/speed_error_plot.h"

namespace hl::ui {
namespace {

namespace fs = std::filesystem;

constexpr const char* kCostTitles[] = {"per frame", "until settled", "per frame with the bake spread", "memory"};

/// Only what is written by name in the folder, whole or not at all.
class Writer {
 public:
  Writer(const SweepView& view, fs::path out, Report& report) : view_(view), out_(std::move(out)), report_(report) {}

  void file(const std::string& name, std::string_view bytes) {
    writeFileAtomically(out_ / name, bytes);
    report_.files.push_back(name);
  }
  void file(const std::string& name, const QByteArray& bytes) { file(name, std::string_view(bytes.data(), static_cast<size_t>(bytes.size()))); }

  void plot(SweepPlot& plot, const PlotChoice& choice, const std::string& name, const std::string& title) {
    plot.setView(std::shared_ptr<const SweepView>(std::shared_ptr<void>(), &view_), choice);
    plot.drawNow();
    ReportPlot p;
    p.name = view_.results.problems.size() > 1 ? fmt::format("problem_{}-{}", choice.problem + 1, name) : name;
    p.title = title, p.problem = choice.problem;
    p.nothing = plot.nothing().toStdString(), p.note = plot.note().toStdString();
    if (p.nothing.empty()) {
      const QSize size = plot.pictureSize();
      const QString said = QString::fromStdString(fmt::format("{}: {}", view_.results.problems[choice.problem].label, title));
      p.png = plotPng(plot.plot(), plot, size, {{QStringLiteral("Title"), said}, {QStringLiteral("Description"), QString::fromStdString(provenanceJson(view_.results.provenance))}});
      file(p.name + ".png", p.png);
      file(p.name + ".pdf", plotPdf(plot.plot(), plot, size, said));
      file(p.name + ".csv", plot.csv());
    }
    report_.plots.push_back(std::move(p));
  }

 private:
  const SweepView& view_;
  fs::path out_;
  Report& report_;
};

void checkTables(const fs::path& folder) {
  const fs::path file = folder / "results.json";
  if (!fs::exists(file)) return;  // a sweep that was killed has none yet
  try {
    const nlohmann::json d = nlohmann::json::parse(readFile(file));
    if (!d.is_object() || !d.contains("runs") || !d.contains("configurations")) throw badInput(fmt::format("{}: no table of a sweep: the same `halflight-cli bench` writes it again", file.string()));
  } catch (const nlohmann::json::exception& e) {
    throw badInput(fmt::format("{}: damaged ({}): the same `halflight-cli bench` writes it again", file.string(), e.what()));
  }
}

/// Everything that a PlotChoice can say, without saying the same twice: all costs by the first metric, the other metrics by the time until settled.
void writePlots(Writer& write, const SweepView& view, PassPalette& techniques, PassPalette& passes) {
  const SweepResults& r = view.results;
  const std::vector<std::string> metrics = plottedMetrics(r);
  SpeedErrorPlot speed(techniques);
  ConvergencePlot overTime(ConvergencePlot::Over::Time), overFrames(ConvergencePlot::Over::Frames);
  PassStackPlot ofFrame(PassStackPlot::Of::Frame, passes), ofWork(PassStackPlot::Of::Work, passes);
  ParallelPlot parallel(techniques);
  for (size_t problem = 0; problem < r.problems.size(); ++problem) {
    for (const std::string& reference : r.experiment.references)
      for (const std::string& metric : metrics)
        for (const FrontAxis cost : {FrontAxis::Total, FrontAxis::Frame, FrontAxis::Amortised, FrontAxis::Memory})
          if (metric == metrics.front() || cost == FrontAxis::Total)
            write.plot(speed, {problem, reference, metric, cost}, fmt::format("speed_error-{}-{}-{}", kFrontAxes[static_cast<size_t>(cost)], reference, metric),
                       fmt::format("Speed against error: {}, {}, {} reference", kCostTitles[static_cast<size_t>(cost)], metric, reference));
    for (const std::string& reference : r.experiment.references) {
      const PlotChoice choice{problem, reference, metrics.front(), FrontAxis::Total};
      write.plot(overTime, choice, fmt::format("convergence_ms-{}-{}", reference, metrics.front()), fmt::format("Error over time: {}, {} reference", metrics.front(), reference));
      write.plot(overFrames, choice, fmt::format("convergence_frames-{}-{}", reference, metrics.front()), fmt::format("Error over frames: {}, {} reference", metrics.front(), reference));
    }
    const PlotChoice choice{problem, r.experiment.references.front(), metrics.front(), FrontAxis::Total};
    write.plot(ofFrame, choice, "passes_frame", "Times of a frame by pass");
    write.plot(ofWork, choice, "passes_work", "Times of a unit of the bake by pass");
    for (const std::string& reference : r.experiment.references)
      write.plot(parallel, {problem, reference, metrics.front(), FrontAxis::Total}, fmt::format("parallel-{}-{}", reference, metrics.front()),
                 fmt::format("Parallel coordinates: until settled, {}, {} reference", metrics.front(), reference));
  }
}

}  // namespace

std::shared_ptr<const SweepView> openResults(const fs::path& folder) {
  if (!fs::is_directory(folder)) throw badInput(fmt::format("{}: {}: a folder that `halflight-cli bench` has written is wanted", folder.string(), fs::exists(folder) ? "no folder" : "there is none"));
  auto view = std::make_shared<SweepView>();
  view->results = openSweep(folder);
  checkTables(folder);
  if (view->results.done() == 0) throw badInput(fmt::format("{}: none of its {} runs is done: `halflight-cli bench` makes them", folder.string(), view->results.plan.size()));
  view->summary = summarise(view->results);
  return view;
}

Report writeReport(const SweepView& view, const fs::path& out, Settings* settings) {
  std::error_code failed;
  fs::create_directories(out, failed);
  if (failed || !fs::is_directory(out)) throw badInput(fmt::format("{}: the folder cannot be made: {}", out.string(), failed ? failed.message() : "something else has its name"));
  if (fs::exists(out / "experiment.json")) throw badInput(fmt::format("{}: a folder of results, whose own report.md would be overwritten: another one is wanted, by default report/ in it", out.string()));
  Report report;
  report.missing = view.results.plan.size() - view.results.done();
  report.failed = view.results.failed();
  Writer write(view, out, report);
  PassPalette techniques = techniquePalette(settings), passes(settings);
  write.file("results.csv", sweepCsv(view.results));
  write.file("convergence.csv", convergenceCsv(view.results));
  writePlots(write, view, techniques, passes);
  write.file("report.ipynb", notebookJson(view, report));
  write.file("report.md", reportMarkdown(view, report));
  return report;
}

std::string reportMarkdown(const SweepView& view, const Report& report) {
  const SweepResults& r = view.results;
  std::string out = "# Plots\n\n";
  if (report.missing) out += fmt::format("**{} of {} runs are missing**: `halflight-cli bench` goes on where it was.\n\n", report.missing, r.plan.size());
  if (report.failed) out += fmt::format("**{} runs failed**; results.csv says why.\n\n", report.failed);
  out += "All of them as PNG, PDF and the data as CSV. `report.ipynb` draws them again with pandas and matplotlib, from `results.csv`, `convergence.csv` and the tables of passes beside it. "
         "What the sweep says in tables follows below.\n\n";
  for (size_t problem = 0; problem < r.problems.size(); ++problem) {
    out += fmt::format("## {}\n\n", r.problems[problem].label);
    for (const ReportPlot& p : report.plots) {
      if (p.problem != problem) continue;
      out += fmt::format("### {}\n\n", p.title);
      if (!p.nothing.empty()) {
        out += fmt::format("Not drawn: {}\n\n", p.nothing);
        continue;
      }
      out += fmt::format("![{0}]({1}.png)\n\n[PNG]({1}.png), [PDF]({1}.pdf), [CSV]({1}.csv){2}\n\n", p.title, p.name, p.note.empty() ? "" : ". " + p.note);
    }
  }
  return out + sweepReport(r, view.summary);
}

}  // namespace hl::ui
