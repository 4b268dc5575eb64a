#include "ui/sweep_plots.h"

#include <QComboBox>
#include <QHBoxLayout>
#include <QTabWidget>
#include <QVBoxLayout>

#include "engine/metrics/metrics.h"
#include "ui/convergence_plot.h"
#include "ui/parallel_plot.h"
#include "ui/pass_stack_plot.h"
#include "ui/speed_error_plot.h"

namespace hl::ui {
namespace {

/// The entries of `choices` anew, the one with `data` chosen; the first where there is none.
void fill(QComboBox& box, const std::vector<std::pair<QString, QVariant>>& choices, const QVariant& data) {
  const QSignalBlocker quiet(&box);
  box.clear();
  for (const auto& [text, id] : choices) box.addItem(text, id);
  box.setCurrentIndex(std::max(0, box.findData(data)));
  box.setEnabled(box.count() > 1);
}

QString text(std::string_view s) { return QString::fromUtf8(s.data(), static_cast<qsizetype>(s.size())); }

}  // namespace

SweepPlots::SweepPlots(PassPalette& passes, Settings* settings, QWidget* parent)
    : QWidget(parent), techniques_(techniquePalette(settings)), problem_(new QComboBox(this)), cost_(new QComboBox(this)), metric_(new QComboBox(this)),
      reference_(new QComboBox(this)), pages_(new QTabWidget(this)), speedError_(new SpeedErrorPlot(techniques_, this)) {
  auto* column = new QVBoxLayout(this);
  column->setContentsMargins(0, 0, 0, 0);
  auto* line = new QHBoxLayout;
  cost_->addItem(tr("until settled"), static_cast<int>(FrontAxis::Total));
  cost_->addItem(tr("per frame"), static_cast<int>(FrontAxis::Frame));
  cost_->addItem(tr("per frame, bake spread"), static_cast<int>(FrontAxis::Amortised));
  cost_->addItem(tr("memory"), static_cast<int>(FrontAxis::Memory));
  for (const auto& [box, name] : std::initializer_list<std::pair<QComboBox*, QString>>{{problem_, tr("Problem")}, {cost_, tr("Cost")}, {metric_, tr("Metric")}, {reference_, tr("Reference")}}) {
    box->setAccessibleName(name);
    box->setToolTip(name);
    box->setSizeAdjustPolicy(QComboBox::AdjustToMinimumContentsLengthWithIcon);
    box->setMinimumContentsLength(box == problem_ ? 14 : 8);
    line->addWidget(box, box == problem_ ? 2 : 1);
    connect(box, &QComboBox::activated, this, &SweepPlots::readChoices);
  }
  column->addLayout(line);
  pages_->setDocumentMode(true);
  column->addWidget(pages_, 1);
  const auto add = [&](SweepPlot* plot, const QString& title) {
    plots_.push_back(plot);
    pages_->addTab(plot, title);
    connect(plot, &SweepPlot::chosen, this, [this](size_t configuration) {
      select(configuration);
      emit chosen(configuration);
    });
  };
  add(speedError_, tr("Speed against error"));
  add(new ConvergencePlot(ConvergencePlot::Over::Time, this), tr("Over time"));
  add(new ConvergencePlot(ConvergencePlot::Over::Frames, this), tr("Over frames"));
  add(new PassStackPlot(PassStackPlot::Of::Frame, passes, this), tr("Passes of a frame"));
  add(new PassStackPlot(PassStackPlot::Of::Work, passes, this), tr("Passes of the bake"));
  add(new ParallelPlot(techniques_, this), tr("Parallel coordinates"));
  fillChoices();
}

void SweepPlots::setView(std::shared_ptr<const SweepView> view) {
  const bool first = !view_ && view;
  view_ = std::move(view);
  if (first && !view_->results.experiment.metrics.empty()) choice_.metric = view_->results.experiment.metrics.front();
  if (view_ && choice_.problem >= view_->results.problems.size()) choice_.problem = 0;
  fillChoices();
  showChoices();
}

void SweepPlots::select(std::optional<size_t> configuration) {
  for (SweepPlot* p : plots_) p->select(configuration);
}

void SweepPlots::fillChoices() {
  std::vector<std::pair<QString, QVariant>> problems, metrics, references;
  if (view_) {
    const SweepResults& r = view_->results;
    for (size_t i = 0; i < r.problems.size(); ++i) problems.emplace_back(QString::fromStdString(r.problems[i].label), static_cast<int>(i));
    for (const std::string& m : plottedMetrics(r)) metrics.emplace_back(text(metricInfo(m).label), QString::fromStdString(m));
    for (const std::string& f : r.experiment.references) references.emplace_back(f == "full" ? tr("full reference") : tr("matched reference"), QString::fromStdString(f));
  }
  fill(*problem_, problems, static_cast<int>(choice_.problem));
  fill(*metric_, metrics, QString::fromStdString(choice_.metric));
  fill(*reference_, references, QString::fromStdString(choice_.reference));
  cost_->setEnabled(view_ != nullptr);
  if (!view_) return;
  choice_.problem = static_cast<size_t>(std::max(0, problem_->currentData().toInt()));
  choice_.metric = metric_->currentData().toString().toStdString();
  choice_.reference = reference_->currentData().toString().toStdString();
}

void SweepPlots::readChoices() {
  choice_.problem = static_cast<size_t>(std::max(0, problem_->currentData().toInt()));
  choice_.cost = static_cast<FrontAxis>(cost_->currentData().toInt());
  choice_.metric = metric_->currentData().toString().toStdString();
  choice_.reference = reference_->currentData().toString().toStdString();
  showChoices();
  emit choiceChanged();
}

void SweepPlots::choose(const PlotChoice& choice) {
  choice_ = choice;
  cost_->setCurrentIndex(std::max(0, cost_->findData(static_cast<int>(choice.cost))));
  fillChoices();
  showChoices();
  emit choiceChanged();
}

void SweepPlots::showChoices() {
  for (SweepPlot* p : plots_) p->setView(view_, choice_);
}

}  // namespace hl::ui
