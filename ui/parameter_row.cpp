#include "ui/parameter_row.h"

#include <QAction>
#include <QApplication>
#include <QCheckBox>
#include <QClipboard>
#include <QComboBox>
#include <QEvent>
#include <QGridLayout>
#include <QLabel>
#include <QSignalBlocker>
#include <QSlider>
#include <QToolButton>

#include "ui/catalog.h"
#include "ui/parameter_field.h"

namespace hl::ui {
namespace {

QString fromView(std::string_view s) { return QString::fromUtf8(s.data(), static_cast<qsizetype>(s.size())); }

double numberOf(const ParamInfo& p, const std::string& s) {
  const ParamValue v = parseParam(p, s);
  return std::holds_alternative<float>(v) ? static_cast<double>(std::get<float>(v)) : std::get<int32_t>(v);
}

std::string textOf(const ParamInfo& p, double v) {
  return formatParam(p, p.type == ParamType::Float ? ParamValue(static_cast<float>(v)) : ParamValue(static_cast<int32_t>(v)));
}

/// Sliders and lists pass the wheel on to the panel unless they were clicked into.
class WheelGuard : public QObject {
 public:
  using QObject::QObject;
  bool eventFilter(QObject* watched, QEvent* event) override {
    if (event->type() != QEvent::Wheel || static_cast<QWidget*>(watched)->hasFocus()) return false;
    event->ignore();
    return true;
  }
};

}  // namespace

ParameterRow::ParameterRow(const ParamInfo& info, QGridLayout& grid, int line, QWidget* parent)
    : QObject(parent), info_(info), scale_(info), text_(defaultText(info)) {
  name_ = new QLabel(parent);
  name_->setWordWrap(true);
  name_->setTextFormat(Qt::RichText);
  name_->setContextMenuPolicy(Qt::ActionsContextMenu);
  auto* copy = new QAction(tr("Copy key \"%1\"").arg(QString::fromStdString(info.key())), name_);
  connect(copy, &QAction::triggered, this, [this] {
    QApplication::clipboard()->setText(QString::fromStdString(info_.key()));
  });
  name_->addAction(copy);
  auto* sweep = new QAction(tr("Sweep this parameter"), name_);
  connect(sweep, &QAction::triggered, this, &ParameterRow::sweepWanted);
  name_->addAction(sweep);
  name_->setMinimumWidth(90);
  grid.addWidget(name_, line, 0);
  widgets_ << name_;

  if (info.type == ParamType::Int || info.type == ParamType::Float)
    addNumber(grid, line);
  else
    addChoice(grid, line);

  cost_ = new QLabel(parent);
  QFont small = cost_->font();
  small.setPointSizeF(small.pointSizeF() * 0.85);
  cost_->setFont(small);
  cost_->setForegroundRole(QPalette::PlaceholderText);
  setWaiting(false);
  grid.addWidget(cost_, line, 3);

  reset_ = new QToolButton(parent);
  reset_->setText(QStringLiteral("\u21ba"));
  reset_->setAutoRaise(true);
  reset_->setToolTip(tr("Back to the default, %1").arg(QString::fromStdString(defaultText(info))));
  reset_->setAccessibleName(tr("Reset %1").arg(fromView(info.name)));
  QSizePolicy keep = reset_->sizePolicy();
  keep.setRetainSizeWhenHidden(true);
  reset_->setSizePolicy(keep);
  connect(reset_, &QToolButton::clicked, this, [this] { change(defaultText(info_), false); });
  grid.addWidget(reset_, line, 4);
  widgets_ << cost_ << reset_;

  auto* guard = new WheelGuard(this);
  for (QWidget* w : {static_cast<QWidget*>(slider_), static_cast<QWidget*>(list_)})
    if (w) w->installEventFilter(guard), w->setFocusPolicy(Qt::StrongFocus);
  for (QWidget* w : widgets_)
    if (w != cost_ && w != reset_) w->setToolTip(toolTip());
  show(text_);
}

void ParameterRow::addNumber(QGridLayout& grid, int line) {
  auto* parent = static_cast<QWidget*>(this->parent());
  slider_ = new QSlider(Qt::Horizontal, parent);
  slider_->setRange(0, scale_.steps());
  slider_->setPageStep(std::max(1, scale_.steps() / 10));
  slider_->setMinimumWidth(60);
  slider_->setAccessibleName(fromView(info_.name));
  field_ = new ParameterField(info_, parent);
  field_->setAccessibleName(fromView(info_.name));
  grid.addWidget(slider_, line, 1);
  grid.addWidget(field_, line, 2);
  widgets_ << slider_ << field_;
  connect(slider_, &QSlider::sliderPressed, this, &ParameterRow::dragStarted);
  connect(slider_, &QSlider::valueChanged, this, [this](int position) {
    change(textOf(info_, scale_.value(position)), slider_->isSliderDown());
  });
  connect(field_, &QDoubleSpinBox::valueChanged, this, [this](double v) { change(textOf(info_, v), false); });
  connect(field_, &ParameterField::limited, this, &ParameterRow::message);
}

void ParameterRow::addChoice(QGridLayout& grid, int line) {
  auto* parent = static_cast<QWidget*>(this->parent());
  if (info_.type == ParamType::Bool) {
    tick_ = new QCheckBox(parent);
    tick_->setAccessibleName(fromView(info_.name));
    grid.addWidget(tick_, line, 1, 1, 2);
    widgets_ << tick_;
    connect(tick_, &QCheckBox::toggled, this, [this](bool on) { change(textOf(info_, on ? 1 : 0), false); });
    return;
  }
  list_ = new QComboBox(parent);
  list_->setAccessibleName(fromView(info_.name));
  list_->setMinimumContentsLength(6);
  list_->setSizeAdjustPolicy(QComboBox::AdjustToMinimumContentsLengthWithIcon);
  for (const EnumValue& v : info_.values) {
    list_->addItem(QString::fromStdString(readableName(v.name)), fromView(v.name));
    list_->setItemData(list_->count() - 1, fromView(v.help), Qt::ToolTipRole);
  }
  grid.addWidget(list_, line, 1, 1, 2);
  widgets_ << list_;
  connect(list_, &QComboBox::currentIndexChanged, this, [this](int i) { change(textOf(info_, i), false); });
}

void ParameterRow::show(const std::string& value) {
  text_ = value;
  const double number = numberOf(info_, value);
  if (slider_) {
    const QSignalBlocker blockSlider(slider_), blockField(field_);
    if (!slider_->isSliderDown()) slider_->setValue(scale_.position(number));
    field_->setValue(number);
  } else if (list_) {
    const QSignalBlocker block(list_);
    list_->setCurrentIndex(static_cast<int>(number));
  } else {
    const QSignalBlocker block(tick_);
    tick_->setChecked(number != 0);
  }
  updateLook();
}

void ParameterRow::change(const std::string& value, bool dragging) {
  if (value == text_) return;
  show(value);
  emit edited(value, dragging);
}

bool ParameterRow::isDefault() const { return text_ == defaultText(info_); }

void ParameterRow::updateLook() {
  const QString name = QString::fromStdString(readableName(info_.name)).toHtmlEscaped();
  const QString unit = fromView(info_.unit).toHtmlEscaped();
  const QString title = isDefault() ? name : QStringLiteral("<b>%1</b>").arg(name);
  // "Slice ms" and "Bounces" say their unit already.
  const bool said = unit.isEmpty() || name.endsWith(unit, Qt::CaseInsensitive) || unit.startsWith(name, Qt::CaseInsensitive);
  name_->setText(said ? title : QStringLiteral("%1 <small>[%2]</small>").arg(title, unit));
  reset_->setVisible(name_->isVisibleTo(static_cast<QWidget*>(parent())) && !isDefault());
}

void ParameterRow::setWaiting(bool waiting) {
  const Effect effect = info_.effect;
  cost_->setText(waiting ? tr("Waits") : effect == Effect::Live ? tr("Live") : effect == Effect::Reset ? tr("Reset") : tr("Rebuild"));
  cost_->setToolTip(waiting                   ? tr("Not in use yet: the rebuild that it needs has to be asked for, above")
                    : effect == Effect::Live  ? tr("Live: seen in the next frame")
                    : effect == Effect::Reset ? tr("Reset: histories and work start again")
                                              : tr("Rebuild: memory or precomputation is made anew"));
  QFont font = cost_->font();
  font.setBold(waiting);
  cost_->setFont(font);
}

void ParameterRow::setVisible(bool visible) {
  for (QWidget* w : widgets_) w->setVisible(visible);
  reset_->setVisible(visible && !isDefault());
}

bool ParameterRow::matches(const QString& words) const {
  QString all = fromView(info_.name) + ' ' + QString::fromStdString(readableName(info_.name)) + ' ' +
                QString::fromStdString(info_.key()) + ' ' + fromView(info_.unit) + ' ' + fromView(info_.help);
  for (const EnumValue& v : info_.values) all += ' ' + fromView(v.name) + ' ' + fromView(v.help);
  for (const QString& word : words.split(' ', Qt::SkipEmptyParts))
    if (!all.contains(word, Qt::CaseInsensitive)) return false;
  return true;
}

QString ParameterRow::toolTip() const {
  QString tip = QStringLiteral("<p><b>%1</b></p><p>%2</p>").arg(QString::fromStdString(info_.key()), fromView(info_.help).toHtmlEscaped());
  if (slider_) {
    tip += QStringLiteral("<p>%1</p>")
               .arg(tr("%1 to %2 %3; default %4")
                        .arg(QString::fromStdString(textOf(info_, info_.min)), QString::fromStdString(textOf(info_, info_.max)),
                             fromView(info_.unit), QString::fromStdString(defaultText(info_)))
                        .toHtmlEscaped());
  } else if (list_) {
    tip += QStringLiteral("<ul>");
    for (const EnumValue& v : info_.values)
      tip += QStringLiteral("<li><b>%1</b>: %2</li>").arg(fromView(v.name).toHtmlEscaped(), fromView(v.help).toHtmlEscaped());
    tip += QStringLiteral("</ul>");
  }
  return tip;
}

}  // namespace hl::ui
