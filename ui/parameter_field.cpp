#include "ui/parameter_field.h"

#include <QLineEdit>
#include <QWheelEvent>
#include <algorithm>
#include <utility>

namespace hl::ui {
namespace {

ParamValue asValue(const ParamInfo& p, double v) {
  return p.type == ParamType::Float ? ParamValue(static_cast<float>(v)) : ParamValue(static_cast<int32_t>(v));
}

}  // namespace

ParameterField::ParameterField(const ParamInfo& info, QWidget* parent)
    : QDoubleSpinBox(parent), info_(info), scale_(info) {
  setDecimals(info.type == ParamType::Int ? 0 : 12);
  setRange(info.min, info.max);
  setKeyboardTracking(false);  // one change when it is committed, not one a key
  setLocale(QLocale::c());
  setFocusPolicy(Qt::StrongFocus);
  setAlignment(Qt::AlignRight);
  setButtonSymbols(QAbstractSpinBox::NoButtons);
  connect(lineEdit(), &QLineEdit::textEdited, this, [this](const QString& text) { typed_ = text; });
  connect(this, &QAbstractSpinBox::editingFinished, this, &ParameterField::tellLimit);
}

QString ParameterField::textFromValue(double v) const { return QString::fromStdString(formatParam(info_, asValue(info_, v))); }

double ParameterField::valueFromText(const QString& text) const {
  bool ok = false;
  const double v = QLocale::c().toDouble(text.trimmed(), &ok);
  return ok ? std::clamp(v, minimum(), maximum()) : value();
}

QValidator::State ParameterField::validate(QString& text, int&) const {
  // Any number may be typed, one out of range too: it is limited when committed, where it can be said.
  bool ok = false;
  const QString number = text.trimmed();
  QLocale::c().toDouble(number, &ok);
  if (ok) return QValidator::Acceptable;
  for (const QChar c : number)
    if (!c.isDigit() && !QStringLiteral("+-.eE").contains(c)) return QValidator::Invalid;
  return QValidator::Intermediate;
}

void ParameterField::fixup(QString& text) const { text = textFromValue(value()); }

void ParameterField::stepBy(int notches) { setValue(scale_.stepped(value(), notches)); }

void ParameterField::tellLimit() {
  const QString typed = std::exchange(typed_, QString()).trimmed();
  bool ok = false;
  const double v = QLocale::c().toDouble(typed, &ok);
  if (ok && (v < minimum() || v > maximum()))
    emit limited(tr("%1 lies outside %2 to %3; %4 was taken")
                     .arg(typed, textFromValue(minimum()), textFromValue(maximum()), textFromValue(value())));
}

QSize ParameterField::sizeHint() const {
  const int width = fontMetrics().horizontalAdvance(QStringLiteral("000000.00")) + 12;
  return QSize(width, QDoubleSpinBox::sizeHint().height());
}

void ParameterField::wheelEvent(QWheelEvent* event) {
  // Scrolling the panel must not turn every value that passes under the pointer.
  if (hasFocus())
    QDoubleSpinBox::wheelEvent(event);
  else
    event->ignore();
}

}  // namespace hl::ui
