#include "ui/sweep_axis_row.h"

#include <QCheckBox>
#include <QComboBox>
#include <QEvent>
#include <QGridLayout>
#include <QHBoxLayout>
#include <QLabel>
#include <QLineEdit>
#include <QSpinBox>
#include <QStackedWidget>
#include <QToolButton>
#include <QVBoxLayout>
#include <algorithm>
#include <cmath>
#include <set>
#include <sstream>

namespace hl::ui {
namespace {

constexpr int kChoiceColumns = 3;
constexpr int kDark = 128;  // a window's lightness below which it is a dark one
constexpr int kSuggestedSteps = 4;

QString fromView(std::string_view s) { return QString::fromUtf8(s.data(), static_cast<qsizetype>(s.size())); }

bool isNumber(const ParamInfo& p) { return p.type == ParamType::Int || p.type == ParamType::Float; }

std::string textOf(const ParamInfo& p, double v) {
  return formatParam(p, p.type == ParamType::Float ? ParamValue(static_cast<float>(v)) : ParamValue(static_cast<int32_t>(std::lround(v))));
}

std::set<std::string> namesIn(const std::string& list) {
  std::set<std::string> out;
  std::istringstream text(list);
  for (std::string part; std::getline(text, part, ',');) {
    const size_t from = part.find_first_not_of(' ');
    if (from != std::string::npos) out.insert(part.substr(from, part.find_last_not_of(' ') - from + 1));
  }
  return out;
}

}  // namespace

FieldError::FieldError(QWidget* parent) : QWidget(parent), label_(new QLabel(this)) {
  auto* line = new QHBoxLayout(this);
  line->setContentsMargins(0, 0, 0, 0);
  label_->setWordWrap(true);
  label_->setTextFormat(Qt::PlainText);
  label_->setAccessibleName(tr("What is wrong here"));
  line->addWidget(label_, 1);
  colour();
  hide();
}

void FieldError::say(const QString& what) {
  label_->setText(what.isEmpty() ? QString() : QStringLiteral("\u26a0 ") + what);
  setVisible(!what.isEmpty());
}

QString FieldError::text() const { return label_->text().mid(2); }

void FieldError::colour() {
  const QColor red = palette().color(QPalette::Window).lightness() < kDark ? QColor(0xff, 0x8a, 0x80) : QColor(0xb0, 0x00, 0x20);
  if (label_->palette().color(QPalette::WindowText) == red) return;
  QPalette p = label_->palette();
  p.setColor(QPalette::WindowText, red);
  label_->setPalette(p);
}

void FieldError::changeEvent(QEvent* event) {
  if (event->type() == QEvent::PaletteChange) colour();
  QWidget::changeEvent(event);
}

SweepAxisRow::SweepAxisRow(const DraftAxis& axis, const ParamInfo* info, const std::vector<std::pair<std::string, std::string>>& choices, QWidget* parent)
    : QWidget(parent), key_(axis.key) {
  const QString key = QString::fromStdString(axis.key);
  setObjectName(QStringLiteral("axis ") + key);
  auto* column = new QVBoxLayout(this);
  column->setContentsMargins(0, 0, 0, 2);
  column->setSpacing(1);
  auto* line = new QHBoxLayout;
  line->setSpacing(4);
  auto* name = new QLabel(key, this);
  name->setTextFormat(Qt::PlainText);
  if (info) name->setToolTip(QStringLiteral("<p>%1</p><p>%2</p>").arg(fromView(info->help).toHtmlEscaped(), QString::fromStdString(rangeText(*info)).toHtmlEscaped()));
  line->addWidget(name, 2);
  pages_ = new QStackedWidget(this);
  pages_->setSizePolicy(QSizePolicy::Preferred, QSizePolicy::Fixed);
  if (info && isNumber(*info)) {
    mode_ = new QComboBox(this);
    mode_->addItems({tr("List"), tr("Range")});
    mode_->setCurrentIndex(axis.range ? 1 : 0);
    mode_->setAccessibleName(tr("How the values of %1 are given").arg(key));
    line->addWidget(mode_);
  }
  QWidget* content = nullptr;
  if (!choices.empty()) {
    content = makeChoices(axis, choices);
  } else {
    values_ = new QLineEdit(QString::fromStdString(axis.values), this);
    values_->setObjectName(QStringLiteral("values"));
    values_->setAccessibleName(tr("Values of %1").arg(key));
    values_->setPlaceholderText(axis.key == "resolution" ? tr("640x360, 1280x720") : axis.key == "camera" ? tr("names, with commas between them") : tr("16, 64, 256"));
    connect(values_, &QLineEdit::textEdited, this, &SweepAxisRow::edited);
    pages_->addWidget(values_);
    if (mode_) pages_->addWidget(makeNumbers(axis, *info));
    content = pages_;
  }
  if (!choices.empty()) pages_->hide();
  line->addWidget(content, 5);
  auto* remove = new QToolButton(this);
  remove->setText(QStringLiteral("\u2715"));
  remove->setAutoRaise(true);
  remove->setToolTip(tr("Vary %1 no longer").arg(key));
  remove->setAccessibleName(tr("Remove %1").arg(key));
  line->addWidget(remove);
  column->addLayout(line);
  error_ = new FieldError(this);
  column->addWidget(error_);
  connect(remove, &QToolButton::clicked, this, &SweepAxisRow::removeWanted);
  if (mode_) connect(mode_, &QComboBox::activated, this, [this] {
    showMode();
    emit edited();
  });
  showMode();
}

QWidget* SweepAxisRow::makeNumbers(const DraftAxis& axis, const ParamInfo& info) {
  auto* page = new QWidget(this);
  auto* line = new QHBoxLayout(page);
  line->setContentsMargins(0, 0, 0, 0);
  line->setSpacing(3);
  const DraftAxis soft = suggestedAxis(info);
  const bool given = !axis.from.empty() || !axis.to.empty();
  const auto field = [&](const std::string& text, const QString& name) {
    auto* f = new QLineEdit(QString::fromStdString(text), page);
    f->setAccessibleName(name);
    f->setMinimumWidth(fontMetrics().horizontalAdvance(QLatin1Char('0')) * 5);
    connect(f, &QLineEdit::textEdited, this, &SweepAxisRow::edited);
    return f;
  };
  from_ = field(given ? axis.from : soft.from, tr("From"));
  from_->setObjectName(QStringLiteral("from"));
  to_ = field(given ? axis.to : soft.to, tr("To"));
  to_->setObjectName(QStringLiteral("to"));
  count_ = new QSpinBox(page);
  count_->setObjectName(QStringLiteral("count"));
  count_->setRange(2, kMaxAxisValues);
  count_->setValue(axis.count);
  count_->setAccessibleName(tr("How many values"));
  count_->setPrefix(tr("in "));
  log_ = new QCheckBox(tr("log"), page);
  log_->setObjectName(QStringLiteral("log"));
  log_->setChecked(given ? axis.log : soft.log);
  log_->setToolTip(tr("Equal ratios between the values, not equal differences"));
  line->addWidget(from_, 1);
  line->addWidget(new QLabel(QStringLiteral("\u2013"), page));
  line->addWidget(to_, 1);
  line->addWidget(count_);
  line->addWidget(log_);
  connect(count_, &QSpinBox::valueChanged, this, &SweepAxisRow::edited);
  connect(log_, &QCheckBox::toggled, this, &SweepAxisRow::edited);
  return page;
}

QWidget* SweepAxisRow::makeChoices(const DraftAxis& axis, const std::vector<std::pair<std::string, std::string>>& choices) {
  auto* page = new QWidget(this);
  auto* grid = new QGridLayout(page);
  grid->setContentsMargins(0, 0, 0, 0);
  grid->setVerticalSpacing(0);
  const std::set<std::string> ticked = namesIn(axis.values);
  for (const auto& [name, help] : choices) {
    auto* tick = new QCheckBox(QString::fromStdString(name), page);
    tick->setToolTip(QString::fromStdString(help));
    tick->setChecked(ticked.count(name) > 0);
    connect(tick, &QCheckBox::toggled, this, &SweepAxisRow::edited);
    const int at = static_cast<int>(choices_.size());
    grid->addWidget(tick, at / kChoiceColumns, at % kChoiceColumns);
    choices_.push_back(tick);
  }
  return page;
}

void SweepAxisRow::showMode() {
  if (mode_) pages_->setCurrentIndex(mode_->currentIndex());
}

DraftAxis SweepAxisRow::axis() const {
  DraftAxis out;
  out.key = key_;
  for (const QCheckBox* tick : choices_)
    if (tick->isChecked()) out.values += (out.values.empty() ? "" : ", ") + tick->text().toStdString();
  if (values_) out.values = values_->text().toStdString();
  if (!mode_) return out;
  out.range = mode_->currentIndex() == 1;
  out.from = from_->text().toStdString(), out.to = to_->text().toStdString();
  out.count = count_->value(), out.log = log_->isChecked();
  return out;
}

void SweepAxisRow::takeFocus() {
  if (!choices_.empty())
    choices_.front()->setFocus();
  else if (mode_ && mode_->currentIndex() == 1)
    from_->setFocus();
  else
    values_->setFocus();
}

DraftAxis suggestedAxis(const ParamInfo& info) {
  DraftAxis out;
  out.key = info.key();
  if (info.type == ParamType::Bool) {
    out.values = "false, true";
  } else if (info.type == ParamType::Enum) {
    for (const EnumValue& v : info.values) out.values += (out.values.empty() ? "" : ", ") + std::string(v.name);
  } else {
    out.range = true;
    out.from = textOf(info, info.softMin), out.to = textOf(info, info.softMax);
    out.count = kSuggestedSteps, out.log = info.scale == ParamScale::Log;
  }
  return out;
}

}  // namespace hl::ui
