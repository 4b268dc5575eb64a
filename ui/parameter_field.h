#pragma once
// A number, typed within the hard range: what lies outside becomes the nearest bound, and says so.
#include <QDoubleSpinBox>

#include "engine/params/param.h"
#include "ui/slider_scale.h"

namespace hl::ui {

class ParameterField : public QDoubleSpinBox {
  Q_OBJECT
 public:
  explicit ParameterField(const ParamInfo&, QWidget* parent = nullptr);

  QString textFromValue(double) const override;
  double valueFromText(const QString&) const override;
  QValidator::State validate(QString&, int&) const override;
  void fixup(QString&) const override;
  void stepBy(int notches) override;
  QSize sizeHint() const override;
  QSize minimumSizeHint() const override { return sizeHint(); }

 signals:
  void limited(const QString& message);  ///< a typed value lay outside the range

 protected:
  void wheelEvent(QWheelEvent*) override;

 private:
  void tellLimit();

  const ParamInfo& info_;
  SliderScale scale_;
  QString typed_;
};

}  // namespace hl::ui
