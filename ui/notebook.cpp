#include "ui/notebook.h"

#include <QJsonArray>
#include <QJsonDocument>
#include <QJsonObject>
#include <algorithm>

#include <fmt/format.h>

namespace hl::ui {
namespace {

QString text(const std::string& s) { return QString::fromStdString(s); }

class Notebook {
 public:
  void markdown(const std::string& source) { cells_.append(QJsonObject{{"id", nextId()}, {"cell_type", "markdown"}, {"metadata", QJsonObject()}, {"source", text(source)}}); }
  /// `pictures`: PNGs as its outputs.
  void code(const std::string& source, const std::vector<const ReportPlot*>& pictures = {}) {
    QJsonArray outputs;
    for (const ReportPlot* p : pictures)
      outputs.append(QJsonObject{{"output_type", "display_data"},
                                 {"metadata", QJsonObject()},
                                 {"data", QJsonObject{{"image/png", QString::fromLatin1(p->png.toBase64())}, {"text/plain", text(p->title)}}}});
    cells_.append(QJsonObject{{"id", nextId()}, {"cell_type", "code"}, {"execution_count", QJsonValue::Null}, {"metadata", QJsonObject()}, {"outputs", outputs}, {"source", text(source)}});
  }
  std::string json() const {
    const QJsonObject kernel{{"display_name", "Python 3"}, {"language", "python"}, {"name", "python3"}};
    const QJsonObject metadata{{"kernelspec", kernel}, {"language_info", QJsonObject{{"name", "python"}}}};
    return QJsonDocument(QJsonObject{{"nbformat", 4}, {"nbformat_minor", 5}, {"metadata", metadata}, {"cells", cells_}}).toJson(QJsonDocument::Indented).toStdString();
  }

 private:
  QString nextId() { return QStringLiteral("cell-%1").arg(cells_.size() + 1); }
  QJsonArray cells_;
};

/// A Python string. JSON's are.
std::string pythonText(const std::string& s) {
  const QByteArray list = QJsonDocument(QJsonArray{text(s)}).toJson(QJsonDocument::Compact);
  return list.mid(1, list.size() - 2).toStdString();
}

std::string list(const std::vector<std::string>& values) {
  std::string out;
  for (const std::string& v : values) out += fmt::format("{}{}", out.empty() ? "" : ", ", pythonText(v));
  return fmt::format("[{}]", out);
}

/// Student's t without SciPy, for few seeds.
constexpr const char* kStatistics = R"py(T95 = [12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262, 2.228]  # two-sided 95 %, by degrees of freedom from 1


def half_width(values):
    """Half of the 95 % confidence interval of a mean; NaN for a single value."""
    n = len(values)
    return np.nan if n < 2 else (T95[n - 2] if n - 2 < len(T95) else 1.96) * values.std(ddof=1) / np.sqrt(n)


def badness(metric, value):
    """Smaller is better, as in the plots: bias by its size, what ssim lacks of 1; psnr by its negative."""
    return abs(value) if metric == "bias" else 1 - value if metric == "ssim" else -value if metric == "psnr" else value


def cost(rows):
    """In ms or bytes."""
    return rows["frame_ms"] + (rows["prepare_ms"] + rows["work_ms"]) / AMORTISE_FRAMES if COST == "amortised_ms" else rows[COST]


def label(rows):
    """What was varied, of a configuration's first row."""
    first = rows.iloc[0]
    return ", ".join([first["technique"]] + [f"{key.split('.')[-1]} {str(first[key]).removesuffix('.0')}" for key in AXES if pd.notna(first[key])])
)py";

constexpr const char* kSelect = R"py(def select(table):
    """Of indirect light over the whole picture, by the metric and against the reference chosen above."""
    return table[(table["problem"] == PROBLEM) & (table["reference"] == REFERENCE) & (table["metric"] == METRIC)
                 & (table["target"] == "image") & (table["component"] == "indirect") & table["roi"].isna()].copy()


chosen = select(results)
runs = chosen[chosen["kind"] == "run"].copy()
runs["cost"] = cost(runs)
points = []
for configuration, rows in runs.groupby("configuration"):
    seeds = rows.groupby("seed")["value"].mean()
    points.append({"configuration": int(configuration), "technique": rows["technique"].iloc[0], "label": label(rows), "cost": rows["cost"].median(),
                   "p5": rows["cost"].quantile(0.05), "p95": rows["cost"].quantile(0.95), "error": badness(METRIC, seeds.mean()), "half": half_width(seeds)})
points = pd.DataFrame(points).sort_values("cost")
points["front"] = [not (((points["cost"] <= p.cost) & (points["error"] <= p.error)) & ((points["cost"] < p.cost) | (points["error"] < p.error))).any() for p in points.itertuples()]
tracer = chosen[chosen["kind"] == "path_tracer"].groupby("frames").agg(cost=("total_ms", "median"), error=("value", "mean"))
tracer["error"] = badness(METRIC, tracer["error"])
tracer = tracer.sort_values("cost")
points)py";

