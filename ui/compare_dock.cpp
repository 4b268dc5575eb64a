#include "ui/compare_dock.h"

#include <QAction>
#include <QBoxLayout>
#include <QComboBox>
#include <QDoubleSpinBox>
#include <QGridLayout>
#include <QLabel>
#include <QListWidget>
#include <QPushButton>
#include <QResizeEvent>
#include <QScrollArea>
#include <QSignalBlocker>
#include <QSlider>
#include <QToolButton>
#include <algorithm>

#include "engine/metrics/metrics.h"

namespace hl::ui {
namespace {

constexpr int kWipeSteps = 1000, kGainSteps = 10;  // slider steps: in all; to one of gain

QString text(std::string_view s) { return QString::fromUtf8(s.data(), static_cast<qsizetype>(s.size())); }

}  // namespace

ComparePanel::ComparePanel(Compare& compare, Document& document, QWidget* parent) : QWidget(parent), compare_(compare), document_(document) {
  auto* outer = new QVBoxLayout(this);
  outer->setContentsMargins(0, 0, 0, 0);
  auto* scroll = new QScrollArea(this);
  scroll->setWidgetResizable(true);
  scroll->setFrameShape(QFrame::NoFrame);
  outer->addWidget(scroll);
  auto* inside = new QWidget(scroll);
  halves_ = new QBoxLayout(QBoxLayout::LeftToRight, inside);
  halves_->setContentsMargins(4, 4, 4, 4);
  halves_->addWidget(makeChoices(), 0);
  halves_->addWidget(makeSnapshots(), 1);
  scroll->setWidget(inside);
  connect(&compare_, &Compare::choiceChanged, this, &ComparePanel::readChoice);
  connect(&compare_, &Compare::partsChanged, this, [this] {
    readParts();
    readChoice();
  });
  connect(&compare_, &Compare::picturesChanged, this, [this] {
    const QString& why = compare_.pictures().refused;
    message_->setText(why.isEmpty() ? compare_.note() : why);
    message_->setVisible(!message_->text().isEmpty());
  });
  connect(&compare_.snapshots(), &Snapshots::changed, this, [this] {
    readSources();
    readSnapshots();
    readChoice();
  });
  connect(&compare_, &Compare::snapshotTaken, this, [this](int id) {
    for (int i = 0; i < list_->count(); ++i)
      if (list_->item(i)->data(Qt::UserRole).toInt() == id) list_->setCurrentRow(i);
  });
  readSources();
  readParts();
  readSnapshots();
  readChoice();
  message_->hide();
}

QWidget* ComparePanel::makeChoices() {
  auto* box = new QWidget(this);
  auto* grid = new QGridLayout(box);
  grid->setContentsMargins(0, 0, 6, 0);
  int row = 0;
  const auto line = [&](const QString& name, QWidget* w) {
    auto* label = new QLabel(name, box);
    label->setBuddy(w);
    w->setAccessibleName(QString(name).remove('&'));
    grid->addWidget(label, row, 0);
    grid->addWidget(w, row++, 1, 1, 2);
    return label;
  };
  mode_ = new QComboBox(box);
  const std::pair<QString, CompareMode> modes[] = {{tr("Off"), CompareMode::Off},
                                                   {tr("Wipe, left and right"), CompareMode::WipeAcross},
                                                   {tr("Wipe, above and below"), CompareMode::WipeDown},
                                                   {tr("Flicker"), CompareMode::Flicker},
                                                   {tr("Side by side"), CompareMode::SideBySide},
                                                   {tr("Difference, A minus B"), CompareMode::Difference},
                                                   {tr("Error map, A against B"), CompareMode::ErrorMap}};
  for (const auto& [name, mode] : modes) mode_->addItem(name, static_cast<int>(mode));
  line(tr("&Show"), mode_);
  a_ = new QComboBox(box);
  b_ = new QComboBox(box);
  line(tr("&A"), a_);
  auto* swapButton = new QToolButton(box);
  swapButton->setText(QStringLiteral("\u21c5"));
  swapButton->setAccessibleName(tr("Swap A and B"));
  swapButton->setToolTip(tr("Swap A and B (X)"));
  auto* label = new QLabel(tr("&B"), box);
  label->setBuddy(b_);
  b_->setAccessibleName(tr("B"));
  grid->addWidget(label, row, 0);
  grid->addWidget(b_, row, 1);
  grid->addWidget(swapButton, row++, 2);
  component_ = new QComboBox(box);
  line(tr("&Of"), component_);

  wipe_ = new QSlider(Qt::Horizontal, box);
  wipe_->setRange(0, kWipeSteps);
  wipe_->setPageStep(kWipeSteps / 10);
  wipe_->setSingleStep(kWipeSteps / 100);
  wipe_->setToolTip(tr("Or drag the line in the picture, or the arrow keys there"));
  wipeLabel_ = line(tr("&Line"), wipe_);
  rate_ = new QDoubleSpinBox(box);
  rate_->setRange(Compare::kLeastHz, Compare::kMostHz);
  rate_->setSingleStep(0.5);
  rate_->setDecimals(1);
  rate_->setSuffix(tr(" a second"));
  rate_->setToolTip(tr("Changes of the picture a second. More than three flashes a second can harm people with photosensitive epilepsy"));
  rateLabel_ = line(tr("&Rate"), rate_);
  gain_ = new QSlider(Qt::Horizontal, box);
  gain_->setRange(kGainSteps, static_cast<int>(Compare::kMostGain) * kGainSteps);
  gain_->setSingleStep(kGainSteps / 2);
  gain_->setPageStep(kGainSteps);
  gainLabel_ = line(tr("&Gain"), gain_);
  metric_ = new QComboBox(box);
  for (const MetricInfo& m : metricInfos()) {
    metric_->addItem(text(m.label), text(m.id));
    metric_->setItemData(metric_->count() - 1, text(m.formula), Qt::ToolTipRole);
  }
  metricLabel_ = line(tr("&Metric"), metric_);
  message_ = new QLabel(box);
  message_->setWordWrap(true);
  message_->setAccessibleName(tr("About this comparison"));
  grid->addWidget(message_, row++, 0, 1, 3);
  grid->setRowStretch(row, 1);
  grid->setColumnStretch(1, 1);
  box->setMaximumWidth(fontMetrics().horizontalAdvance(QLatin1Char('0')) * 46);

  for (QComboBox* c : {mode_, a_, b_, component_, metric_}) {
    c->setSizeAdjustPolicy(QComboBox::AdjustToMinimumContentsLengthWithIcon);
    c->setMinimumContentsLength(18);
    connect(c, &QComboBox::activated, this, &ComparePanel::changed);
  }
  for (QSlider* s : {wipe_, gain_}) connect(s, &QSlider::valueChanged, this, &ComparePanel::changed);
  connect(rate_, &QDoubleSpinBox::valueChanged, this, &ComparePanel::changed);
  connect(swapButton, &QToolButton::clicked, &compare_, &Compare::swap);
  return box;
}

QWidget* ComparePanel::makeSnapshots() {
  auto* box = new QWidget(this);
  auto* column = new QVBoxLayout(box);
  column->setContentsMargins(0, 0, 0, 0);
  auto* buttons = new QHBoxLayout;
  auto* take = new QPushButton(tr("&Take snapshot"), box);
  take->setToolTip(tr("Keeps the picture, its preset, errors and times (C)"));
  rename_ = new QPushButton(tr("Re&name"), box);
  remove_ = new QPushButton(tr("&Delete"), box);
  restore_ = new QPushButton(tr("Restore &preset"), box);
  restore_->setToolTip(tr("Scene, camera, technique and every parameter as they were; one step of undo"));
  for (QPushButton* b : {take, rename_, remove_, restore_}) buttons->addWidget(b);
  buttons->addStretch(1);
  column->addLayout(buttons);
  list_ = new QListWidget(box);
  list_->setAccessibleName(tr("Snapshots"));
  list_->setIconSize({96, 54});
  list_->setEditTriggers(QAbstractItemView::EditKeyPressed | QAbstractItemView::SelectedClicked);
  list_->setMinimumHeight(80);
  column->addWidget(list_, 1);
  facts_ = new QLabel(box);
  facts_->setWordWrap(true);
  facts_->setTextInteractionFlags(Qt::TextSelectableByMouse | Qt::TextSelectableByKeyboard);
  facts_->setFocusPolicy(Qt::ClickFocus);
  column->addWidget(facts_);
  memory_ = new QLabel(box);
  memory_->setForegroundRole(QPalette::PlaceholderText);
  column->addWidget(memory_);

  connect(take, &QPushButton::clicked, &compare_, &Compare::takeSnapshot);
  connect(rename_, &QPushButton::clicked, this, [this] {
    if (QListWidgetItem* item = list_->currentItem()) list_->editItem(item);
  });
  connect(remove_, &QPushButton::clicked, this, [this] { compare_.snapshots().remove(selected()); });
  auto* removeKey = new QAction(tr("Delete the snapshot"), list_);
  removeKey->setShortcut(QKeySequence::Delete);
  removeKey->setShortcutContext(Qt::WidgetShortcut);
  list_->addAction(removeKey);
  connect(removeKey, &QAction::triggered, remove_, &QPushButton::click);
  connect(restore_, &QPushButton::clicked, this, [this] {
    if (const Snapshot* s = compare_.snapshots().find(selected())) document_.restore(s->frame->preset, tr("restore %1").arg(s->name));
  });
  connect(list_, &QListWidget::itemChanged, this, [this](QListWidgetItem* item) {
    if (filling_) return;
    compare_.snapshots().rename(item->data(Qt::UserRole).toInt(), item->text().trimmed());
    readSnapshots();  // an empty name is not taken
  });
  connect(list_, &QListWidget::currentRowChanged, this, &ComparePanel::showFacts);
  connect(&compare_.snapshots(), &Snapshots::refused, this, [this](const QString& why) {
    message_->setText(why);
    message_->show();
  });
  return box;
}

int ComparePanel::selected() const { return list_->currentItem() ? list_->currentItem()->data(Qt::UserRole).toInt() : 0; }

void ComparePanel::readSources() {
  for (QComboBox* box : {a_, b_}) {
    const QSignalBlocker block(box);
    box->clear();
    for (const CompareSource& s : compare_.sources()) box->addItem(s.name, s.id);
  }
}

void ComparePanel::readParts() {
  const QSignalBlocker block(component_);
  component_->clear();
  for (const Compare::Part& p : compare_.parts()) component_->addItem(p.name, static_cast<int>(p.part));
}

void ComparePanel::readChoice() {
  const CompareChoice& c = compare_.choice();
  const QSignalBlocker blocks[] = {QSignalBlocker(mode_), QSignalBlocker(a_), QSignalBlocker(b_), QSignalBlocker(component_),
                                   QSignalBlocker(metric_), QSignalBlocker(wipe_), QSignalBlocker(gain_), QSignalBlocker(rate_)};
  mode_->setCurrentIndex(mode_->findData(static_cast<int>(c.mode)));
  a_->setCurrentIndex(a_->findData(c.a));
  b_->setCurrentIndex(b_->findData(c.b));
  component_->setCurrentIndex(component_->findData(static_cast<int>(c.part)));
  metric_->setCurrentIndex(std::max(0, metric_->findData(c.metric)));
  wipe_->setValue(static_cast<int>(c.wipe * kWipeSteps + 0.5));
  gain_->setValue(static_cast<int>(c.gain * kGainSteps + 0.5));
  gainLabel_->setText(tr("&Gain \u00d7%1").arg(c.gain, 0, 'f', 1));
  rate_->setValue(c.flickerHz);
  const auto show = [](bool on, QLabel* label, QWidget* w) { label->setVisible(on), w->setVisible(on); };
  show(c.mode == CompareMode::WipeAcross || c.mode == CompareMode::WipeDown, wipeLabel_, wipe_);
  show(c.mode == CompareMode::Flicker, rateLabel_, rate_);
  show(c.mode == CompareMode::Difference, gainLabel_, gain_);
  show(c.mode == CompareMode::ErrorMap, metricLabel_, metric_);
}

void ComparePanel::changed() {
  CompareChoice c = compare_.choice();
  c.mode = static_cast<CompareMode>(mode_->currentData().toInt());
  c.a = a_->currentData().toString();
  c.b = b_->currentData().toString();
  c.part = static_cast<PicturePart>(component_->currentData().toInt());
  c.metric = metric_->currentData().toString();
  if (sender() == wipe_) c.wipe = static_cast<double>(wipe_->value()) / kWipeSteps;
  if (sender() == gain_) c.gain = static_cast<double>(gain_->value()) / kGainSteps;
  if (sender() == rate_) c.flickerHz = rate_->value();
  compare_.choose(c);
}

void ComparePanel::readSnapshots() {
  filling_ = true;
  const std::vector<Snapshot>& now = compare_.snapshots().all();
  // Items stay where they are: this may come from one that is being renamed.
  for (int row = list_->count() - 1; row >= 0; --row)
    if (!compare_.snapshots().find(list_->item(row)->data(Qt::UserRole).toInt())) delete list_->takeItem(row);
  for (size_t i = 0; i < now.size(); ++i) {
    const Snapshot& s = now[i];  // new ones come last
    QListWidgetItem* item = list_->item(static_cast<int>(i));
    if (!item) {
      item = new QListWidgetItem(list_);
      item->setData(Qt::UserRole, s.id);
      item->setFlags(item->flags() | Qt::ItemIsEditable);
    }
    if (item->text() != s.name) item->setText(s.name);
    if (!s.thumbnail.isNull() && item->icon().isNull()) item->setIcon(QIcon(QPixmap::fromImage(s.thumbnail)));
  }
  filling_ = false;
  const Snapshots& all = compare_.snapshots();
  memory_->setText(tr("Snapshots: %3, %1 MB of at most %2 MB")
                       .arg(static_cast<double>(all.bytes()) / (1 << 20), 0, 'f', 1)
                       .arg(all.mostBytes() >> 20)
                       .arg(all.all().size()));
  showFacts();
}

void ComparePanel::showFacts() {
  const Snapshot* s = compare_.snapshots().find(selected());
  for (QPushButton* b : {rename_, remove_, restore_}) b->setEnabled(s != nullptr);
  QString facts;
  if (s) {
    const FrameResult& f = *s->frame;
    facts = tr("%1 on %2, %3 \u00d7 %4. Frame %5 ms, work %6 s.")
                .arg(text(f.preset.technique), text(f.preset.scene))
                .arg(f.width)
                .arg(f.height)
                .arg(f.frameTime.medianMs, 0, 'f', 1)
                .arg(f.workMs / 1000, 0, 'f', 1);
    for (const ErrorValue& e : f.errors)
      if (e.metric == "relmse" && e.component == "indirect" && e.roi.empty())
        facts += QStringLiteral(" ") + tr("relmse %1 (%2).").arg(e.value, 0, 'g', 3).arg(e.reference == "full" ? tr("full") : tr("matched"));
    if (f.errors.empty()) facts += QStringLiteral(" ") + tr("No reference was there to measure against.");
  }
  facts_->setText(facts);
  facts_->setVisible(!facts.isEmpty());
}

void ComparePanel::resizeEvent(QResizeEvent* event) {
  QWidget::resizeEvent(event);
  halves_->setDirection(width() > 1.3 * height() ? QBoxLayout::LeftToRight : QBoxLayout::TopToBottom);
}

}  // namespace hl::ui
