#include "ui/sweep_editor.h"

#include <QBoxLayout>
#include <QCheckBox>
#include <QComboBox>
#include <QDir>
#include <QDoubleSpinBox>
#include <QFileDialog>
#include <QFileInfo>
#include <QLabel>
#include <QLineEdit>
#include <QMenu>
#include <QMetaObject>
#include <QPushButton>
#include <QResizeEvent>
#include <QScrollArea>
#include <QSignalBlocker>
#include <QSpinBox>
#include <QStandardPaths>
#include <QToolButton>
#include <algorithm>
#include <new>
#include <utility>

#include "engine/core/error.h"
#include "engine/experiment/open_target.h"
#include "ui/background.h"
#include "ui/sweep_axis_row.h"

namespace hl::ui {
namespace {

constexpr int kCheckDelayMs = 150;
constexpr int kWideEms = 90;  // from this width on, what is varied and how it is measured stand beside each other
const QString kFolderKey = QStringLiteral("sweepFolder");

QString fromStd(const std::string& s) { return QString::fromStdString(s); }

}  // namespace

SweepEditor::SweepEditor(Document& document, Settings& settings, QWidget* parent) : QWidget(parent), document_(document), settings_(settings) {
  setObjectName(QStringLiteral("sweepEditor"));
  worker_.setMaxThreadCount(1);
  auto* outer = new QVBoxLayout(this);
  outer->setContentsMargins(0, 0, 0, 0);
  auto* scroll = new QScrollArea(this);
  scroll->setWidgetResizable(true);
  scroll->setFrameShape(QFrame::NoFrame);
  auto* inside = new QWidget(scroll);
  auto* column = new QVBoxLayout(inside);
  column->setContentsMargins(4, 4, 4, 4);
  column->addLayout(makeFiles());
  halves_ = new QBoxLayout(QBoxLayout::LeftToRight);
  halves_->addWidget(makeAxes(), 1);
  halves_->addWidget(makeMeasures(), 1);
  column->addLayout(halves_, 1);
  scroll->setWidget(inside);
  outer->addWidget(scroll, 1);
  auto* bottom = new QHBoxLayout;
  bottom->setContentsMargins(4, 0, 4, 4);
  count_ = new QLabel(this);
  count_->setObjectName(QStringLiteral("sweepCount"));
  count_->setAccessibleName(tr("How many runs"));
  count_->setWordWrap(true);
  start_ = new QPushButton(tr("&Start"), this);
  start_->setObjectName(QStringLiteral("sweepStart"));
  start_->setToolTip(tr("Runs the experiment, after those that wait already. Where the folder holds some of its runs, it goes on with the others"));
  bottom->addWidget(count_, 1);
  bottom->addWidget(start_);
  outer->addWidget(errorLine(QString(), this));
  outer->addLayout(bottom);
  connect(start_, &QPushButton::clicked, this, &SweepEditor::start);

  checkTimer_.setSingleShot(true);
  checkTimer_.setInterval(kCheckDelayMs);
  connect(&checkTimer_, &QTimer::timeout, this, [this] { check(Then::Nothing); });
  connect(base_, &QComboBox::activated, this, [this](int at) {
    if (at == base_->count() - 1) {
      showBase();  // until a file was chosen
      auto* dialog = new QFileDialog(this, tr("Base"), settings_.value(QStringLiteral("lastFolder")).toString(), tr("Presets, bundles, screenshots (*.json *.hlb *.png *.exr)"));
      dialog->setAttribute(Qt::WA_DeleteOnClose);
      dialog->setFileMode(QFileDialog::ExistingFile);
      connect(dialog, &QFileDialog::fileSelected, this, &SweepEditor::setBaseFile);
      dialog->open();
      return;
    }
    if (at == 0) baseFile_.reset();
    showBase();
    fillAxes();
    edited();
  });
  connect(&document_, &Document::presetChanged, this, [this] {
    if (!baseFile_ && isVisible()) checkTimer_.start();
  });
  connect(&document_, &Document::techniqueChanged, this, [this] {
    if (!baseFile_) keepSet(), fillAxes();
  });
  SweepDraft first;
  setDraft(first, tr("sweep"));
  baseFile_.reset();
  showBase();
  // What came with the program is listed by a worker: it reads all of it.
  later<std::vector<PresetListing>>([] { return listExperiments(); },
                                    [this](const std::vector<PresetListing>& all) {
                                      for (const PresetListing& e : all) {
                                        QAction* a = shipped_->addAction(fromStd(e.id), this, [this, path = fromStd(e.file.string())] { openExperiment(path); });
                                        a->setToolTip(fromStd(e.label));
                                      }
                                      shipped_->setEnabled(!all.empty());
                                    });
}

SweepEditor::~SweepEditor() { worker_.waitForDone(); }

template <class T>
void SweepEditor::later(std::function<T()> work, std::function<void(const T&)> then) {
  worker_.start([this, work = std::move(work), then = std::move(then)] {
    giveWay();
    QString why;
    try {
      auto made = std::make_shared<T>(work());
      QMetaObject::invokeMethod(this, [made, then] { then(*made); }, Qt::QueuedConnection);
      return;
    } catch (const std::bad_alloc&) {
      why = tr("out of memory");
    } catch (const std::exception& e) {
      why = QString::fromUtf8(e.what());
    }
    QMetaObject::invokeMethod(this, [this, why] { emit refused(why); }, Qt::QueuedConnection);
  });
}

Preset SweepEditor::windowPreset() const {
  Preset p = document_.preset();
  p.warnings.clear();
  return p;
}

SweepDraft SweepEditor::draft() const {
  SweepDraft d;
  d.base = baseFile_ ? *baseFile_ : windowPreset();
  d.permute = sets_;
  d.permute[set_].clear();
  for (const SweepAxisRow* row : rows_) d.permute[set_].push_back(row->axis());
  d.seeds = seeds_->text().toStdString(), d.metrics = metrics_->text().toStdString();
  d.matched = matched_->isChecked(), d.full = full_->isChecked();
  d.stop.kind = static_cast<StopRule::Kind>(stop_->currentIndex());
  d.stop.amount = d.stop.kind == StopRule::Kind::Settled ? 0 : stopAmount_->value();
  d.limitMs = limit_->value(), d.repeats = repeats_->value(), d.amortiseFrames = amortise_->value();
  d.pathTracer = pathTracer_->isChecked(), d.images = images_->isChecked(), d.lightmap = lightmap_->isChecked();
  d.targetError = targetError_;
  return d;
}

void SweepEditor::setDraft(const SweepDraft& d, const QString& name) {
  filling_ = true;
  baseFile_ = d.base;
  baseName_ = name;
  sets_ = d.permute;
  if (sets_.empty()) sets_.emplace_back();
  seeds_->setText(fromStd(d.seeds));
  metrics_->setText(fromStd(d.metrics));
  matched_->setChecked(d.matched), full_->setChecked(d.full);
  stop_->setCurrentIndex(static_cast<int>(d.stop.kind));
  showStop();
  if (d.stop.kind != StopRule::Kind::Settled) stopAmount_->setValue(d.stop.amount);
  limit_->setValue(d.limitMs), repeats_->setValue(d.repeats), amortise_->setValue(d.amortiseFrames);
  pathTracer_->setChecked(d.pathTracer), images_->setChecked(d.images), lightmap_->setChecked(d.lightmap);
  targetError_ = d.targetError;
  name_->setText(name);
  showSet(0);
  showBase();
  filling_ = false;
  followName();
}

void SweepEditor::showStop() {
  const auto kind = static_cast<StopRule::Kind>(stop_->currentIndex());
  const QSignalBlocker block(stopAmount_);
  stopAmount_->setVisible(kind != StopRule::Kind::Settled);
  const bool frames = kind == StopRule::Kind::Frames;
  stopAmount_->setDecimals(frames ? 0 : 1);
  stopAmount_->setRange(frames ? 1 : 0.1, frames ? 1e6 : 1e8);
}

void SweepEditor::showBase() {
  base_->clear();
  base_->addItem(tr("The window's experiment"));
  if (baseFile_) base_->addItem(tr("%1 (%2, %3)").arg(baseName_, fromStd(baseFile_->scene).section('/', -1), fromStd(baseFile_->technique)));
  base_->addItem(tr("A preset's file..."));
  base_->setCurrentIndex(baseFile_ ? 1 : 0);
}

void SweepEditor::setBaseFile(const QString& path) {
  later<Preset>([path] { return openTarget(path.toStdString()); },
                [this, path](const Preset& p) {
                  keepSet();
                  baseFile_ = p;
                  baseName_ = path.section('/', -1);
                  showBase();
                  fillAxes();
                  edited();
                });
}

/// What is typed into the rows, back to their set.
void SweepEditor::keepSet() {
  sets_[set_].clear();
  for (const SweepAxisRow* row : rows_) sets_[set_].push_back(row->axis());
}

void SweepEditor::showSet(int set) {
  set_ = std::min(static_cast<size_t>(set), sets_.size() - 1);
  setChooser_->clear();
  for (size_t i = 0; i < sets_.size(); ++i) setChooser_->addItem(tr("Set %1 of %2").arg(i + 1).arg(sets_.size()));
  setChooser_->setCurrentIndex(static_cast<int>(set_));
  removeSet_->setEnabled(sets_.size() > 1);
  fillAxes();
  if (problem_) showProblem(problem_);
}

/// Rows anew from the set that is shown.
void SweepEditor::fillAxes() {
  for (SweepAxisRow* row : rows_) {
    axes_->removeWidget(row);
    row->hide();
    row->deleteLater();  // one of its buttons may be what asked for this
  }
  rows_.clear();
  SweepDraft d;
  d.base = baseFile_ ? *baseFile_ : document_.preset();
  d.permute = sets_;
  for (const DraftAxis& axis : sets_[set_]) {
    const ParamInfo* info = nullptr;
    for (const std::string& technique : techniquesOf(d, set_))
      if (!info) info = document_.catalog().parameter(technique, axis.key);
    std::vector<std::pair<std::string, std::string>> choices;
    if (axis.key == "technique")
      for (const TechniqueEntry& t : document_.catalog().techniques()) choices.emplace_back(t.id, t.summary);
    if (info && info->type == ParamType::Bool) choices = {{"false", ""}, {"true", ""}};
    if (info && info->type == ParamType::Enum)
      for (const EnumValue& v : info->values) choices.emplace_back(std::string(v.name), std::string(v.help));
    auto* row = new SweepAxisRow(axis, info, choices, this);
    connect(row, &SweepAxisRow::edited, this, [this, key = axis.key] {
      if (key == "technique") fillKeys();
      edited();
    });
    connect(row, &SweepAxisRow::removeWanted, this, [this, key = axis.key] {
      keepSet();
      std::erase_if(sets_[set_], [&](const DraftAxis& a) { return a.key == key; });
      fillAxes();
      edited();
      keys_->setFocus();
    });
    axes_->addWidget(row);
    row->show();
    rows_.push_back(row);
  }
  noAxes_->setVisible(rows_.empty());
  fillKeys();
}

/// What can be varied and is not yet.
void SweepEditor::fillKeys() {
  const SweepDraft d = draft();
  const QString typed = keys_->currentText();
  const QSignalBlocker block(keys_);
  keys_->clear();
  const auto offer = [&](const std::string& key, const QString& help) {
    if (axisRow(key) || keys_->findText(fromStd(key)) >= 0) return;
    keys_->addItem(fromStd(key));
    keys_->setItemData(keys_->count() - 1, help, Qt::ToolTipRole);
  };
  offer("technique", tr("Which technique"));
  offer("resolution", tr("Width and height of the picture"));
  offer("camera", tr("One of the scene's cameras, by name"));
  for (const std::string& technique : techniquesOf(d, set_))
    if (const TechniqueEntry* entry = document_.catalog().technique(technique))
      for (const ParameterGroup& group : entry->groups)
        for (const ParamInfo& p : group.infos) offer(p.key(), QString::fromUtf8(p.help.data(), static_cast<qsizetype>(p.help.size())));
  keys_->setCurrentIndex(-1);
  keys_->setEditText(typed);
}

void SweepEditor::addAxis(const std::string& key) {
  if (SweepAxisRow* row = axisRow(key)) {
    row->takeFocus();
    return;
  }
  const SweepDraft d = draft();
  DraftAxis axis;
  axis.key = key;
  if (key == "technique") {
    axis.values = d.base.technique;
  } else if (key == "resolution") {
    axis.values = std::to_string(d.base.width) + "x" + std::to_string(d.base.height);
  } else if (key == "camera") {
    axis.values = d.base.cameraName;
  } else {
    for (const std::string& technique : techniquesOf(d, set_))
      if (const ParamInfo* info = document_.catalog().parameter(technique, key)) {
        axis = suggestedAxis(*info);
        break;
      }
  }
  keepSet();
  sets_[set_].push_back(axis);
  fillAxes();
  rows_.back()->takeFocus();
  edited();
}

SweepAxisRow* SweepEditor::axisRow(const std::string& key) const {
  for (SweepAxisRow* row : rows_)
    if (row->key() == key) return row;
  return nullptr;
}

QString SweepEditor::folder() const { return folder_->text().trimmed(); }
QString SweepEditor::name() const {
  const QString typed = name_->text().trimmed();
  return typed.isEmpty() ? tr("sweep") : typed;
}

void SweepEditor::setFolder(const QString& folder) {
  folder_->setText(folder);
  folderChosen_ = true;
  settings_.setValue(kFolderKey, QFileInfo(folder).path());
  edited();
}

/// As long as no folder was chosen, it is called as the experiment is, where the last one was.
void SweepEditor::followName() {
  if (!folderChosen_) {
    const QString beside = settings_.value(kFolderKey, QStandardPaths::writableLocation(QStandardPaths::DocumentsLocation) + QStringLiteral("/halflight")).toString();
    folder_->setText(QDir(beside).filePath(QString(name()).replace('/', '_')));
  }
  edited();
}

void SweepEditor::openExperiment(const QString& nameOrPath) {
  later<Experiment>([nameOrPath] { return hl::openExperiment(nameOrPath.toStdString()); },
                    [this, nameOrPath](const Experiment& e) {
                      setDraft(draftOf(e), QFileInfo(nameOrPath).completeBaseName());
                      for (const std::string& w : e.warnings) emit message(fromStd(w));
                      if (nameOrPath.contains('/')) settings_.setValue(QStringLiteral("lastFolder"), nameOrPath.section('/', 0, -2));
                      emit opened(nameOrPath);
                    });
}

void SweepEditor::saveTo(const QString& path) {
  settings_.setValue(QStringLiteral("lastFolder"), path.section('/', 0, -2));
  check(Then::Save, path);
}

void SweepEditor::start() { check(Then::Start); }

void SweepEditor::edited() {
  if (!filling_) checkTimer_.start();
}

void SweepEditor::check(Then then, const QString& path) {
  checkTimer_.stop();
  const quint64 number = ++asked_;
  // A file of the experiment needs no folder for results.
  const std::filesystem::path folder = then == Then::Save && this->folder().isEmpty() ? std::filesystem::path(".") : std::filesystem::path(this->folder().toStdString());
  later<DraftCheck>(
      [draft = draft(), folder, then, path] {
        DraftCheck c = checkDraft(draft, folder);
        if (then != Then::Save || !c.experiment) return c;
        try {
          saveExperiment(*c.experiment, path.toStdString());
        } catch (const std::exception& e) {
          c.experiment.reset(), c.problem = DraftProblem{{}, e.what()};
        }
        return c;
      },
      [this, then, path, number](const DraftCheck& c) { takeCheck(c, then, path, number); });
}

void SweepEditor::takeCheck(const DraftCheck& c, Then then, const QString& path, quint64 number) {
  answered_ = std::max(answered_, number);
  if (then == Then::Nothing && number != asked_) return;  // typed on since
  showProblem(c.problem);
  QString text;
  if (c.runs > 0) {
    text = tr("%1 configurations").arg(c.configurations);
    const size_t each = c.configurations ? c.runs / c.configurations : 0;
    if (each > 1) text += tr(" x %1 seeds and repeats").arg(each);
    text += tr(": %n runs", nullptr, static_cast<int>(c.runs));
    if (c.present) text += tr(", %1 of them in the folder already").arg(c.present);
  }
  count_->setText(text);
  if (then != Then::Nothing && c.problem) emit refused(fromStd(c.problem->message));
  if (then == Then::Start && c.experiment) emit startWanted(name(), *c.experiment, folder());
  if (then == Then::Save && c.experiment) emit saved(path);
  emit checked();
}

void SweepEditor::showProblem(const std::optional<DraftProblem>& problem) {
  problem_ = problem;
  for (auto& [field, line] : errors_) line->say({});
  for (SweepAxisRow* row : rows_) row->say({});
  if (!problem) return;
  const DraftField& f = problem->field;
  const QString said = fromStd(problem->message);
  if (f.name == "axis" && f.set == set_) {
    if (SweepAxisRow* row = axisRow(f.key)) {
      row->say(said);
      return;
    }
  }
  if (f.name == "axis") {
    errors_[QStringLiteral("axis")]->say(sets_.size() > 1 ? tr("set %1, %2: %3").arg(f.set + 1).arg(fromStd(f.key), said) : tr("%1: %2").arg(fromStd(f.key), said));
    return;
  }
  const auto line = errors_.find(fromStd(f.name));
  (line == errors_.end() ? errors_[QString()] : line->second)->say(said);
}

QString SweepEditor::problemAt(const DraftField& field) const {
  return problem_ && problem_->field == field ? fromStd(problem_->message) : QString();
}

void SweepEditor::resizeEvent(QResizeEvent* event) {
  QWidget::resizeEvent(event);
  halves_->setDirection(event->size().width() >= fontMetrics().horizontalAdvance(QLatin1Char('0')) * kWideEms ? QBoxLayout::LeftToRight : QBoxLayout::TopToBottom);
}

}  // namespace hl::ui