constexpr const char* kSpeed = R"py(fig, ax = plt.subplots(figsize=(8, 5))
for technique, rows in points.groupby("technique"):
    bars = ax.errorbar(rows["cost"], rows["error"], xerr=[rows["cost"] - rows["p5"], rows["p95"] - rows["cost"]], yerr=rows["half"].fillna(0), fmt="o", alpha=0.8, label=technique)
front = points[points["front"]]
ax.step(front["cost"], front["error"], where="post", color="gray", label="Pareto front")
if len(tracer) and COST != "technique_bytes":
    ax.plot(tracer["cost"], tracer["error"], "kx--", label="path tracer (host)")
ax.set_xscale("log")
ax.set_yscale("log" if METRIC != "psnr" else "linear")
ax.set_xlabel(COST)
ax.set_ylabel(f"{METRIC}, {REFERENCE} reference")
ax.set_title(PROBLEM)
ax.legend()
plt.show())py";

constexpr const char* kConvergence = R"py(names = dict(zip(points["configuration"], points["label"]))
history = convergence[(convergence["reference"] == REFERENCE) & (convergence["metric"] == METRIC) & convergence["configuration"].isin(list(names))].copy()
history["error"] = badness(METRIC, history["value"])
fig, axes = plt.subplots(1, 2, figsize=(12, 5), sharey=True)
for (configuration, seed, repeat), rows in history.groupby(["configuration", "seed", "repeat"]):
    for ax, over in zip(axes, ["ms", "frames"]):
        rows = rows[(rows["error"] > 0) | (METRIC == "psnr")].sort_values(over)  # the others have no place on a logarithmic axis
        ax.plot(rows[over], rows["error"], marker=".", color=f"C{int(configuration) % 10}", label=names[configuration] if seed == history["seed"].min() and repeat == 0 and len(names) <= 10 else None)
for ax, over in zip(axes, ["ms", "frames"]):
    ax.set_xscale("log")
    ax.set_yscale("log" if METRIC != "psnr" else "linear")
    ax.set_xlabel(over)
axes[0].set_ylabel(f"{METRIC}, {REFERENCE} reference")
if len(names) <= 10:
    axes[0].legend(fontsize="small")
plt.show())py";

constexpr const char* kPasses = R"py(for name in PASS_TABLES:
    passes = pd.read_csv(name)
    table = passes.pivot_table(index=["configuration", "label"], columns="pass", values="median_ms", sort=False).fillna(0)
    ax = table.plot.barh(stacked=True, figsize=(9, 1.5 + 0.35 * len(table)), colormap="tab20")
    ax.set_yticklabels([label for _, label in table.index])
    ax.invert_yaxis()
    ax.set_ylabel("")
    ax.set_xlabel(f"ms of a {'frame' if passes['during'].iloc[0] == 'frame' else 'unit of work'}")
    ax.legend(fontsize="small", loc="upper left", bbox_to_anchor=(1, 1))
    plt.show())py";

constexpr const char* kParallel = R"py(columns = {}
for key in AXES:
    first = runs.groupby("configuration")[key].first().reindex(points["configuration"])
    values = pd.to_numeric(first, errors="coerce")
    columns[key] = values.to_numpy() if values.notna().any() else pd.Categorical(first).codes.astype(float)
