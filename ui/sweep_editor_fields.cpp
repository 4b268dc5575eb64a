// The fields of an experiment, and how they are laid out.
#include <QBoxLayout>
#include <QCheckBox>
#include <QComboBox>
#include <QCompleter>
#include <QDoubleSpinBox>
#include <QFileDialog>
#include <QFormLayout>
#include <QLabel>
#include <QLineEdit>
#include <QMenu>
#include <QPushButton>
#include <QSpinBox>
#include <QToolButton>

#include "engine/metrics/metrics.h"
#include "ui/sweep_axis_row.h"
#include "ui/sweep_editor.h"

namespace hl::ui {
namespace {

QString fromView(std::string_view s) { return QString::fromUtf8(s.data(), static_cast<qsizetype>(s.size())); }

}  // namespace

FieldError* SweepEditor::errorLine(const QString& field, QWidget* parent) {
  auto* line = new FieldError(parent);
  errors_[field] = line;
  return line;
}

QLayout* SweepEditor::makeFiles() {
  auto* line = new QHBoxLayout;
  auto* open = new QToolButton(this);
  open->setText(tr("Open"));
  open->setToolTip(tr("An experiment's file, as halflight-cli bench takes it; or one that came with the program"));
  open->setPopupMode(QToolButton::InstantPopup);
  auto* menu = new QMenu(open);
  menu->addAction(tr("&File..."), this, [this] {
    auto* dialog = new QFileDialog(this, tr("Open experiment"), settings_.value(QStringLiteral("lastFolder")).toString(), tr("Experiments (*.json)"));
    dialog->setAttribute(Qt::WA_DeleteOnClose);
    dialog->setFileMode(QFileDialog::ExistingFile);
    connect(dialog, &QFileDialog::fileSelected, this, &SweepEditor::openExperiment);
    dialog->open();
  });
  shipped_ = menu->addMenu(tr("&Shipped"));
  shipped_->setToolTipsVisible(true);
  open->setMenu(menu);
  auto* save = new QPushButton(tr("Save as..."), this);
  save->setToolTip(tr("The file that halflight-cli bench runs"));
  connect(save, &QPushButton::clicked, this, [this] {
    auto* dialog = new QFileDialog(this, tr("Save experiment"), settings_.value(QStringLiteral("lastFolder")).toString(), tr("Experiments (*.json)"));
    dialog->setAttribute(Qt::WA_DeleteOnClose);
    dialog->setAcceptMode(QFileDialog::AcceptSave);
    dialog->setDefaultSuffix(QStringLiteral("json"));
    dialog->selectFile(name() + QStringLiteral(".json"));
    connect(dialog, &QFileDialog::fileSelected, this, &SweepEditor::saveTo);
    dialog->open();
  });
  name_ = new QLineEdit(tr("sweep"), this);
  name_->setObjectName(QStringLiteral("sweepName"));
  name_->setAccessibleName(tr("Name of the experiment"));
  auto* label = new QLabel(tr("&Name"), this);
  label->setBuddy(name_);
  connect(name_, &QLineEdit::textEdited, this, &SweepEditor::followName);
  line->addWidget(open);
  line->addWidget(save);
  line->addWidget(label);
  line->addWidget(name_, 1);
  return line;
}

QWidget* SweepEditor::makeAxes() {
  auto* box = new QWidget(this);
  auto* column = new QVBoxLayout(box);
  column->setContentsMargins(0, 0, 6, 0);
  column->setSpacing(3);
  auto* baseLine = new QHBoxLayout;
  base_ = new QComboBox(box);
  base_->setObjectName(QStringLiteral("sweepBase"));
  base_->setAccessibleName(tr("Base"));
  base_->setToolTip(tr("What is varied: the window's experiment as it stands at the start, or a preset of a file"));
  base_->setSizeAdjustPolicy(QComboBox::AdjustToMinimumContentsLengthWithIcon);
  base_->setMinimumContentsLength(14);
  auto* baseLabel = new QLabel(tr("&Base"), box);
  baseLabel->setBuddy(base_);
  baseLine->addWidget(baseLabel);
  baseLine->addWidget(base_, 1);
  column->addLayout(baseLine);
  column->addWidget(errorLine(QStringLiteral("base"), box));

  auto* addLine = new QHBoxLayout;
  keys_ = new QComboBox(box);
  keys_->setObjectName(QStringLiteral("sweepKey"));
  keys_->setEditable(true);
  keys_->setInsertPolicy(QComboBox::NoInsert);
  keys_->setAccessibleName(tr("Parameter to vary"));
  keys_->setToolTip(tr("Parts of its name will do. Or \"Sweep this parameter\", by a right click on a name in the Technique dock"));
  keys_->lineEdit()->setPlaceholderText(tr("Search a parameter"));
  keys_->setSizeAdjustPolicy(QComboBox::AdjustToMinimumContentsLengthWithIcon);
  keys_->setMinimumContentsLength(14);
  keys_->completer()->setCompletionMode(QCompleter::PopupCompletion);
  keys_->completer()->setFilterMode(Qt::MatchContains);
  keys_->completer()->setCaseSensitivity(Qt::CaseInsensitive);
  auto* label = new QLabel(tr("&Vary"), box);
  label->setBuddy(keys_);
  auto* add = new QPushButton(tr("&Add"), box);
  add->setObjectName(QStringLiteral("addAxis"));
  addLine->addWidget(label);
  addLine->addWidget(keys_, 1);
  addLine->addWidget(add);
  const auto addTyped = [this] {
    const std::string key = keys_->currentText().trimmed().toStdString();
    if (key.empty()) return;
    addAxis(key);
    keys_->setEditText({});
  };
  connect(add, &QPushButton::clicked, this, addTyped);
  connect(keys_->lineEdit(), &QLineEdit::returnPressed, this, addTyped);
  connect(keys_, &QComboBox::activated, this, addTyped);
  column->addLayout(addLine);

  auto* setLine = new QHBoxLayout;
  setChooser_ = new QComboBox(box);
  setChooser_->setObjectName(QStringLiteral("sweepSet"));
  setChooser_->setAccessibleName(tr("Set of axes"));
  setChooser_->setToolTip(tr("All combinations of a set's values are run. The combinations of several sets are added up: for techniques with knobs of their own"));
  auto* addSet = new QToolButton(box);
  addSet->setText(QStringLiteral("+"));
  addSet->setToolTip(tr("A further set of axes"));
  addSet->setAccessibleName(tr("Add a set of axes"));
  removeSet_ = new QToolButton(box);
  removeSet_->setText(QStringLiteral("\u2212"));
  removeSet_->setToolTip(tr("Without this set"));
  removeSet_->setAccessibleName(tr("Remove this set of axes"));
  setLine->addWidget(setChooser_);
  setLine->addWidget(addSet);
  setLine->addWidget(removeSet_);
  setLine->addStretch(1);
  connect(setChooser_, &QComboBox::activated, this, [this](int at) {
    keepSet();
    showSet(at);
  });
  connect(addSet, &QToolButton::clicked, this, [this] {
    keepSet();
    sets_.emplace_back();
    showSet(static_cast<int>(sets_.size()) - 1);
    edited();
  });
  connect(removeSet_, &QToolButton::clicked, this, [this] {
    sets_.erase(sets_.begin() + static_cast<std::ptrdiff_t>(set_));
    if (sets_.empty()) sets_.emplace_back();
    showSet(std::max(0, static_cast<int>(set_) - 1));
    edited();
  });
  column->addLayout(setLine);
  axes_ = new QVBoxLayout;
  axes_->setSpacing(2);
  noAxes_ = new QLabel(tr("Nothing is varied yet: the base alone is run, once for each seed."), box);
  noAxes_->setWordWrap(true);
  noAxes_->setForegroundRole(QPalette::PlaceholderText);
  axes_->addWidget(noAxes_);
  column->addLayout(axes_);
  column->addWidget(errorLine(QStringLiteral("axis"), box));
  column->addStretch(1);
  return box;
}

QLayout* SweepEditor::makeSeeds(QWidget* box) {
  auto* line = new QHBoxLayout;
  seeds_ = new QLineEdit(box);
  seeds_->setObjectName(QStringLiteral("sweepSeeds"));
  seeds_->setAccessibleName(tr("Seeds"));
  seeds_->setToolTip(tr("1, 2, 3 or 1..4. Each configuration is run with each: the spread over them makes the error bars"));
  repeats_ = new QSpinBox(box);
  repeats_->setObjectName(QStringLiteral("sweepRepeats"));
  repeats_->setRange(1, 1000);
  repeats_->setAccessibleName(tr("Repeats"));
  repeats_->setToolTip(tr("Of every configuration and seed, for times: errors are the same each time"));
  auto* label = new QLabel(tr("Re&peats"), box);
  label->setBuddy(repeats_);
  line->addWidget(seeds_, 1);
  line->addWidget(label);
  line->addWidget(repeats_);
  connect(seeds_, &QLineEdit::textEdited, this, &SweepEditor::edited);
  connect(repeats_, &QSpinBox::valueChanged, this, &SweepEditor::edited);
  return line;
}

QLayout* SweepEditor::makeStop(QWidget* box) {
  auto* line = new QHBoxLayout;
  stop_ = new QComboBox(box);
  stop_->setObjectName(QStringLiteral("sweepStop"));
  stop_->addItems({tr("when settled"), tr("after frames"), tr("after milliseconds")});
  stop_->setAccessibleName(tr("When a run stops"));
  stop_->setToolTip(tr("Settled: nothing would change any more. Frames: after the bake. Milliseconds: of preparation, work and frames"));
  stopAmount_ = new QDoubleSpinBox(box);
  stopAmount_->setObjectName(QStringLiteral("sweepStopAmount"));
  stopAmount_->setAccessibleName(tr("How many"));
  stopAmount_->setValue(100);
  limit_ = new QDoubleSpinBox(box);
  limit_->setObjectName(QStringLiteral("sweepLimit"));
  limit_->setRange(0, 1e9);
  limit_->setDecimals(0);
  limit_->setSpecialValueText(tr("none"));
  limit_->setSuffix(tr(" ms"));
  limit_->setAccessibleName(tr("Limit"));
  limit_->setToolTip(tr("A run that takes longer is ended, and counts as failed"));
  auto* label = new QLabel(tr("&Limit"), box);
  label->setBuddy(limit_);
  line->addWidget(stop_, 1);
  line->addWidget(stopAmount_);
  line->addWidget(label);
  line->addWidget(limit_);
  connect(stop_, &QComboBox::activated, this, [this] {
    showStop();
    edited();
  });
  connect(stopAmount_, &QDoubleSpinBox::valueChanged, this, &SweepEditor::edited);
  connect(limit_, &QDoubleSpinBox::valueChanged, this, &SweepEditor::edited);
  return line;
}

QWidget* SweepEditor::makeMeasures() {
  auto* box = new QWidget(this);
  auto* form = new QFormLayout(box);
  form->setContentsMargins(0, 0, 0, 0);
  form->setVerticalSpacing(3);
  form->setFieldGrowthPolicy(QFormLayout::AllNonFixedFieldsGrow);
  form->addRow(tr("&Seeds"), makeSeeds(box));
  static_cast<QLabel*>(form->labelForField(form->itemAt(0, QFormLayout::FieldRole)->layout()))->setBuddy(seeds_);
  form->addRow(errorLine(QStringLiteral("seeds"), box));
  form->addRow(errorLine(QStringLiteral("repeats"), box));

  auto* metricsLine = new QHBoxLayout;
  metrics_ = new QLineEdit(box);
  metrics_->setObjectName(QStringLiteral("sweepMetrics"));
  metrics_->setAccessibleName(tr("Metrics"));
  metrics_->setToolTip(tr("The first is that of the fronts. relmse and mse are measured in any case"));
  auto* choose = new QToolButton(box);
  choose->setText(QStringLiteral("\u25be"));
  choose->setPopupMode(QToolButton::InstantPopup);
  choose->setToolTip(tr("Which metrics there are"));
  choose->setAccessibleName(tr("Choose metrics"));
  metricsMenu_ = new QMenu(choose);
  metricsMenu_->setToolTipsVisible(true);
  choose->setMenu(metricsMenu_);
  fillMetricsMenu();
  metricsLine->addWidget(metrics_, 1);
  metricsLine->addWidget(choose);
  auto* metricsLabel = new QLabel(tr("&Metrics"), box);
  metricsLabel->setBuddy(metrics_);
  form->addRow(metricsLabel, metricsLine);
  form->addRow(errorLine(QStringLiteral("metrics"), box));
  connect(metrics_, &QLineEdit::textEdited, this, &SweepEditor::edited);

  auto* references = new QHBoxLayout;
  matched_ = new QCheckBox(tr("matched"), box);
  matched_->setToolTip(tr("Errors along the light paths that the technique models"));
  full_ = new QCheckBox(tr("full"), box);
  full_->setToolTip(tr("Errors along all light paths"));
  references->addWidget(matched_);
  references->addWidget(full_);
  references->addStretch(1);
  form->addRow(tr("References"), references);
  form->addRow(errorLine(QStringLiteral("references"), box));
  auto* stopLabel = new QLabel(tr("S&top"), box);
  form->addRow(stopLabel, makeStop(box));
  stopLabel->setBuddy(stop_);
  form->addRow(errorLine(QStringLiteral("stop"), box));
  form->addRow(errorLine(QStringLiteral("limit_ms"), box));
  auto* also = new QHBoxLayout;
  pathTracer_ = new QCheckBox(tr("path tracer"), box);
  pathTracer_->setToolTip(tr("The path tracer at equal time is among the competitors"));
  images_ = new QCheckBox(tr("pictures"), box);
  images_->setToolTip(tr("An EXR of each configuration in the results' folder"));
  amortise_ = new QSpinBox(box);
  amortise_->setObjectName(QStringLiteral("sweepAmortise"));
  amortise_->setRange(1, 1'000'000);
  amortise_->setPrefix(tr("bake over "));
  amortise_->setSuffix(tr(" frames"));
  amortise_->setAccessibleName(tr("Frames over which the bake is spread"));
  amortise_->setToolTip(tr("In one of the costs: how many frames use one bake. 60: light that changes once a second"));
  lightmap_ = new QCheckBox(tr("lightmap's errors"), box);
  lightmap_->setToolTip(tr("Errors of the lightmap itself as well, by area, of techniques that have one"));
  also->addWidget(pathTracer_);
  also->addWidget(lightmap_);
  also->addWidget(images_);
  also->addWidget(amortise_);
  also->addStretch(1);
  form->addRow(tr("Also"), also);
  form->addRow(errorLine(QStringLiteral("amortise_frames"), box));
  for (QCheckBox* c : {matched_, full_, pathTracer_, images_, lightmap_}) connect(c, &QCheckBox::toggled, this, &SweepEditor::edited);
  connect(amortise_, &QSpinBox::valueChanged, this, &SweepEditor::edited);

  auto* folderLine = new QHBoxLayout;
  folder_ = new QLineEdit(box);
  folder_->setObjectName(QStringLiteral("sweepFolder"));
  folder_->setAccessibleName(tr("Folder for the results"));
  folder_->setToolTip(tr("What it holds already is taken up, not made again. One folder holds the runs of one build and one machine"));
  auto* browse = new QToolButton(box);
  browse->setText(QStringLiteral("..."));
  browse->setToolTip(tr("Choose a folder"));
  browse->setAccessibleName(tr("Choose a folder for the results"));
  folderLine->addWidget(folder_, 1);
  folderLine->addWidget(browse);
  auto* folderLabel = new QLabel(tr("&Results in"), box);
  folderLabel->setBuddy(folder_);
  form->addRow(folderLabel, folderLine);
  form->addRow(errorLine(QStringLiteral("folder"), box));
  connect(folder_, &QLineEdit::textEdited, this, [this] {
    folderChosen_ = !folder_->text().isEmpty();
    edited();
  });
  connect(browse, &QToolButton::clicked, this, [this] {
    auto* dialog = new QFileDialog(this, tr("Folder for the results"), folder());
    dialog->setAttribute(Qt::WA_DeleteOnClose);
    dialog->setFileMode(QFileDialog::Directory);
    dialog->setOption(QFileDialog::ShowDirsOnly);
    connect(dialog, &QFileDialog::fileSelected, this, &SweepEditor::setFolder);
    dialog->open();
  });
  return box;
}

void SweepEditor::fillMetricsMenu() {
  for (const MetricInfo& m : metricInfos()) {
    QAction* action = metricsMenu_->addAction(fromView(m.id));
    action->setToolTip(fromView(m.formula));
    action->setCheckable(true);
    connect(action, &QAction::triggered, this, [this, id = fromView(m.id)](bool on) {
      QStringList names;
      for (const QString& part : metrics_->text().split(','))
        if (const QString name = part.trimmed(); !name.isEmpty() && name != id) names << name;
      if (on) names << id;
      metrics_->setText(names.join(QStringLiteral(", ")));
      edited();
    });
  }
  connect(metricsMenu_, &QMenu::aboutToShow, this, [this] {
    QStringList names;
    for (const QString& part : metrics_->text().split(',')) names << part.trimmed();
    for (QAction* action : metricsMenu_->actions()) action->setChecked(names.contains(action->text()));
  });
}

}  // namespace hl::ui