columns[COST] = np.log10(points["cost"].to_numpy())
columns[METRIC] = np.log10(points["error"].where(points["error"] > 0).to_numpy())
fig, ax = plt.subplots(figsize=(2.2 * len(columns), 4.5))
scaled = np.array([(v - np.nanmin(v)) / (np.nanmax(v) - np.nanmin(v)) if np.nanmax(v) > np.nanmin(v) else np.full(len(v), 0.5) for v in columns.values() if np.isfinite(v).any()])
for line, on_front in zip(scaled.T, points["front"]):
    ax.plot(line, color="C0" if on_front else "lightgray", linewidth=2 if on_front else 1, zorder=2 if on_front else 1)
ax.set_xticks(range(len(scaled)), [k for k, v in columns.items() if np.isfinite(v).any()])
ax.set_yticks([0, 1], ["least", "most"])
plt.show())py";

std::vector<const ReportPlot*> startingWith(const Report& report, const std::vector<std::string>& names) {
  std::vector<const ReportPlot*> out;
  for (const ReportPlot& p : report.plots)
    for (const std::string& name : names)
      if (p.nothing.empty() && p.problem == 0 && p.name.find(name) != std::string::npos) out.push_back(&p);
  return out;
}

}  // namespace

std::string notebookJson(const SweepView& view, const Report& report) {
  const SweepResults& r = view.results;
  const Provenance& p = r.provenance;
  Notebook n;
  std::string head = fmt::format("# {} configurations, {} seeds\n\nCommit {}{}, device {}, driver {}, rays by {}.", r.configurations.size(), r.experiment.seeds.size(), p.commit,
                                 p.dirty ? " with changes" : "", p.device, p.driver, p.tracer);
  if (report.missing) head += fmt::format("\n\n**{} of {} runs are missing.**", report.missing, r.plan.size());
  n.markdown(head + "\n\nThe pictures below each cell are halflight's own until it is run; then they are matplotlib's. What is drawn is chosen in the first cell.");
  std::vector<std::string> axes, problems, tables;
  for (size_t i = 0; i < r.problems.size(); ++i) {
    problems.push_back(r.problems[i].label);
    for (const VariedAxis& axis : variedAxes(r, i))
      if (axis.key != "technique" && std::find(axes.begin(), axes.end(), axis.key) == axes.end()) axes.push_back(axis.key);
  }
  for (const ReportPlot* plot : startingWith(report, {"passes_"})) tables.push_back(plot->name + ".csv");
  std::string choices;
  for (const std::string& problem : problems) choices += fmt::format("\n# PROBLEM = {}", pythonText(problem));
  n.code(fmt::format("import matplotlib.pyplot as plt\nimport numpy as np\nimport pandas as pd\n\nresults = pd.read_csv(\"results.csv\")\nconvergence = pd.read_csv(\"convergence.csv\")\n\n"
                     "# What is drawn.\nPROBLEM = {}\nREFERENCE = {}  # of {}\nMETRIC = {}  # of {}\nCOST = \"total_ms\"  # or frame_ms, amortised_ms, technique_bytes\n"
                     "AMORTISE_FRAMES = {}\nAXES = {}\nPASS_TABLES = {}{}",
                     pythonText(problems.front()), pythonText(r.experiment.references.front()), list(r.experiment.references), pythonText(plottedMetrics(r).front()), list(plottedMetrics(r)),
                     r.experiment.amortiseFrames, list(axes), list(tables), problems.size() > 1 ? "\n# All of them:" + choices : ""));
  n.code(std::string(kStatistics));
  n.markdown("## Speed against error");
  n.code(std::string(kSelect));
  n.code(std::string(kSpeed), startingWith(report, {"speed_error-total_ms"}));
  n.markdown("## Error over time and over frames");
  n.code(std::string(kConvergence), startingWith(report, {"convergence_"}));
  n.markdown("## Times by pass");
  n.code(std::string(kPasses), startingWith(report, {"passes_"}));
  n.markdown("## Parallel coordinates");
  n.code(std::string(kParallel), startingWith(report, {"parallel-"}));
  return n.json();
}

}  // namespace hl::ui
